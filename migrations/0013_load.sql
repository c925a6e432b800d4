-- Load: a queue that many workers claim from, and the probe of a full disk.

-- Time at which the job was last put into the queue. A clock that reads less was set back.
ALTER TABLE jobs ADD COLUMN queued_at BIGINT NOT NULL DEFAULT 0;
CREATE INDEX jobs_by_queued ON jobs (state, queued_at);
CREATE INDEX jobs_by_lease ON jobs (state, lease_until);

-- Bytes written to find out whether the disk has space again; removed at once.
CREATE TABLE disk_probes (
    bytes BYTEA NOT NULL
);
