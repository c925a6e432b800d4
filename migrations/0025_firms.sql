-- Firms that adjust compasses, and the operators they work for. What a firm offers
-- (ports, fees, teams) stands in tables of its own.
CREATE TABLE firms (
    id UUID NOT NULL PRIMARY KEY,
    name TEXT NOT NULL,
    created_at BIGINT NOT NULL
);
CREATE TABLE operator_firms (
    operator_id UUID NOT NULL REFERENCES operators (id),
    firm_id UUID NOT NULL REFERENCES firms (id),
    created_at BIGINT NOT NULL,
    PRIMARY KEY (operator_id, firm_id)
);
CREATE INDEX operator_firms_by_firm ON operator_firms (firm_id, operator_id);

-- Firms have people too. SQLite can change no CHECK: the table is written anew, and those
-- that refer to it before it. Their old ones go first, so that nothing of theirs is
-- deleted along with a user; the new name is followed by what refers to it.
CREATE TABLE people (
    id UUID NOT NULL PRIMARY KEY,
    operator_id UUID REFERENCES operators (id),
    firm_id UUID REFERENCES firms (id),
    email TEXT NOT NULL UNIQUE, -- lower case
    name TEXT NOT NULL,
    role TEXT NOT NULL CHECK (role IN ('admin', 'viewer', 'adjuster', 'platform_admin')),
    password_hash TEXT NOT NULL, -- Argon2id, PHC string
    created_at BIGINT NOT NULL,
    CHECK ((operator_id IS NOT NULL) = (role IN ('admin', 'viewer'))),
    CHECK ((firm_id IS NOT NULL) = (role = 'adjuster'))
);
INSERT INTO people (id, operator_id, email, name, role, password_hash, created_at)
SELECT id, operator_id, email, name, role, password_hash, created_at FROM users;

CREATE TABLE people_sessions (
    token_hash BYTEA NOT NULL PRIMARY KEY, -- SHA-256
    user_id UUID NOT NULL REFERENCES people (id) ON DELETE CASCADE,
    created_at BIGINT NOT NULL,
    expires_at BIGINT NOT NULL
);
INSERT INTO people_sessions (token_hash, user_id, created_at, expires_at)
SELECT token_hash, user_id, created_at, expires_at FROM sessions;

CREATE TABLE people_tokens (
    id UUID NOT NULL PRIMARY KEY,
    user_id UUID NOT NULL REFERENCES people (id) ON DELETE CASCADE,
    token_hash BYTEA NOT NULL UNIQUE, -- SHA-256
    name TEXT NOT NULL,
    scope TEXT NOT NULL CHECK (scope IN ('read', 'write')),
    created_at BIGINT NOT NULL,
    expires_at BIGINT NOT NULL,
    last_used_at BIGINT
);
INSERT INTO people_tokens (id, user_id, token_hash, name, scope, created_at, expires_at,
                           last_used_at)
SELECT id, user_id, token_hash, name, scope, created_at, expires_at, last_used_at
FROM api_tokens;

DROP TABLE sessions;
DROP TABLE api_tokens;
DROP TABLE users;
ALTER TABLE people RENAME TO users;
ALTER TABLE people_sessions RENAME TO sessions;
ALTER TABLE people_tokens RENAME TO api_tokens;
CREATE INDEX users_by_operator ON users (operator_id, id);
CREATE INDEX users_by_firm ON users (firm_id, id);
CREATE INDEX sessions_by_expiry ON sessions (expires_at);
CREATE INDEX api_tokens_by_user ON api_tokens (user_id, id);

-- A key is its operator's or its firm's own.
CREATE TABLE tenants_keys (
    tenant_id UUID NOT NULL,
    key_hash BYTEA NOT NULL,
    request_hash BYTEA NOT NULL,
    resource_id UUID NOT NULL,
    created_at BIGINT NOT NULL,
    PRIMARY KEY (tenant_id, key_hash)
);
INSERT INTO tenants_keys (tenant_id, key_hash, request_hash, resource_id, created_at)
SELECT operator_id, key_hash, request_hash, resource_id, created_at FROM idempotency_keys;
DROP TABLE idempotency_keys;
ALTER TABLE tenants_keys RENAME TO idempotency_keys;

-- A firm is told of its orders: live, and by webhooks of its own.
ALTER TABLE events ADD COLUMN firm_id UUID; -- who may know of it besides the operator
ALTER TABLE events ADD COLUMN order_id UUID;
CREATE INDEX events_by_firm ON events (firm_id, id);

ALTER TABLE receivers ADD COLUMN of_operator UUID REFERENCES operators (id);
UPDATE receivers SET of_operator = operator_id;
ALTER TABLE receivers DROP COLUMN operator_id;
ALTER TABLE receivers RENAME COLUMN of_operator TO operator_id;
ALTER TABLE receivers ADD COLUMN firm_id UUID REFERENCES firms (id)
    CHECK ((operator_id IS NULL) <> (firm_id IS NULL));

DROP INDEX webhooks_by_operator;
ALTER TABLE webhooks ADD COLUMN of_operator UUID REFERENCES operators (id);
UPDATE webhooks SET of_operator = operator_id;
ALTER TABLE webhooks DROP COLUMN operator_id;
ALTER TABLE webhooks RENAME COLUMN of_operator TO operator_id;
ALTER TABLE webhooks ADD COLUMN firm_id UUID REFERENCES firms (id)
    CHECK ((operator_id IS NULL) <> (firm_id IS NULL));
CREATE INDEX webhooks_by_operator ON webhooks (operator_id, id);
CREATE INDEX webhooks_by_firm ON webhooks (firm_id, id);
