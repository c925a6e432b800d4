-- Interference with receivers of satellites, by the latest analysis of each compass.
CREATE TABLE gnss_interference (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    began_at BIGINT NOT NULL,
    ended_at BIGINT, -- NULL while it lasts
    lat DOUBLE PRECISION NOT NULL,
    lon DOUBLE PRECISION NOT NULL,
    PRIMARY KEY (vessel_id, compass_id, began_at),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);
