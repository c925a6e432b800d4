-- Since when a vessel is out of service: sold, laid up or broken up. What is stored of her stays.
ALTER TABLE vessels ADD COLUMN out_of_service_at BIGINT;
