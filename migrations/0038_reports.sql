-- What an operator's reports reckon with; no row means the defaults.
CREATE TABLE report_settings (
    operator_id UUID NOT NULL PRIMARY KEY REFERENCES operators (id),
    settings TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL,
    changed_by TEXT NOT NULL
);

-- Who gets the monthly report; each is a receiver, and goes with it.
CREATE TABLE report_recipients (
    id UUID NOT NULL PRIMARY KEY REFERENCES receivers (id) ON DELETE CASCADE,
    operator_id UUID NOT NULL REFERENCES operators (id),
    address TEXT NOT NULL,
    created_at BIGINT NOT NULL,
    UNIQUE (operator_id, address)
);

-- Reports as they were mailed. A row is never changed.
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
