-- The first run of a server, firms that operators found, and IMO numbers that are one vessel's.

-- One-time code with which an empty server's first operator is made: one row at most.
CREATE TABLE first_run_codes (
    id BIGINT NOT NULL PRIMARY KEY CHECK (id = 1),
    code_hash BYTEA NOT NULL, -- SHA-256
    expires_at BIGINT NOT NULL
);

-- Operator that entered the firm and invites its users. NULL: a platform admin did.
ALTER TABLE firms ADD COLUMN founded_by UUID REFERENCES operators (id);

-- TRUE for a vessel from before whose number an earlier vessel of its operator has. It keeps the
-- number until someone amends it.
ALTER TABLE vessels ADD COLUMN imo_shared BOOLEAN NOT NULL DEFAULT FALSE;
UPDATE vessels SET imo_shared = TRUE
WHERE EXISTS (SELECT 1 FROM vessels earlier
              WHERE earlier.operator_id = vessels.operator_id
                AND earlier.imo_number = vessels.imo_number AND earlier.id < vessels.id);
CREATE UNIQUE INDEX vessels_by_imo ON vessels (operator_id, imo_number) WHERE NOT imo_shared;
