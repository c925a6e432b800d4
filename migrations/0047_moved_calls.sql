-- How an order's time lies in its port call since the call moved; none where it has not
-- moved since the time was agreed.
ALTER TABLE work_orders ADD COLUMN call_fit TEXT; -- the program knows them
