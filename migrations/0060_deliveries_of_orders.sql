-- Messages of one work order are sent in order, whatever holds up another's: the order
-- that a delivery is of. Those of none are in order among themselves.
ALTER TABLE deliveries ADD COLUMN order_id UUID;
