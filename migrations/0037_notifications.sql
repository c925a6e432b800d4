-- How each person wants to be told; no row means the defaults.
CREATE TABLE notification_settings (
    user_id UUID NOT NULL PRIMARY KEY REFERENCES users (id) ON DELETE CASCADE,
    settings TEXT NOT NULL, -- JSON
    changed_at BIGINT NOT NULL
);

-- What each person ought to know; forgotten after a season.
CREATE TABLE notifications (
    user_id UUID NOT NULL REFERENCES users (id) ON DELETE CASCADE,
    id UUID NOT NULL,
    kind TEXT NOT NULL, -- the program knows them
    urgent BOOLEAN NOT NULL, -- does not wait for anything
    subject TEXT NOT NULL,
    text TEXT NOT NULL,
    path TEXT NOT NULL, -- of the dashboard's page
    vessel_id UUID,
    order_id UUID,
    alert_id UUID,
    created_at BIGINT NOT NULL,
    read_at BIGINT,
    mail_at BIGINT, -- when a letter is to tell of it; none when none is, or one has
    PRIMARY KEY (user_id, id)
);
CREATE INDEX notifications_by_mail ON notifications (mail_at) WHERE mail_at IS NOT NULL;
CREATE INDEX notifications_by_time ON notifications (created_at);

-- What people were last told of a compass's need.
CREATE TABLE needs_told (
    vessel_id UUID NOT NULL,
    compass_id UUID NOT NULL,
    due_on TEXT NOT NULL, -- ISO 8601
    urgency TEXT NOT NULL,
    PRIMARY KEY (vessel_id, compass_id),
    FOREIGN KEY (vessel_id, compass_id) REFERENCES compasses (vessel_id, id)
);
