-- When and about where each compass was disturbed in passing, by its last analysis.
-- Ships tell each other what it was; nobody is shown another's rows.
CREATE TABLE disturbances (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    began_at BIGINT NOT NULL,
    ended_at BIGINT NOT NULL, -- when it was last seen, if it lasts
    lat DOUBLE PRECISION NOT NULL,
    lon DOUBLE PRECISION NOT NULL,
    PRIMARY KEY (vessel_id, compass_id, began_at),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);
CREATE INDEX disturbances_by_time ON disturbances (began_at);
CREATE INDEX disturbances_by_place ON disturbances (lat);
