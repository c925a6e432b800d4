-- Sessions that can be listed and ended one by one. Those there were end with this:
-- everyone signs in again.
DROP TABLE sessions;
CREATE TABLE sessions (
    id UUID NOT NULL PRIMARY KEY,
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    token_hash BYTEA NOT NULL UNIQUE, -- SHA-256
    created_at BIGINT NOT NULL,
    last_seen_at BIGINT NOT NULL, -- to some minutes
    expires_at BIGINT NOT NULL,
    address TEXT NOT NULL, -- where the sign-in came from
    user_agent TEXT NOT NULL
);
CREATE INDEX sessions_by_expiry ON sessions (expires_at);
CREATE INDEX sessions_by_user ON sessions (user_id, id);

-- Failures are counted for each e-mail, and for each address they come from.
ALTER TABLE login_failures RENAME COLUMN email_hash TO subject_hash;

-- Who was invited and has no password yet has an empty hash, which no password matches.
ALTER TABLE users ADD COLUMN disabled_at BIGINT; -- since then nothing of theirs works
CREATE TABLE invitations (
    user_id UUID NOT NULL PRIMARY KEY REFERENCES users (id) ON DELETE CASCADE,
    code_hash BYTEA NOT NULL UNIQUE, -- SHA-256
    created_at BIGINT NOT NULL,
    expires_at BIGINT NOT NULL
);

ALTER TABLE operators ADD COLUMN second_factor_required BOOLEAN NOT NULL DEFAULT FALSE;
CREATE TABLE second_factors (
    user_id UUID NOT NULL PRIMARY KEY REFERENCES users (id) ON DELETE CASCADE,
    secret BYTEA NOT NULL, -- not hashed: codes are made from it
    created_at BIGINT NOT NULL,
    confirmed_at BIGINT, -- none: shown, but no code has come yet
    last_step BIGINT NOT NULL -- of the code used last: none works twice
);
CREATE TABLE recovery_codes (
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    code_hash BYTEA NOT NULL, -- SHA-256
    PRIMARY KEY (user_id, code_hash)
);
