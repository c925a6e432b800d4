-- Signing in by the word of an OpenID Connect provider.
CREATE TABLE identities (
    issuer TEXT NOT NULL,
    subject TEXT NOT NULL, -- the person, as the provider names them for good
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    created_at BIGINT NOT NULL,
    PRIMARY KEY (issuer, subject),
    UNIQUE (user_id, issuer)
);

-- Sign-ins that came back from the provider: none comes back twice.
CREATE TABLE provider_returns (
    state_hash BYTEA NOT NULL PRIMARY KEY, -- SHA-256
    user_id UUID REFERENCES users (id) ON DELETE CASCADE, -- who is still to send a code
    expires_at BIGINT NOT NULL
);
CREATE INDEX provider_returns_by_expiry ON provider_returns (expires_at);

ALTER TABLE sessions ADD COLUMN provider TEXT; -- whose word opened it; none: a password
