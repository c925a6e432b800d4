-- Fleet: vessels, their compasses and binnacles, and an operator's settings for a vessel.

CREATE TABLE vessels (
    id UUID NOT NULL PRIMARY KEY,
    operator_id UUID NOT NULL REFERENCES operators (id),
    name TEXT NOT NULL,
    imo_number TEXT,
    call_sign TEXT,
    flag TEXT,
    created_at BIGINT NOT NULL,
    last_upload_at BIGINT,
    -- Time and place of the latest uploaded sample.
    last_sample_at BIGINT,
    last_lat DOUBLE PRECISION,
    last_lon DOUBLE PRECISION,
    degaussing TEXT, -- state of the degaussing coils, for the deviation card
    out_of_service_at BIGINT -- sold, laid up or broken up since; its data is kept
);
CREATE INDEX vessels_by_operator ON vessels (operator_id, id);

CREATE TABLE compasses (
    vessel_id UUID NOT NULL REFERENCES vessels (id),
    id UUID NOT NULL,
    name TEXT NOT NULL,
    role TEXT NOT NULL CHECK (role IN ('standard', 'steering', 'transmitting')),
    created_at BIGINT NOT NULL,
    -- Name plates, for the deviation card.
    make TEXT, -- maker and type
    serial_number TEXT,
    binnacle TEXT, -- the binnacle's maker, type and number
    PRIMARY KEY (vessel_id, id)
);

-- Revisions of a compass's binnacle, in the format of docs/binnacle.md. Rows are never
-- changed or removed: the highest revision is current.
CREATE TABLE binnacles (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    revision BIGINT NOT NULL, -- from 1
    id UUID NOT NULL,
    at BIGINT NOT NULL,
    author_id UUID NOT NULL,
    author_name TEXT NOT NULL,
    reason TEXT,
    binnacle TEXT NOT NULL, -- JSON
    PRIMARY KEY (vessel_id, compass_id, revision),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);

-- An operator's settings for a vessel; no row means the defaults, version 0.
CREATE TABLE vessel_settings (
    vessel_id UUID NOT NULL PRIMARY KEY REFERENCES vessels (id),
    version BIGINT NOT NULL,
    agent TEXT NOT NULL, -- JSON
    analysis TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL,
    alerts TEXT NOT NULL DEFAULT '{}' -- JSON: alert limits; '{}' means the defaults
);
