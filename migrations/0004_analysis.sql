-- Work to be done. Finished work leaves no row; work that failed too often stays
-- as 'dead' until someone looks.
CREATE TABLE jobs (
    vessel_id UUID NOT NULL REFERENCES vessels (id),
    id UUID NOT NULL,
    kind TEXT NOT NULL CHECK (kind IN ('analyse')),
    state TEXT NOT NULL CHECK (state IN ('queued', 'running', 'dead')),
    created_at BIGINT NOT NULL,
    not_before BIGINT NOT NULL,
    lease_until BIGINT, -- while running
    attempts BIGINT NOT NULL,
    last_error TEXT,
    PRIMARY KEY (vessel_id, id)
);
-- However many batches come, one job of a kind waits for each vessel.
CREATE UNIQUE INDEX jobs_one_queued ON jobs (vessel_id, kind) WHERE state = 'queued';
CREATE INDEX jobs_by_due ON jobs (state, not_before);

-- Every model that a compass ever had; the highest version is current.
CREATE TABLE models (
    vessel_id UUID NOT NULL,
    id UUID NOT NULL,
    compass_id UUID NOT NULL,
    version BIGINT NOT NULL,
    created_at BIGINT NOT NULL,
    input_hash TEXT NOT NULL, -- SHA-256, hexadecimal
    estimator TEXT NOT NULL,
    epoch_from BIGINT, -- none: reaches back without end
    epoch_to BIGINT, -- none: goes on
    data_from BIGINT NOT NULL,
    data_until BIGINT NOT NULL,
    -- The last sample's place, and the earth's field there and then.
    place_at BIGINT NOT NULL,
    lat DOUBLE PRECISION NOT NULL,
    lon DOUBLE PRECISION NOT NULL,
    variation_deg DOUBLE PRECISION NOT NULL,
    h_nt DOUBLE PRECISION NOT NULL,
    z_nt DOUBLE PRECISION NOT NULL,
    model TEXT NOT NULL, -- JSON
    PRIMARY KEY (vessel_id, id),
    UNIQUE (vessel_id, compass_id, version),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);

-- The latest analysis of each compass.
CREATE TABLE analyses (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    input_hash TEXT NOT NULL,
    estimator TEXT NOT NULL,
    analysed_at BIGINT NOT NULL,
    refusal TEXT, -- why the current epoch has no model
    epochs TEXT NOT NULL, -- JSON
    coverage TEXT NOT NULL, -- JSON
    PRIMARY KEY (vessel_id, compass_id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);

-- What became of each sample in it, some 30 days to a row.
CREATE TABLE diagnostics (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    chunk BIGINT NOT NULL, -- counts stretches of 30 days since 1970
    samples TEXT NOT NULL, -- JSON array, in order of time
    PRIMARY KEY (vessel_id, compass_id, chunk),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);
