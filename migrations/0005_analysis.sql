-- Analysis: its work queue and its results (models, diagnostics, disturbances), and the
-- alerts raised from them.

-- Work queue. Finished jobs are removed; a job that failed too often stays as 'dead'
-- until someone looks into it.
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
-- At most one job of a kind waits per vessel, however many batches arrive.
CREATE UNIQUE INDEX jobs_one_queued ON jobs (vessel_id, kind) WHERE state = 'queued';
CREATE INDEX jobs_by_due ON jobs (state, not_before);

-- Every model of a compass; the highest version is current.
CREATE TABLE models (
    vessel_id UUID NOT NULL,
    id UUID NOT NULL,
    compass_id UUID NOT NULL,
    version BIGINT NOT NULL,
    created_at BIGINT NOT NULL,
    input_hash TEXT NOT NULL, -- SHA-256, hexadecimal
    estimator TEXT NOT NULL,
    epoch_from BIGINT, -- NULL: no known start
    epoch_to BIGINT, -- NULL: the epoch goes on
    data_from BIGINT NOT NULL,
    data_until BIGINT NOT NULL,
    -- The last sample's time and place, and the earth's field there.
    place_at BIGINT NOT NULL,
    lat DOUBLE PRECISION NOT NULL,
    lon DOUBLE PRECISION NOT NULL,
    variation_deg DOUBLE PRECISION NOT NULL,
    h_nt DOUBLE PRECISION NOT NULL,
    z_nt DOUBLE PRECISION NOT NULL,
    model TEXT NOT NULL, -- JSON
    epoch_begun_by TEXT, -- kind of logbook entry or cause of a change; NULL: first epoch
    foretold_by UUID, -- work order that predicted the model; NULL: fitted
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
    epochs TEXT NOT NULL, -- JSON
    coverage TEXT NOT NULL, -- JSON
    findings TEXT, -- JSON: input of the alert rules
    -- While no card is valid, because the current epoch has none yet: since when and why.
    card_withdrawn_at BIGINT,
    card_withdrawn_by TEXT, -- kind of logbook entry or cause of a change
    track TEXT, -- JSON array of [lat, lon], oldest first: recent places, thinned for a map
    PRIMARY KEY (vessel_id, compass_id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);

-- The outcome of each sample in the latest analysis, 30 days to a row.
CREATE TABLE diagnostics (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    chunk BIGINT NOT NULL, -- number of the 30-day interval since 1970
    samples TEXT NOT NULL, -- JSON array, in order of time
    PRIMARY KEY (vessel_id, compass_id, chunk),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);

-- Time and place of transient disturbances in the latest analysis of each compass.
-- Vessels of all fleets are compared by them; no operator sees another's rows.
CREATE TABLE disturbances (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    began_at BIGINT NOT NULL,
    ended_at BIGINT NOT NULL, -- last seen then, if it lasts
    lat DOUBLE PRECISION NOT NULL,
    lon DOUBLE PRECISION NOT NULL,
    PRIMARY KEY (vessel_id, compass_id, began_at),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);
CREATE INDEX disturbances_by_time ON disturbances (began_at);
CREATE INDEX disturbances_by_place ON disturbances (lat);

-- The newest revision of each alert that an agent raised on board. Batches may bring
-- revisions in any order.
CREATE TABLE ship_alerts (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    id UUID NOT NULL, -- made on board
    revision BIGINT NOT NULL,
    at BIGINT NOT NULL, -- of that revision, by the ship's clock
    alert TEXT NOT NULL, -- JSON
    PRIMARY KEY (vessel_id, compass_id, id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);

-- Alerts. They are never removed: a cleared alert is kept.
CREATE TABLE alerts (
    vessel_id UUID NOT NULL,
    id UUID NOT NULL,
    compass_id UUID NOT NULL,
    cause TEXT NOT NULL, -- checked by the program
    severity TEXT NOT NULL CHECK (severity IN ('notice', 'warning', 'critical')),
    state TEXT NOT NULL CHECK (state IN ('raised', 'acknowledged', 'cleared')),
    holds BOOLEAN NOT NULL, -- the cause was present at the last check
    since BIGINT NOT NULL, -- start of the cause, as far as known
    summary TEXT NOT NULL,
    advice TEXT NOT NULL,
    evidence TEXT NOT NULL, -- JSON array of sentences
    raised_at BIGINT NOT NULL,
    updated_at BIGINT NOT NULL,
    acknowledged_at BIGINT,
    acknowledged_by TEXT,
    acknowledgement_note TEXT,
    cleared_at BIGINT,
    cleared_by TEXT, -- NULL: cleared by the program
    clearing_reason TEXT,
    PRIMARY KEY (vessel_id, id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id),
    CHECK ((cleared_at IS NULL) = (state <> 'cleared')),
    CHECK (holds OR state = 'cleared')
);
-- While a cause goes on, its alert is updated, not repeated; one that a person cleared
-- is not raised again.
CREATE UNIQUE INDEX alerts_one_of_a_cause ON alerts (vessel_id, compass_id, cause) WHERE holds;
