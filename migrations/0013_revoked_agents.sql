-- From when on an agent's token is known no more.
ALTER TABLE agents ADD COLUMN revoked_at BIGINT;
