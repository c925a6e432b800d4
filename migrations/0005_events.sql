-- What dashboards are told as it happens; kept for a day, so that a dashboard
-- that lost its connection can catch up.
CREATE TABLE events (
    id UUID NOT NULL PRIMARY KEY,
    operator_id UUID NOT NULL REFERENCES operators (id),
    vessel_id UUID NOT NULL,
    kind TEXT NOT NULL CHECK (kind IN ('batch', 'model')),
    created_at BIGINT NOT NULL
);
CREATE INDEX events_by_operator ON events (operator_id, id);
CREATE INDEX events_by_time ON events (created_at);
