-- What people report about a vessel. An entry is never removed: it is revised, or
-- withdrawn and kept.
CREATE TABLE logbook_entries (
    vessel_id UUID NOT NULL REFERENCES vessels (id),
    id UUID NOT NULL, -- made on board where it was reported there
    compass_id UUID, -- none: it concerns the whole ship
    kind TEXT NOT NULL,
    from_at BIGINT NOT NULL,
    to_at BIGINT CHECK (to_at >= from_at), -- none: an event, or it goes on
    cargo TEXT,
    hatch TEXT,
    port TEXT,
    note TEXT NOT NULL,
    created_at BIGINT NOT NULL,
    created_by TEXT NOT NULL, -- a name; may be empty for a report from on board
    author TEXT NOT NULL CHECK (author IN ('user', 'agent', 'firm')),
    revision BIGINT NOT NULL, -- from 1
    board_revision BIGINT, -- the latest that came from on board
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

-- Each revision of an entry as it was written. A row is never changed or removed.
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

-- Events are of more kinds now. They are kept for a day, for dashboards that were
-- away: these read everything anew.
DROP TABLE events;
CREATE TABLE events (
    id UUID NOT NULL PRIMARY KEY,
    operator_id UUID NOT NULL REFERENCES operators (id),
    vessel_id UUID NOT NULL,
    kind TEXT NOT NULL, -- the program knows them; SQLite could not widen a CHECK
    created_at BIGINT NOT NULL
);
CREATE INDEX events_by_operator ON events (operator_id, id);
CREATE INDEX events_by_time ON events (created_at);
