-- Since when the greatest deviation where a ship is has not been less than so much: what
-- counts days from when a limit was passed. Later days have higher ones.
CREATE TABLE deviation_since (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    since TEXT NOT NULL, -- a day, UTC
    at_least_deg DOUBLE PRECISION NOT NULL,
    PRIMARY KEY (vessel_id, compass_id, since),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);
