-- The keys under which an order was written to. They are kept as long as the order: a
-- phone may keep what was entered for days before it is sent, or sent again.
CREATE TABLE work_order_keys (
    vessel_id UUID NOT NULL,
    order_id UUID NOT NULL,
    tenant_id UUID NOT NULL, -- whose key it is: the operator's or a firm's
    key_hash BYTEA NOT NULL, -- SHA-256
    request_hash BYTEA NOT NULL, -- SHA-256
    entry_id UUID NOT NULL, -- the first entry that the request wrote
    PRIMARY KEY (vessel_id, order_id, tenant_id, key_hash),
    FOREIGN KEY (vessel_id, order_id) REFERENCES work_orders (vessel_id, id)
);
INSERT INTO work_order_keys (vessel_id, order_id, tenant_id, key_hash, request_hash, entry_id)
SELECT entry.vessel_id, entry.order_id, known.tenant_id, known.key_hash, known.request_hash, entry.id
FROM idempotency_keys known
JOIN work_order_entries entry ON entry.id = known.resource_id;
