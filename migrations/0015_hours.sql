-- Hours of jobs, and the teams that firms state.

-- Length of the job, microseconds: three hours where nobody gave one, as of orders from before and
-- of those that an older server beside this one writes.
ALTER TABLE work_orders ADD COLUMN job_us BIGINT NOT NULL DEFAULT 10800000000;

-- Offset of the port's legal time from UTC when the hour was agreed, seconds. NULL: the port
-- is unknown, or the order is from before.
ALTER TABLE work_orders ADD COLUMN agreed_utc_offset_s BIGINT;

-- Team of the firm that is to come, where its teams have names.
ALTER TABLE work_order_offers ADD COLUMN team TEXT;

-- Beginning of a fixed job. NULL: any hour of the day.
ALTER TABLE schedule_pins ADD COLUMN from_at BIGINT;

-- Teams of a firm and its travel times, as it states them to all its operators.
CREATE TABLE firm_teams (
    firm_id UUID NOT NULL PRIMARY KEY REFERENCES firms (id),
    teams TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL,
    changed_by TEXT NOT NULL
);
