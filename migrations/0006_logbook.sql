-- Logbook: what people report about a vessel.

-- Entries as they now stand. They are never removed: an entry is revised, or withdrawn
-- and kept.
CREATE TABLE logbook_entries (
    vessel_id UUID NOT NULL REFERENCES vessels (id),
    id UUID NOT NULL, -- made on board for entries reported there
    compass_id UUID, -- NULL: it concerns the whole vessel
    kind TEXT NOT NULL,
    from_at BIGINT NOT NULL,
    to_at BIGINT CHECK (to_at >= from_at), -- NULL: a moment, or it goes on
    cargo TEXT,
    hatch TEXT,
    port TEXT,
    note TEXT NOT NULL,
    created_at BIGINT NOT NULL,
    created_by TEXT NOT NULL, -- a name; may be empty for reports from on board
    author TEXT NOT NULL CHECK (author IN ('user', 'agent', 'firm')),
    revision BIGINT NOT NULL, -- from 1
    board_revision BIGINT, -- latest revision from on board
    revised_at BIGINT,
    revised_by TEXT,
    withdrawn_at BIGINT,
    withdrawn_by TEXT,
    withdrawal_reason TEXT,
    PRIMARY KEY (vessel_id, id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id),
    CHECK ((withdrawn_at IS NULL) = (withdrawn_by IS NULL))
);
CREATE INDEX logbook_entries_by_time ON logbook_entries (vessel_id, from_at, id);

-- Each revision of an entry as written. Rows are never changed or removed.
CREATE TABLE logbook_revisions (
    vessel_id UUID NOT NULL,
    entry_id UUID NOT NULL,
    revision BIGINT NOT NULL,
    at BIGINT NOT NULL,
    author TEXT NOT NULL CHECK (author IN ('user', 'agent', 'firm')),
    author_id UUID NOT NULL,
    author_name TEXT NOT NULL,
    entry TEXT NOT NULL, -- JSON
    PRIMARY KEY (vessel_id, entry_id, revision),
    FOREIGN KEY (vessel_id, entry_id) REFERENCES logbook_entries (vessel_id, id)
);
