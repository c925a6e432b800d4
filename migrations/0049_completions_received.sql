-- When an order's completion reached the server: a phone may have kept it for days. None
-- for orders of before, which count as received when they were completed.
ALTER TABLE work_orders ADD COLUMN completion_received_at BIGINT;
