-- Evidence: the server's keys, and its counter-signature of each entry of an order's log.

-- Ed25519 keys. The newest signs; the others stay, so that what they signed can be checked.
CREATE TABLE signing_keys (
    public_key TEXT NOT NULL, -- hexadecimal
    secret BYTEA NOT NULL,
    created_at BIGINT NOT NULL,
    retired_at BIGINT,
    PRIMARY KEY (public_key)
);

-- NULL: written before servers signed.
ALTER TABLE work_order_entries ADD COLUMN seal_key TEXT; -- hexadecimal
ALTER TABLE work_order_entries ADD COLUMN seal TEXT; -- the signature, hexadecimal
