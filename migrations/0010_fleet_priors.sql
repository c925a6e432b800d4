-- Fleet's prior: what the vessels of a class say of a new one, and the prior of each compass.

-- Name of the class of sister ships, as the operator calls it; NULL: none.
ALTER TABLE vessels ADD COLUMN sister_class TEXT;

-- Published evidence of a class's vessels. Rows are never changed or removed.
CREATE TABLE fleet_priors (
    operator_id UUID NOT NULL REFERENCES operators (id),
    id UUID NOT NULL,
    published_at BIGINT NOT NULL,
    estimator TEXT NOT NULL, -- whose analyses begin with it
    method BIGINT NOT NULL, -- version of the method
    class_kind TEXT NOT NULL CHECK (class_kind IN ('sisters', 'operator')),
    class_name TEXT NOT NULL, -- of the sister ships; the operator's id for the whole fleet
    role TEXT NOT NULL CHECK (role IN ('standard', 'steering', 'transmitting')), -- of the compasses
    edition BIGINT NOT NULL, -- from 1
    ships BIGINT NOT NULL, -- number of vessels with evidence
    prior TEXT NOT NULL, -- JSON
    PRIMARY KEY (operator_id, id),
    UNIQUE (operator_id, estimator, method, class_kind, class_name, role, edition)
);

-- The prior that each compass was derived with, by estimator. Rows are never changed.
CREATE TABLE vessel_priors (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    estimator TEXT NOT NULL,
    chosen_at BIGINT NOT NULL,
    prior TEXT NOT NULL, -- JSON
    refused TEXT NOT NULL, -- JSON array: classes with too few vessels
    PRIMARY KEY (vessel_id, compass_id, estimator),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);
