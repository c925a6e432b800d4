-- The binnacle of a compass, as docs/binnacle.md has it. A row is never changed or
-- removed: the highest revision is how it is now.
CREATE TABLE binnacles (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    revision BIGINT NOT NULL, -- from 1
    id UUID NOT NULL,
    at BIGINT NOT NULL,
    author_id UUID NOT NULL,
    author_name TEXT NOT NULL,
    reason TEXT,
    binnacle TEXT NOT NULL, -- JSON
    PRIMARY KEY (vessel_id, compass_id, revision),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);
