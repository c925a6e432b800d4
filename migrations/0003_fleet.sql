-- Fleet: vessels with their compasses, binnacles, particulars and port calls, and an operator's
-- settings for a vessel.

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

-- Port calls as they now stand. They are never removed: a call is revised, or withdrawn
-- and kept.
CREATE TABLE port_calls (
    vessel_id UUID NOT NULL REFERENCES vessels (id),
    id UUID NOT NULL,
    reference TEXT NOT NULL, -- identifier at its source
    port TEXT NOT NULL, -- UN/LOCODE
    berth TEXT,
    eta BIGINT NOT NULL,
    eta_uncertainty_h DOUBLE PRECISION NOT NULL,
    etd BIGINT NOT NULL CHECK (etd > eta),
    etd_uncertainty_h DOUBLE PRECISION NOT NULL,
    berth_heading_deg DOUBLE PRECISION, -- as announced
    lay_heading_deg DOUBLE PRECISION, -- as measured alongside
    source TEXT NOT NULL CHECK (source IN ('api', 'csv', 'icalendar')),
    revision BIGINT NOT NULL, -- from 1
    created_at BIGINT NOT NULL,
    created_by TEXT NOT NULL,
    revised_at BIGINT,
    revised_by TEXT,
    withdrawn_at BIGINT,
    withdrawn_by TEXT,
    withdrawal_reason TEXT,
    PRIMARY KEY (vessel_id, id),
    UNIQUE (vessel_id, reference),
    CHECK ((withdrawn_at IS NULL) = (withdrawn_by IS NULL))
);
CREATE INDEX port_calls_by_time ON port_calls (vessel_id, eta, id);

-- Each revision of a call as written. Rows are never changed or removed.
CREATE TABLE port_call_revisions (
    vessel_id UUID NOT NULL,
    call_id UUID NOT NULL,
    revision BIGINT NOT NULL,
    at BIGINT NOT NULL,
    source TEXT NOT NULL CHECK (source IN ('api', 'csv', 'icalendar')),
    author_id UUID NOT NULL,
    author_name TEXT NOT NULL,
    call TEXT NOT NULL, -- JSON
    PRIMARY KEY (vessel_id, call_id, revision),
    FOREIGN KEY (vessel_id, call_id) REFERENCES port_calls (vessel_id, id)
);

-- Particulars of a vessel that adjustment rules depend on.
CREATE TABLE vessel_particulars (
    vessel_id UUID NOT NULL PRIMARY KEY REFERENCES vessels (id),
    particulars TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL,
    changed_by TEXT NOT NULL
);
