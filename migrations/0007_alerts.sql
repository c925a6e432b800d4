-- What people must know of. An alert is never removed: it is cleared, and kept.
CREATE TABLE alerts (
    vessel_id UUID NOT NULL,
    id UUID NOT NULL,
    compass_id UUID NOT NULL,
    cause TEXT NOT NULL, -- the program knows them
    severity TEXT NOT NULL CHECK (severity IN ('notice', 'warning', 'critical')),
    state TEXT NOT NULL CHECK (state IN ('raised', 'acknowledged', 'cleared')),
    holds BOOLEAN NOT NULL, -- whether its cause was there at the last look
    since BIGINT NOT NULL, -- when its cause began, as far as that is known
    summary TEXT NOT NULL,
    advice TEXT NOT NULL,
    evidence TEXT NOT NULL, -- JSON array of sentences
    raised_at BIGINT NOT NULL,
    updated_at BIGINT NOT NULL,
    acknowledged_at BIGINT,
    acknowledged_by TEXT,
    acknowledgement_note TEXT,
    cleared_at BIGINT,
    cleared_by TEXT, -- none: it cleared itself
    clearing_reason TEXT,
    PRIMARY KEY (vessel_id, id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id),
    CHECK ((cleared_at IS NULL) = (state <> 'cleared')),
    CHECK (holds OR state = 'cleared')
);
-- What goes on is updated, not repeated; what a person cleared is not raised again
-- while its cause goes on.
CREATE UNIQUE INDEX alerts_one_of_a_cause ON alerts (vessel_id, compass_id, cause) WHERE holds;

-- From when on a vessel's alerts are raised; '{}' are the defaults.
ALTER TABLE vessel_settings ADD COLUMN alerts TEXT NOT NULL DEFAULT '{}'; -- JSON

-- What of an analysis alerts are made from; none before there were alerts.
ALTER TABLE analyses ADD COLUMN findings TEXT; -- JSON
-- Since when no card holds, and why: the current epoch has none of its own.
ALTER TABLE analyses ADD COLUMN card_withdrawn_at BIGINT;
ALTER TABLE analyses ADD COLUMN card_withdrawn_by TEXT; -- the kind of logbook entry, or a cause
