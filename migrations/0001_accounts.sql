-- Companies with a fleet, their people, and what these sign in with.
CREATE TABLE operators (
    id UUID NOT NULL PRIMARY KEY,
    name TEXT NOT NULL,
    created_at BIGINT NOT NULL
);

CREATE TABLE users (
    id UUID NOT NULL PRIMARY KEY,
    operator_id UUID REFERENCES operators (id), -- none for a platform admin
    email TEXT NOT NULL UNIQUE, -- lower case
    name TEXT NOT NULL,
    role TEXT NOT NULL CHECK (role IN ('admin', 'viewer', 'platform_admin')),
    password_hash TEXT NOT NULL, -- Argon2id, PHC string
    created_at BIGINT NOT NULL,
    CHECK ((operator_id IS NULL) = (role = 'platform_admin'))
);

CREATE TABLE sessions (
    token_hash BYTEA NOT NULL PRIMARY KEY, -- SHA-256
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    created_at BIGINT NOT NULL,
    expires_at BIGINT NOT NULL
);
CREATE INDEX sessions_by_expiry ON sessions (expires_at);

CREATE TABLE api_tokens (
    id UUID NOT NULL PRIMARY KEY,
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    token_hash BYTEA NOT NULL UNIQUE, -- SHA-256
    name TEXT NOT NULL,
    scope TEXT NOT NULL CHECK (scope IN ('read', 'write')),
    created_at BIGINT NOT NULL,
    expires_at BIGINT NOT NULL,
    last_used_at BIGINT
);
CREATE INDEX api_tokens_by_user ON api_tokens (user_id, id);

-- One row for each e-mail that failed to sign in lately, known or not.
CREATE TABLE login_failures (
    email_hash BYTEA NOT NULL PRIMARY KEY,
    failures BIGINT NOT NULL,
    last_at BIGINT NOT NULL,
    locked_until BIGINT NOT NULL
);

-- What a create request with an Idempotency-Key made.
CREATE TABLE idempotency_keys (
    operator_id UUID NOT NULL REFERENCES operators (id) ON DELETE CASCADE,
    key_hash BYTEA NOT NULL,
    request_hash BYTEA NOT NULL,
    resource_id UUID NOT NULL,
    created_at BIGINT NOT NULL,
    PRIMARY KEY (operator_id, key_hash)
);
