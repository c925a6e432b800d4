-- Who is told of alerts, by whatever way.
CREATE TABLE receivers (
    id UUID NOT NULL PRIMARY KEY,
    operator_id UUID NOT NULL REFERENCES operators (id),
    channel TEXT NOT NULL CHECK (channel IN ('webhook', 'mail')),
    enabled BOOLEAN NOT NULL,
    last_number BIGINT NOT NULL -- of its deliveries
);
INSERT INTO receivers (id, operator_id, channel, enabled, last_number)
SELECT id, operator_id, 'webhook', enabled, last_number FROM webhooks;

-- What each is told, in order: the next is not sent before this one is delivered
-- or given up.
CREATE TABLE deliveries (
    receiver_id UUID NOT NULL REFERENCES receivers (id) ON DELETE CASCADE,
    number BIGINT NOT NULL,
    id UUID NOT NULL, -- the event's, by which a receiver knows it again
    kind TEXT NOT NULL,
    body TEXT NOT NULL, -- JSON, to the byte
    state TEXT NOT NULL CHECK (state IN ('pending', 'delivered', 'dead')),
    created_at BIGINT NOT NULL,
    tries_since BIGINT NOT NULL,
    attempts BIGINT NOT NULL,
    next_attempt_at BIGINT NOT NULL,
    lease_until BIGINT, -- while one is under way
    last_status BIGINT,
    last_error TEXT,
    delivered_at BIGINT,
    PRIMARY KEY (receiver_id, number),
    UNIQUE (receiver_id, id)
);
INSERT INTO deliveries (receiver_id, number, id, kind, body, state, created_at, tries_since,
                        attempts, next_attempt_at, lease_until, last_status, last_error,
                        delivered_at)
SELECT webhook_id, number, id, kind, body, state, created_at, tries_since, attempts,
       next_attempt_at, lease_until, last_status, last_error, delivered_at
FROM webhook_deliveries;
DROP TABLE webhook_deliveries;
CREATE INDEX deliveries_pending ON deliveries (receiver_id, number) WHERE state = 'pending';

-- A webhook is a receiver, and goes with it.
ALTER TABLE webhooks RENAME TO former_webhooks;
CREATE TABLE webhooks (
    id UUID NOT NULL PRIMARY KEY REFERENCES receivers (id) ON DELETE CASCADE,
    operator_id UUID NOT NULL REFERENCES operators (id),
    url TEXT NOT NULL,
    secret TEXT NOT NULL, -- not hashed: it signs
    kinds TEXT NOT NULL, -- JSON array
    created_at BIGINT NOT NULL
);
INSERT INTO webhooks (id, operator_id, url, secret, kinds, created_at)
SELECT id, operator_id, url, secret, kinds, created_at FROM former_webhooks;
DROP TABLE former_webhooks;
CREATE INDEX webhooks_by_operator ON webhooks (operator_id, id);

-- So is a person who gets mail.
CREATE TABLE mail_recipients (
    id UUID NOT NULL PRIMARY KEY REFERENCES receivers (id) ON DELETE CASCADE,
    operator_id UUID NOT NULL REFERENCES operators (id),
    address TEXT NOT NULL,
    severity TEXT NOT NULL CHECK (severity IN ('notice', 'warning', 'critical')),
    created_at BIGINT NOT NULL,
    UNIQUE (operator_id, address)
);

-- The worst that a recipient was told of an alert that is open.
CREATE TABLE mail_told (
    recipient_id UUID NOT NULL REFERENCES mail_recipients (id) ON DELETE CASCADE,
    alert_id UUID NOT NULL,
    severity TEXT NOT NULL CHECK (severity IN ('notice', 'warning', 'critical')),
    PRIMARY KEY (recipient_id, alert_id)
);
