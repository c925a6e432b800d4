-- Messages: live events for dashboards, and the outbox of webhooks and mail.

-- Live events. They are kept for a day, so that a dashboard that lost its connection
-- can catch up.
CREATE TABLE events (
    id UUID NOT NULL PRIMARY KEY,
    operator_id UUID NOT NULL REFERENCES operators (id),
    vessel_id UUID NOT NULL,
    kind TEXT NOT NULL, -- checked by the program: SQLite cannot widen a CHECK
    created_at BIGINT NOT NULL,
    firm_id UUID, -- sees the event besides the operator
    order_id UUID
);
CREATE INDEX events_by_operator ON events (operator_id, id);
CREATE INDEX events_by_time ON events (created_at);
CREATE INDEX events_by_firm ON events (firm_id, id);

-- Receivers of messages, by any channel. Each belongs to an operator or to a firm.
CREATE TABLE receivers (
    id UUID NOT NULL PRIMARY KEY,
    channel TEXT NOT NULL CHECK (channel IN ('webhook', 'mail')),
    enabled BOOLEAN NOT NULL,
    last_number BIGINT NOT NULL, -- of its deliveries
    operator_id UUID CONSTRAINT receivers_of_operator_fkey REFERENCES operators (id),
    firm_id UUID REFERENCES firms (id),
    CHECK ((operator_id IS NULL) <> (firm_id IS NULL))
);

-- The outbox. Per receiver and work order a message is sent only after the one before
-- it was delivered or given up.
CREATE TABLE deliveries (
    receiver_id UUID NOT NULL REFERENCES receivers (id) ON DELETE CASCADE,
    number BIGINT NOT NULL,
    id UUID NOT NULL, -- of the event: receivers drop repeated messages by it
    kind TEXT NOT NULL,
    body TEXT NOT NULL, -- JSON, sent byte for byte
    state TEXT NOT NULL CHECK (state IN ('pending', 'delivered', 'dead')),
    created_at BIGINT NOT NULL,
    tries_since BIGINT NOT NULL, -- start of the present series of attempts
    attempts BIGINT NOT NULL,
    next_attempt_at BIGINT NOT NULL,
    lease_until BIGINT, -- during an attempt
    last_status BIGINT,
    last_error TEXT,
    delivered_at BIGINT,
    order_id UUID, -- NULL: the message concerns no work order
    PRIMARY KEY (receiver_id, number),
    UNIQUE (receiver_id, id)
);
CREATE INDEX deliveries_pending ON deliveries (receiver_id, number) WHERE state = 'pending';

-- Webhooks: each is a receiver and is removed with it.
CREATE TABLE webhooks (
    id UUID NOT NULL CONSTRAINT webhooks_pkey1 PRIMARY KEY
        REFERENCES receivers (id) ON DELETE CASCADE,
    url TEXT NOT NULL,
    secret TEXT NOT NULL, -- not hashed: it signs the messages
    kinds TEXT NOT NULL, -- JSON array
    created_at BIGINT NOT NULL,
    operator_id UUID CONSTRAINT webhooks_of_operator_fkey REFERENCES operators (id),
    firm_id UUID REFERENCES firms (id),
    CHECK ((operator_id IS NULL) <> (firm_id IS NULL))
);
CREATE INDEX webhooks_by_operator ON webhooks (operator_id, id);
CREATE INDEX webhooks_by_firm ON webhooks (firm_id, id);

-- Recipients of alert mail: each is a receiver and is removed with it.
CREATE TABLE mail_recipients (
    id UUID NOT NULL PRIMARY KEY REFERENCES receivers (id) ON DELETE CASCADE,
    operator_id UUID NOT NULL REFERENCES operators (id),
    address TEXT NOT NULL,
    severity TEXT NOT NULL CHECK (severity IN ('notice', 'warning', 'critical')), -- the least
    created_at BIGINT NOT NULL,
    UNIQUE (operator_id, address)
);

-- The highest severity of an open alert that was mailed to a recipient.
CREATE TABLE mail_told (
    recipient_id UUID NOT NULL REFERENCES mail_recipients (id) ON DELETE CASCADE,
    alert_id UUID NOT NULL,
    severity TEXT NOT NULL CHECK (severity IN ('notice', 'warning', 'critical')),
    PRIMARY KEY (recipient_id, alert_id)
);
