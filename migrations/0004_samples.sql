-- Samples: the agents on board, their streams, and the log of uploaded batches.

-- One-time codes that enrol an agent. A code is looked up before its vessel is known:
-- this key does not lead with vessel_id.
CREATE TABLE enrolment_codes (
    code_hash BYTEA NOT NULL PRIMARY KEY, -- SHA-256
    vessel_id UUID NOT NULL REFERENCES vessels (id),
    compass_id UUID NOT NULL,
    created_at BIGINT NOT NULL,
    expires_at BIGINT NOT NULL,
    used_at BIGINT
);

-- Installations of the agent. A token names its vessel, so that its look-up leads with
-- vessel_id.
CREATE TABLE agents (
    vessel_id UUID NOT NULL REFERENCES vessels (id),
    id UUID NOT NULL,
    compass_id UUID NOT NULL,
    token_hash BYTEA NOT NULL, -- SHA-256
    agent_version TEXT NOT NULL,
    enrolled_at BIGINT NOT NULL,
    revoked_at BIGINT, -- the token is refused from then on
    PRIMARY KEY (vessel_id, id),
    UNIQUE (vessel_id, token_hash),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);

-- One compass as one installation reports it.
CREATE TABLE streams (
    vessel_id UUID NOT NULL,
    id UUID NOT NULL,
    agent_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    opened_at BIGINT NOT NULL,
    last_upload_at BIGINT,
    contiguous_seq BIGINT NOT NULL, -- every batch up to this one is stored
    batches BIGINT NOT NULL,
    samples BIGINT NOT NULL,
    tally TEXT NOT NULL, -- JSON: windows by outcome
    -- The agent's last report of its spool and link budget.
    batches_waiting BIGINT, -- besides the one that was sent
    budget_left_percent BIGINT, -- of a day's budget; NULL: a full day's, or no limit
    aboard_at BIGINT, -- time of the report
    PRIMARY KEY (vessel_id, id),
    FOREIGN KEY (vessel_id, agent_id) REFERENCES agents (vessel_id, id)
);

-- The log. Rows are never changed or removed.
CREATE TABLE batches (
    vessel_id UUID NOT NULL,
    stream UUID NOT NULL,
    seq BIGINT NOT NULL,
    bytes BYTEA NOT NULL, -- exactly as received
    sha256 BYTEA NOT NULL,
    samples BIGINT NOT NULL,
    first_sample_at BIGINT,
    last_sample_at BIGINT,
    received_at BIGINT NOT NULL,
    PRIMARY KEY (vessel_id, stream, seq),
    FOREIGN KEY (vessel_id, stream) REFERENCES streams (vessel_id, id)
);
