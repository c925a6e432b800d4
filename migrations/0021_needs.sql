-- What rules on adjusting ask about a vessel.
CREATE TABLE vessel_particulars (
    vessel_id UUID NOT NULL PRIMARY KEY REFERENCES vessels (id),
    particulars TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL,
    changed_by TEXT NOT NULL
);

-- On what terms a firm works for an operator: where, when, for how much.
CREATE TABLE firm_terms (
    operator_id UUID NOT NULL REFERENCES operators (id),
    firm_id UUID NOT NULL,
    terms TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL,
    changed_by TEXT NOT NULL,
    PRIMARY KEY (operator_id, firm_id)
);
