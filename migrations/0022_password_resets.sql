-- Codes of people who forgot their password, apart from invitations.
CREATE TABLE password_resets (
    user_id UUID NOT NULL PRIMARY KEY REFERENCES users (id) ON DELETE CASCADE,
    code_hash BYTEA NOT NULL UNIQUE, -- SHA-256
    created_at BIGINT NOT NULL,
    expires_at BIGINT NOT NULL
);
