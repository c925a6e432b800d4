CREATE TABLE IF NOT EXISTS state (
    name  TEXT PRIMARY KEY,
    value TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS pending_samples (
    id          INTEGER PRIMARY KEY,
    time_micros BIGINT NOT NULL,
    sample      TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS pending_tally (
    reason  TEXT PRIMARY KEY,
    windows BIGINT NOT NULL
);
CREATE TABLE IF NOT EXISTS batches (
    seq      BIGINT PRIMARY KEY,
    bytes    BLOB NOT NULL,
    samples  BIGINT NOT NULL,
    standing TEXT NOT NULL CHECK (standing IN ('waiting', 'acknowledged', 'parked')),
    problem  TEXT,
    urgent   BOOLEAN NOT NULL DEFAULT FALSE,
    tried    BOOLEAN NOT NULL DEFAULT FALSE,
    thinned  BIGINT NOT NULL DEFAULT 0,
    burst    BIGINT NOT NULL DEFAULT 0, -- messages that are out; -1 all, -2 none ever
    acknowledged_micros BIGINT -- by the shore's clock
);
CREATE TABLE IF NOT EXISTS acknowledged (
    id      INTEGER PRIMARY KEY,
    stream  TEXT NOT NULL,
    seq     BIGINT NOT NULL,
    samples BIGINT NOT NULL,
    crc32   BIGINT NOT NULL,
    UNIQUE (stream, seq)
);
CREATE TABLE IF NOT EXISTS quarantine (
    id      INTEGER PRIMARY KEY,
    bytes   BLOB NOT NULL,
    problem TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS reports (
    number         INTEGER PRIMARY KEY,
    id             TEXT NOT NULL UNIQUE,
    report         TEXT NOT NULL,
    written_micros BIGINT NOT NULL,
    standing       TEXT NOT NULL CHECK (standing IN ('waiting', 'ashore', 'refused')),
    problem        TEXT
);
CREATE TABLE IF NOT EXISTS azimuths (
    number         INTEGER PRIMARY KEY,
    id             TEXT NOT NULL UNIQUE,
    azimuth        TEXT NOT NULL,
    written_micros BIGINT NOT NULL,
    standing       TEXT NOT NULL CHECK (standing IN ('waiting', 'ashore', 'refused')),
    problem        TEXT
);
CREATE TABLE IF NOT EXISTS actions (
    number    INTEGER PRIMARY KEY,
    at_micros BIGINT NOT NULL,
    address   TEXT NOT NULL,
    action    TEXT NOT NULL,
    result    TEXT NOT NULL
);
