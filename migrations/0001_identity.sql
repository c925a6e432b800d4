-- Identity: operators and firms (the tenants), their users, the ways users sign in,
-- idempotency keys and the audit trail.

-- Companies with a fleet.
CREATE TABLE operators (
    id UUID NOT NULL PRIMARY KEY,
    name TEXT NOT NULL,
    created_at BIGINT NOT NULL,
    second_factor_required BOOLEAN NOT NULL DEFAULT FALSE
);

-- Companies that adjust compasses.
CREATE TABLE firms (
    id UUID NOT NULL PRIMARY KEY,
    name TEXT NOT NULL,
    created_at BIGINT NOT NULL
);

-- A user belongs to an operator or to a firm; a platform admin to neither.
CREATE TABLE users (
    id UUID NOT NULL CONSTRAINT people_pkey PRIMARY KEY,
    operator_id UUID CONSTRAINT people_operator_id_fkey REFERENCES operators (id),
    firm_id UUID CONSTRAINT people_firm_id_fkey REFERENCES firms (id),
    email TEXT NOT NULL CONSTRAINT people_email_key UNIQUE, -- lower case
    name TEXT NOT NULL,
    role TEXT NOT NULL CONSTRAINT people_role_check
        CHECK (role IN ('admin', 'viewer', 'adjuster', 'platform_admin')),
    password_hash TEXT NOT NULL, -- Argon2id, PHC string; empty before a password is set
    created_at BIGINT NOT NULL,
    disabled_at BIGINT, -- sign-in, sessions and tokens are refused from then on
    CONSTRAINT people_check CHECK ((operator_id IS NOT NULL) = (role IN ('admin', 'viewer'))),
    CONSTRAINT people_check1 CHECK ((firm_id IS NOT NULL) = (role = 'adjuster'))
);
CREATE INDEX users_by_operator ON users (operator_id, id);
CREATE INDEX users_by_firm ON users (firm_id, id);

-- One-time codes with which invited users set their password.
CREATE TABLE invitations (
    user_id UUID NOT NULL PRIMARY KEY REFERENCES users (id) ON DELETE CASCADE,
    code_hash BYTEA NOT NULL UNIQUE, -- SHA-256
    created_at BIGINT NOT NULL,
    expires_at BIGINT NOT NULL
);

-- Browser sessions, listed and ended one by one.
CREATE TABLE sessions (
    id UUID NOT NULL PRIMARY KEY,
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    token_hash BYTEA NOT NULL UNIQUE, -- SHA-256
    created_at BIGINT NOT NULL,
    last_seen_at BIGINT NOT NULL, -- accurate to a few minutes
    expires_at BIGINT NOT NULL,
    address TEXT NOT NULL, -- the client's at sign-in
    user_agent TEXT NOT NULL,
    provider TEXT -- sign-in provider that vouched for the user; NULL: password
);
CREATE INDEX sessions_by_expiry ON sessions (expires_at);
CREATE INDEX sessions_by_user ON sessions (user_id, id);

-- Bearer tokens of the API.
CREATE TABLE api_tokens (
    id UUID NOT NULL CONSTRAINT people_tokens_pkey PRIMARY KEY,
    user_id UUID NOT NULL CONSTRAINT people_tokens_user_id_fkey
        REFERENCES users (id) ON DELETE CASCADE,
    token_hash BYTEA NOT NULL CONSTRAINT people_tokens_token_hash_key UNIQUE, -- SHA-256
    name TEXT NOT NULL,
    scope TEXT NOT NULL CONSTRAINT people_tokens_scope_check CHECK (scope IN ('read', 'write')),
    created_at BIGINT NOT NULL,
    expires_at BIGINT NOT NULL,
    last_used_at BIGINT
);
CREATE INDEX api_tokens_by_user ON api_tokens (user_id, id);

-- Recent failed sign-ins, per e-mail address (known or not) and per client address.
CREATE TABLE login_failures (
    subject_hash BYTEA NOT NULL PRIMARY KEY,
    failures BIGINT NOT NULL,
    last_at BIGINT NOT NULL,
    locked_until BIGINT NOT NULL
);

-- Second factors: time-based one-time passwords.
CREATE TABLE second_factors (
    user_id UUID NOT NULL PRIMARY KEY REFERENCES users (id) ON DELETE CASCADE,
    secret BYTEA NOT NULL, -- not hashed: codes are computed from it
    created_at BIGINT NOT NULL,
    confirmed_at BIGINT, -- NULL before the first correct code
    last_step BIGINT NOT NULL -- time step of the last code used: no code works twice
);

-- One-time codes for a lost second factor.
CREATE TABLE recovery_codes (
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    code_hash BYTEA NOT NULL, -- SHA-256
    PRIMARY KEY (user_id, code_hash)
);

-- Users as an OpenID Connect provider identifies them.
CREATE TABLE identities (
    issuer TEXT NOT NULL,
    subject TEXT NOT NULL, -- the provider's permanent identifier of the user
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    created_at BIGINT NOT NULL,
    PRIMARY KEY (issuer, subject),
    UNIQUE (user_id, issuer)
);

-- Sign-ins that returned from the provider: each is accepted once.
CREATE TABLE provider_returns (
    state_hash BYTEA NOT NULL PRIMARY KEY, -- SHA-256
    user_id UUID REFERENCES users (id) ON DELETE CASCADE, -- still to send a second factor
    expires_at BIGINT NOT NULL
);
CREATE INDEX provider_returns_by_expiry ON provider_returns (expires_at);

-- Idempotency keys of create requests, with the resource that each created.
CREATE TABLE idempotency_keys (
    tenant_id UUID NOT NULL, -- operator or firm
    key_hash BYTEA NOT NULL,
    request_hash BYTEA NOT NULL,
    resource_id UUID NOT NULL,
    created_at BIGINT NOT NULL,
    CONSTRAINT tenants_keys_pkey PRIMARY KEY (tenant_id, key_hash)
);

-- Audit trail: every change, and every read of vessel data by a firm. A line is written
-- in the transaction that it records. Only its status is set later, once. Lines are
-- removed after the retention period. There are no foreign keys: a line outlives the
-- rows that it names.
CREATE TABLE audit_lines (
    id UUID NOT NULL PRIMARY KEY, -- of the request
    at BIGINT NOT NULL,
    operator_id UUID, -- its admins see the line
    firm_id UUID, -- its users see the line
    actor_kind TEXT NOT NULL CHECK (actor_kind IN ('user', 'token', 'agent', 'command')),
    actor_id UUID, -- user or agent
    actor_name TEXT NOT NULL, -- at that time
    token_id UUID,
    address TEXT NOT NULL, -- empty if unknown
    method TEXT NOT NULL,
    route TEXT NOT NULL,
    path TEXT NOT NULL, -- the route with its ids and numbers filled in
    vessel_id UUID,
    order_id UUID,
    status BIGINT -- HTTP status; NULL: committed, but the response was not recorded
);
CREATE INDEX audit_lines_by_operator ON audit_lines (operator_id, id);
CREATE INDEX audit_lines_by_firm ON audit_lines (firm_id, id);
CREATE INDEX audit_lines_by_time ON audit_lines (at);
