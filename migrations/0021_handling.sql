-- Handling of alerts by several people, tags of vessels, and how each user looks at the fleet.

-- User who is to see to the alert.
ALTER TABLE alerts ADD COLUMN assigned_to UUID REFERENCES users (id) ON DELETE SET NULL;
-- Until then it is not listed among the alerts to see to, unless it gets worse.
ALTER TABLE alerts ADD COLUMN snoozed_until BIGINT;

CREATE TABLE alert_comments (
    vessel_id UUID NOT NULL,
    alert_id UUID NOT NULL,
    id UUID NOT NULL,
    at BIGINT NOT NULL,
    by_name TEXT NOT NULL, -- as it was then
    text TEXT NOT NULL,
    PRIMARY KEY (vessel_id, alert_id, id),
    FOREIGN KEY (vessel_id, alert_id) REFERENCES alerts (vessel_id, id)
);

CREATE TABLE vessel_tags (
    vessel_id UUID NOT NULL REFERENCES vessels (id),
    tag TEXT NOT NULL,
    PRIMARY KEY (vessel_id, tag)
);

-- Saved views of a user's fleet.
CREATE TABLE fleet_views (
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    name TEXT NOT NULL,
    search TEXT NOT NULL, -- as in the dashboard's address
    PRIMARY KEY (user_id, name)
);
