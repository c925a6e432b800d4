-- Azimuths: compass errors observed by bearings of the sun, other bodies, transits, quays.

-- Rows are never changed or removed, but for the mark that one is withdrawn.
CREATE TABLE azimuths (
    vessel_id UUID NOT NULL,
    id UUID NOT NULL, -- made on board for observations from there
    compass_id UUID NOT NULL,
    observed_at BIGINT NOT NULL,
    report TEXT NOT NULL, -- JSON, as observed
    created_at BIGINT NOT NULL,
    created_by TEXT NOT NULL, -- a name; initials for observations from on board
    author TEXT NOT NULL CHECK (author IN ('user', 'agent')),
    author_id UUID NOT NULL,
    withdrawn_at BIGINT,
    withdrawn_by TEXT,
    withdrawal_reason TEXT,
    PRIMARY KEY (vessel_id, id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id),
    CHECK ((withdrawn_at IS NULL) = (withdrawn_by IS NULL))
);
CREATE INDEX azimuths_by_time ON azimuths (vessel_id, observed_at, id);
