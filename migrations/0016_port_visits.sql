-- Visits of a vessel as port systems report them, one time after another: a port call follows
-- once arrival and departure are known. Deleted when it does.
CREATE TABLE port_visits (
    vessel_id UUID NOT NULL REFERENCES vessels (id) ON DELETE CASCADE,
    reference TEXT NOT NULL, -- of the visit, in the port's system
    eta BIGINT, -- NULL: not reported yet
    etd BIGINT, -- NULL: not reported yet
    changed_at BIGINT NOT NULL,
    CONSTRAINT port_visits_pkey PRIMARY KEY (vessel_id, reference)
);
