CREATE TABLE vessels (
    id UUID NOT NULL PRIMARY KEY,
    operator_id UUID NOT NULL REFERENCES operators (id),
    name TEXT NOT NULL,
    imo_number TEXT,
    call_sign TEXT,
    flag TEXT,
    created_at BIGINT NOT NULL,
    last_upload_at BIGINT,
    -- Where and when the latest uploaded sample was taken.
    last_sample_at BIGINT,
    last_lat DOUBLE PRECISION,
    last_lon DOUBLE PRECISION
);
CREATE INDEX vessels_by_operator ON vessels (operator_id, id);

CREATE TABLE compasses (
    vessel_id UUID NOT NULL REFERENCES vessels (id),
    id UUID NOT NULL,
    name TEXT NOT NULL,
    role TEXT NOT NULL CHECK (role IN ('standard', 'steering', 'transmitting')),
    created_at BIGINT NOT NULL,
    PRIMARY KEY (vessel_id, id)
);

-- What the operator decided for a vessel; no row means the defaults, version 0.
CREATE TABLE vessel_settings (
    vessel_id UUID NOT NULL PRIMARY KEY REFERENCES vessels (id),
    version BIGINT NOT NULL,
    agent TEXT NOT NULL, -- JSON
    analysis TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL
);
