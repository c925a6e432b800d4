-- What ships say of alerts of their own, as far as the newest revision of each goes:
-- derived from the batches, which may come in any order.
CREATE TABLE ship_alerts (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    id UUID NOT NULL, -- made on board
    revision BIGINT NOT NULL,
    at BIGINT NOT NULL, -- when that revision was made, by the ship's clock
    alert TEXT NOT NULL, -- JSON
    PRIMARY KEY (vessel_id, compass_id, id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);
