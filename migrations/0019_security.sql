-- Security: refused sign-ins in the audit trail, devices that signed in before, sealed secrets,
-- what API tokens made, and quotas.

-- Lines of those who did not prove who they are. SQLite cannot widen a CHECK: a new table.
CREATE TABLE audit_lines_next (
    id UUID NOT NULL CONSTRAINT audit_lines_next_pkey PRIMARY KEY, -- of the request
    at BIGINT NOT NULL,
    operator_id UUID, -- its admins see the line
    firm_id UUID, -- its users see the line
    actor_kind TEXT NOT NULL, -- checked by the program
    actor_id UUID, -- user or agent
    actor_name TEXT NOT NULL, -- at that time
    token_id UUID,
    address TEXT NOT NULL, -- empty if unknown
    method TEXT NOT NULL,
    route TEXT NOT NULL,
    path TEXT NOT NULL, -- the route with its ids and numbers filled in
    vessel_id UUID,
    order_id UUID,
    status BIGINT, -- HTTP status; NULL: committed, but the response was not recorded
    account TEXT, -- e-mail address tried; NULL: none, or the request was not refused for it
    refusal TEXT -- why a sign-in or a token was refused; NULL: it was not
);
INSERT INTO audit_lines_next (id, at, operator_id, firm_id, actor_kind, actor_id, actor_name,
                              token_id, address, method, route, path, vessel_id, order_id, status)
SELECT id, at, operator_id, firm_id, actor_kind, actor_id, actor_name, token_id, address, method,
       route, path, vessel_id, order_id, status
FROM audit_lines;
DROP TABLE audit_lines;
ALTER TABLE audit_lines_next RENAME TO audit_lines;
CREATE INDEX audit_lines_by_operator ON audit_lines (operator_id, id);
CREATE INDEX audit_lines_by_firm ON audit_lines (firm_id, id);
CREATE INDEX audit_lines_by_time ON audit_lines (at);
CREATE INDEX audit_lines_refused ON audit_lines (at) WHERE refusal IS NOT NULL;

-- Time at which an operator's admins were last notified of many refusals.
ALTER TABLE operators ADD COLUMN refusals_notified_at BIGINT;

-- The wait follows from the count and the time of the last failure, so that a clock that was wrong
-- locks nobody out.
ALTER TABLE login_failures DROP COLUMN locked_until;

-- Browsers in which a user signed in before.
CREATE TABLE known_devices (
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    token_hash BYTEA NOT NULL, -- SHA-256
    last_sign_in_at BIGINT NOT NULL,
    PRIMARY KEY (user_id, token_hash)
);

-- Id of the key that seals a secret; NULL: stored in plain.
ALTER TABLE second_factors ADD COLUMN sealed_by TEXT;
ALTER TABLE webhooks ADD COLUMN sealed_by TEXT;
ALTER TABLE signing_keys ADD COLUMN sealed_by TEXT;

-- API token that made something; NULL: a person did.
ALTER TABLE receivers ADD COLUMN made_by_token UUID;
ALTER TABLE calendar_feeds ADD COLUMN made_by_token UUID;

-- Limits that a platform admin has set for an operator; no row means the default.
CREATE TABLE quotas (
    operator_id UUID NOT NULL REFERENCES operators (id),
    name TEXT NOT NULL,
    most BIGINT NOT NULL,
    PRIMARY KEY (operator_id, name)
);
