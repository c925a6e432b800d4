-- Orders to adjust a compass. What happened to one stands in its entries; the columns
-- here are how it stands after the last of them.
CREATE TABLE work_orders (
    vessel_id UUID NOT NULL,
    id UUID NOT NULL,
    compass_id UUID NOT NULL,
    state TEXT NOT NULL, -- the program knows them
    port TEXT NOT NULL,
    berth TEXT,
    planned_at BIGINT NOT NULL,
    adjuster_name TEXT,
    adjuster_licence TEXT,
    firm TEXT,
    created_at BIGINT NOT NULL,
    created_by TEXT NOT NULL,
    completed_at BIGINT,
    last_seq BIGINT NOT NULL,
    last_sha256 TEXT NOT NULL,
    record TEXT, -- JSON, the adjustment record as it was signed
    PRIMARY KEY (vessel_id, id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);
CREATE UNIQUE INDEX work_orders_by_id ON work_orders (id, vessel_id);
-- A compass is adjusted by one order at a time.
CREATE UNIQUE INDEX work_orders_one_open ON work_orders (vessel_id, compass_id)
    WHERE state IN ('planned', 'measured', 'adjusting');

-- The log of an order. A row is never changed or removed; each line names the hash of
-- the line before it.
CREATE TABLE work_order_entries (
    vessel_id UUID NOT NULL,
    order_id UUID NOT NULL,
    seq BIGINT NOT NULL, -- from 1
    id UUID NOT NULL,
    line TEXT NOT NULL, -- JSON, as it is hashed
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

-- The order that foretold a model; none for a model that was fitted.
ALTER TABLE models ADD COLUMN foretold_by UUID;
