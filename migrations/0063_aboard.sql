-- How it was on board when an agent last said so, with a batch of the stream.
ALTER TABLE streams ADD COLUMN batches_waiting BIGINT; -- besides the one that was sent
ALTER TABLE streams ADD COLUMN budget_left_percent BIGINT; -- of a day's; none: enough, or no limit
ALTER TABLE streams ADD COLUMN aboard_at BIGINT;
