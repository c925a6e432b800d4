-- Planning: the need to adjust each compass, the schedule, calendar feeds, notifications and
-- reports.

-- History of the greatest deviation at the vessel's place: it was at least this great at
-- every check since that day. Later days have higher levels. Days over a limit are
-- counted by it.
CREATE TABLE deviation_since (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    since TEXT NOT NULL, -- a day, UTC
    at_least_deg DOUBLE PRECISION NOT NULL,
    PRIMARY KEY (vessel_id, compass_id, since),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);

-- Each compass's need as last announced to people and calendars.
CREATE TABLE needs_told (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    due_on TEXT NOT NULL, -- ISO 8601
    urgency TEXT NOT NULL,
    reason TEXT NOT NULL DEFAULT '',
    version BIGINT NOT NULL DEFAULT 1, -- from 1, for calendars
    changed_at BIGINT NOT NULL DEFAULT 0,
    PRIMARY KEY (vessel_id, compass_id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);

-- Cost weights and other settings of an operator's schedule; no row means the defaults.
CREATE TABLE schedule_settings (
    operator_id UUID NOT NULL PRIMARY KEY REFERENCES operators (id),
    settings TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL,
    changed_by TEXT NOT NULL
);

-- Requests for a new schedule: one of its inputs changed. A row is removed when a
-- schedule covers it. Each request is a row of its own, so that writers never wait for
-- each other.
CREATE TABLE schedule_asks (
    operator_id UUID NOT NULL REFERENCES operators (id),
    id UUID NOT NULL,
    asked_at BIGINT NOT NULL,
    PRIMARY KEY (operator_id, id)
);
CREATE INDEX schedule_asks_by_time ON schedule_asks (asked_at);

-- The lease on solving an operator's schedule.
CREATE TABLE schedule_runs (
    operator_id UUID NOT NULL PRIMARY KEY REFERENCES operators (id),
    lease_until BIGINT NOT NULL,
    attempts BIGINT NOT NULL,
    last_error TEXT
);

-- Recent schedules; the highest version is current.
CREATE TABLE schedules (
    operator_id UUID NOT NULL REFERENCES operators (id),
    version BIGINT NOT NULL, -- from 1
    solved_at BIGINT NOT NULL,
    input_sha256 TEXT NOT NULL, -- hexadecimal
    input TEXT NOT NULL, -- JSON, as `binnacle-server schedule` reads it
    plan TEXT NOT NULL, -- JSON
    PRIMARY KEY (operator_id, version)
);

-- Assignments that a person fixed.
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

-- Calendars that programs subscribe to. The address of each is its secret.
CREATE TABLE calendar_feeds (
    id UUID NOT NULL PRIMARY KEY,
    operator_id UUID REFERENCES operators (id),
    firm_id UUID REFERENCES firms (id),
    vessel_id UUID, -- NULL: all vessels
    token_hash BYTEA NOT NULL UNIQUE, -- SHA-256
    name TEXT NOT NULL,
    created_at BIGINT NOT NULL,
    created_by TEXT NOT NULL,
    user_id UUID REFERENCES users (id) ON DELETE CASCADE, -- its creator: it ends with them
    CHECK ((operator_id IS NULL) <> (firm_id IS NULL))
);
CREATE INDEX calendar_feeds_by_operator ON calendar_feeds (operator_id, id);
CREATE INDEX calendar_feeds_by_firm ON calendar_feeds (firm_id, id);
CREATE INDEX calendar_feeds_by_user ON calendar_feeds (user_id);

-- A user's notification settings; no row means the defaults.
CREATE TABLE notification_settings (
    user_id UUID NOT NULL PRIMARY KEY REFERENCES users (id) ON DELETE CASCADE,
    settings TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL
);

-- Notifications of each user, removed after the retention period.
CREATE TABLE notifications (
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    id UUID NOT NULL,
    kind TEXT NOT NULL, -- checked by the program
    urgent BOOLEAN NOT NULL, -- mailed without delay
    subject TEXT NOT NULL,
    text TEXT NOT NULL,
    path TEXT NOT NULL, -- page of the dashboard
    vessel_id UUID,
    order_id UUID,
    alert_id UUID,
    created_at BIGINT NOT NULL,
    read_at BIGINT,
    mail_at BIGINT, -- when to mail it; NULL: not to be mailed, or done
    PRIMARY KEY (user_id, id)
);
CREATE INDEX notifications_by_mail ON notifications (mail_at) WHERE mail_at IS NOT NULL;
CREATE INDEX notifications_by_time ON notifications (created_at);

-- An operator's assumptions for reports; no row means the defaults.
CREATE TABLE report_settings (
    operator_id UUID NOT NULL PRIMARY KEY REFERENCES operators (id),
    settings TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL,
    changed_by TEXT NOT NULL
);

-- Recipients of the monthly report: each is a receiver and is removed with it.
CREATE TABLE report_recipients (
    id UUID NOT NULL PRIMARY KEY REFERENCES receivers (id) ON DELETE CASCADE,
    operator_id UUID NOT NULL REFERENCES operators (id),
    address TEXT NOT NULL,
    created_at BIGINT NOT NULL,
    UNIQUE (operator_id, address)
);

-- Reports as mailed. Rows are never changed.
CREATE TABLE monthly_reports (
    operator_id UUID NOT NULL REFERENCES operators (id),
    month TEXT NOT NULL, -- YYYY-MM
    made_at BIGINT NOT NULL,
    pdf BYTEA NOT NULL,
    due_csv TEXT NOT NULL,
    deviation_csv TEXT NOT NULL,
    jobs_csv TEXT NOT NULL,
    PRIMARY KEY (operator_id, month)
);
