-- What calendars show of a compass's need: why, and which version of it this is.
ALTER TABLE needs_told ADD COLUMN reason TEXT NOT NULL DEFAULT '';
ALTER TABLE needs_told ADD COLUMN version BIGINT NOT NULL DEFAULT 1; -- from 1
ALTER TABLE needs_told ADD COLUMN changed_at BIGINT NOT NULL DEFAULT 0;
