-- Who changed what, and what firms read of ships. A line is written with what it tells of,
-- and never changed but for its status, once; it goes when it is as old as is kept. Nothing
-- is referred to: a line outlives what it tells of.
CREATE TABLE audit_lines (
    id UUID NOT NULL PRIMARY KEY, -- the request's
    at BIGINT NOT NULL,
    operator_id UUID, -- whose admins see it
    firm_id UUID, -- whose people see it
    actor_kind TEXT NOT NULL CHECK (actor_kind IN ('user', 'token', 'agent', 'command')),
    actor_id UUID, -- of the user or the agent
    actor_name TEXT NOT NULL, -- at that time
    token_id UUID,
    address TEXT NOT NULL, -- empty if not known
    method TEXT NOT NULL,
    route TEXT NOT NULL,
    path TEXT NOT NULL, -- the route with its ids and numbers, nothing else
    vessel_id UUID,
    order_id UUID,
    status BIGINT -- none: it was done, and no answer was noted
);
CREATE INDEX audit_lines_by_operator ON audit_lines (operator_id, id);
CREATE INDEX audit_lines_by_firm ON audit_lines (firm_id, id);
CREATE INDEX audit_lines_by_time ON audit_lines (at);
