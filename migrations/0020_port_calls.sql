-- When a vessel is where. A call is never removed: it is revised, or withdrawn and kept.
CREATE TABLE port_calls (
    vessel_id UUID NOT NULL REFERENCES vessels (id),
    id UUID NOT NULL,
    reference TEXT NOT NULL, -- its name where it comes from
    port TEXT NOT NULL, -- UN/LOCODE
    berth TEXT,
    eta BIGINT NOT NULL,
    eta_uncertainty_h DOUBLE PRECISION NOT NULL,
    etd BIGINT NOT NULL CHECK (etd > eta),
    etd_uncertainty_h DOUBLE PRECISION NOT NULL,
    berth_heading_deg DOUBLE PRECISION, -- as it was given
    lay_heading_deg DOUBLE PRECISION, -- as it was read alongside
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

-- Each revision of a call as it was written. A row is never changed or removed.
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
