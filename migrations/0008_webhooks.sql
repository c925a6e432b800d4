-- Where an operator's programs want to be told.
CREATE TABLE webhooks (
    id UUID NOT NULL PRIMARY KEY,
    operator_id UUID NOT NULL REFERENCES operators (id),
    url TEXT NOT NULL,
    secret TEXT NOT NULL, -- not hashed: it signs
    kinds TEXT NOT NULL, -- JSON array
    enabled BOOLEAN NOT NULL,
    created_at BIGINT NOT NULL,
    last_number BIGINT NOT NULL -- of its deliveries
);
CREATE INDEX webhooks_by_operator ON webhooks (operator_id, id);

-- What each is told, in order: the next is not sent before this one is delivered
-- or given up.
CREATE TABLE webhook_deliveries (
    webhook_id UUID NOT NULL REFERENCES webhooks (id) ON DELETE CASCADE,
    number BIGINT NOT NULL,
    id UUID NOT NULL, -- the event's, by which a receiver knows it again
    kind TEXT NOT NULL,
    body TEXT NOT NULL, -- JSON, sent to the byte
    state TEXT NOT NULL CHECK (state IN ('pending', 'delivered', 'dead')),
    created_at BIGINT NOT NULL,
    tries_since BIGINT NOT NULL,
    attempts BIGINT NOT NULL,
    next_attempt_at BIGINT NOT NULL,
    lease_until BIGINT, -- while one is under way
    last_status BIGINT,
    last_error TEXT,
    delivered_at BIGINT,
    PRIMARY KEY (webhook_id, number),
    UNIQUE (webhook_id, id)
);
CREATE INDEX webhook_deliveries_pending ON webhook_deliveries (webhook_id, number)
    WHERE state = 'pending';
