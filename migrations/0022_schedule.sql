-- What counts how much in an operator's schedule; no row means the defaults.
CREATE TABLE schedule_settings (
    operator_id UUID NOT NULL PRIMARY KEY REFERENCES operators (id),
    settings TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL,
    changed_by TEXT NOT NULL
);

-- That something has changed on which the schedule rests. A row goes when a schedule is
-- there that knows of it. Nobody waits for another's row.
CREATE TABLE schedule_asks (
    operator_id UUID NOT NULL REFERENCES operators (id),
    id UUID NOT NULL,
    asked_at BIGINT NOT NULL,
    PRIMARY KEY (operator_id, id)
);
CREATE INDEX schedule_asks_by_time ON schedule_asks (asked_at);

-- Who solves an operator's schedule, and until when others leave it alone.
CREATE TABLE schedule_runs (
    operator_id UUID NOT NULL PRIMARY KEY REFERENCES operators (id),
    lease_until BIGINT NOT NULL,
    attempts BIGINT NOT NULL,
    last_error TEXT
);

-- Every schedule that was made lately; the highest version is current.
CREATE TABLE schedules (
    operator_id UUID NOT NULL REFERENCES operators (id),
    version BIGINT NOT NULL, -- from 1
    solved_at BIGINT NOT NULL,
    input_sha256 TEXT NOT NULL, -- of what it rests on, hexadecimal
    input TEXT NOT NULL, -- JSON, as `binnacle-server schedule` reads it
    plan TEXT NOT NULL, -- JSON
    PRIMARY KEY (operator_id, version)
);

-- What a person wants as it is.
CREATE TABLE schedule_pins (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    call_id UUID NOT NULL,
    firm_id UUID NOT NULL,
    day TEXT NOT NULL, -- ISO 8601
    note TEXT,
    created_at BIGINT NOT NULL,
    created_by TEXT NOT NULL,
    PRIMARY KEY (vessel_id, compass_id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);

-- At which call a work order is to be done. The row may come before its order.
CREATE TABLE schedule_orders (
    vessel_id UUID NOT NULL,
    order_id UUID NOT NULL,
    call_id UUID NOT NULL,
    PRIMARY KEY (vessel_id, order_id)
);
