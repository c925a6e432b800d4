-- Public keys that firms sign records with. A row is never removed: a key is revoked.
CREATE TABLE firm_keys (
    id UUID NOT NULL PRIMARY KEY,
    firm_id UUID NOT NULL REFERENCES firms (id),
    public_key TEXT NOT NULL, -- Ed25519, lower-case hexadecimal
    name TEXT NOT NULL,
    created_at BIGINT NOT NULL,
    created_by TEXT NOT NULL,
    revoked_at BIGINT
);
CREATE INDEX firm_keys_by_firm ON firm_keys (firm_id, id);
CREATE UNIQUE INDEX firm_keys_active ON firm_keys (public_key) WHERE revoked_at IS NULL;
