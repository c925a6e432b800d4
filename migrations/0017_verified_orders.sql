-- When headings at sea verified an adjustment, and what they said then; none before.
ALTER TABLE work_orders ADD COLUMN verified_at BIGINT;
ALTER TABLE work_orders ADD COLUMN verification TEXT; -- JSON
