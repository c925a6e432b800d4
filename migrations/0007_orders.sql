-- Orders: the operators that firms work for, and work orders to adjust a compass with
-- their log, photos and offers.

-- Operators that a firm works for.
CREATE TABLE operator_firms (
    operator_id UUID NOT NULL REFERENCES operators (id),
    firm_id UUID NOT NULL REFERENCES firms (id),
    created_at BIGINT NOT NULL,
    PRIMARY KEY (operator_id, firm_id)
);
CREATE INDEX operator_firms_by_firm ON operator_firms (firm_id, operator_id);

-- Terms of a firm for an operator: ports, times, fees.
CREATE TABLE firm_terms (
    operator_id UUID NOT NULL REFERENCES operators (id),
    firm_id UUID NOT NULL,
    terms TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL,
    changed_by TEXT NOT NULL,
    PRIMARY KEY (operator_id, firm_id)
);

-- Public keys with which firms sign records. Rows are never removed: a key is revoked.
CREATE TABLE firm_keys (
    id UUID NOT NULL PRIMARY KEY,
    firm_id UUID NOT NULL REFERENCES firms (id),
    public_key TEXT NOT NULL, -- Ed25519, lower-case hexadecimal
    name TEXT NOT NULL,
    created_at BIGINT NOT NULL,
    created_by TEXT NOT NULL,
    revoked_at BIGINT
);
CREATE INDEX firm_keys_by_firm ON firm_keys (firm_id, id);
CREATE UNIQUE INDEX firm_keys_active ON firm_keys (public_key) WHERE revoked_at IS NULL;

-- Work orders: their state after the last entry of their log.
CREATE TABLE work_orders (
    vessel_id UUID NOT NULL,
    id UUID NOT NULL,
    compass_id UUID NOT NULL,
    state TEXT NOT NULL, -- checked by the program
    port TEXT NOT NULL,
    berth TEXT,
    planned_at BIGINT NOT NULL,
    adjuster_name TEXT,
    adjuster_licence TEXT,
    firm TEXT,
    created_at BIGINT NOT NULL,
    created_by TEXT NOT NULL,
    completed_at BIGINT,
    last_seq BIGINT NOT NULL, -- of the log
    last_sha256 TEXT NOT NULL, -- of the log's last line
    record TEXT, -- JSON: the adjustment record as signed
    verified_at BIGINT, -- when headings at sea verified the adjustment
    verification TEXT, -- JSON: the result then
    firm_id UUID, -- the firm that accepted the order
    answer_by BIGINT, -- earliest deadline of the open offers
    call_fit TEXT, -- fit of the agreed time since the port call moved; NULL: it did not move
    completion_received_at BIGINT, -- a phone may hold a completion back for days
    PRIMARY KEY (vessel_id, id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);
CREATE UNIQUE INDEX work_orders_by_id ON work_orders (id, vessel_id);
CREATE INDEX work_orders_by_answer ON work_orders (answer_by);
-- At most one open order per compass.
CREATE UNIQUE INDEX work_orders_one_open ON work_orders (vessel_id, compass_id)
    WHERE state IN ('planned', 'offered', 'proposed', 'declined', 'accepted', 'on_board',
                    'measured', 'adjusting');

-- The log of an order. Rows are never changed or removed: each line contains the hash of
-- the line before it.
CREATE TABLE work_order_entries (
    vessel_id UUID NOT NULL,
    order_id UUID NOT NULL,
    seq BIGINT NOT NULL, -- from 1
    id UUID NOT NULL,
    line TEXT NOT NULL, -- JSON, as hashed
    sha256 TEXT NOT NULL, -- of the line, hexadecimal
    PRIMARY KEY (vessel_id, order_id, seq),
    FOREIGN KEY (vessel_id, order_id) REFERENCES work_orders (vessel_id, id)
);

CREATE TABLE work_order_photos (
    vessel_id UUID NOT NULL,
    order_id UUID NOT NULL,
    id UUID NOT NULL,
    media_type TEXT NOT NULL,
    sha256 TEXT NOT NULL, -- hexadecimal
    bytes BYTEA NOT NULL,
    PRIMARY KEY (vessel_id, order_id, id),
    FOREIGN KEY (vessel_id, order_id) REFERENCES work_orders (vessel_id, id)
);

-- Offers of an order to firms: their state after the log's last entry, so that a firm's
-- orders can be found.
CREATE TABLE work_order_offers (
    vessel_id UUID NOT NULL,
    order_id UUID NOT NULL,
    firm_id UUID NOT NULL REFERENCES firms (id),
    state TEXT NOT NULL CHECK (state IN ('waiting', 'open', 'proposed', 'accepted', 'declined',
                                         'lapsed', 'withdrawn')),
    answer_by BIGINT, -- while an answer is due
    PRIMARY KEY (vessel_id, order_id, firm_id),
    FOREIGN KEY (vessel_id, order_id) REFERENCES work_orders (vessel_id, id)
);
CREATE INDEX work_order_offers_by_firm ON work_order_offers (firm_id, order_id);

-- Idempotency keys of writes to an order. They are kept as long as the order: a phone may
-- hold entries back for days before it sends them, or sends them again.
CREATE TABLE work_order_keys (
    vessel_id UUID NOT NULL,
    order_id UUID NOT NULL,
    tenant_id UUID NOT NULL, -- operator or firm
    key_hash BYTEA NOT NULL, -- SHA-256
    request_hash BYTEA NOT NULL, -- SHA-256
    entry_id UUID NOT NULL, -- first entry written by the request
    PRIMARY KEY (vessel_id, order_id, tenant_id, key_hash),
    FOREIGN KEY (vessel_id, order_id) REFERENCES work_orders (vessel_id, id)
);

-- The port call of a work order. The row may be written before its order.
CREATE TABLE schedule_orders (
    vessel_id UUID NOT NULL,
    order_id UUID NOT NULL,
    call_id UUID NOT NULL,
    PRIMARY KEY (vessel_id, order_id)
);
