-- Segments: a cache of the log. Any row may be removed: the next analysis derives it again.

-- The table diagnostics is no longer used: an older server beside this one still writes it, and a
-- later release removes it.

-- 10 days of a compass's samples, each with what the analysis of all until then has settled.
CREATE TABLE segments (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    segment BIGINT NOT NULL, -- number of the 10 days since 1970
    batches_sha256 BYTEA NOT NULL, -- of the numbers of its batches
    samples_sha256 BYTEA NOT NULL, -- of its distinct samples
    key BYTEA NOT NULL, -- SHA-256 of all that the row was derived from
    -- Diagnoses that were settled at its end; of the last segment, those that are not yet.
    first_sample_at BIGINT,
    last_sample_at BIGINT,
    diagnoses BYTEA NOT NULL,
    state BYTEA, -- of the analysis at its end; NULL of the last segment and of old ones
    PRIMARY KEY (vessel_id, compass_id, segment),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);

-- Time at which a model was first sent to the ship: such a version is kept.
ALTER TABLE models ADD COLUMN sent_at BIGINT;
UPDATE models SET sent_at = created_at;
