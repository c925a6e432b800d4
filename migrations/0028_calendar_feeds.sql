-- Calendars that programs subscribe to, each by an address that is its secret.
CREATE TABLE calendar_feeds (
    id UUID NOT NULL PRIMARY KEY,
    operator_id UUID REFERENCES operators (id),
    firm_id UUID REFERENCES firms (id),
    vessel_id UUID, -- one vessel's only
    token_hash BYTEA NOT NULL UNIQUE, -- SHA-256
    name TEXT NOT NULL,
    created_at BIGINT NOT NULL,
    created_by TEXT NOT NULL,
    CHECK ((operator_id IS NULL) <> (firm_id IS NULL))
);
CREATE INDEX calendar_feeds_by_operator ON calendar_feeds (operator_id, id);
CREATE INDEX calendar_feeds_by_firm ON calendar_feeds (firm_id, id);
