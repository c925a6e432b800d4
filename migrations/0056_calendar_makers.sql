-- A calendar ends with the person who made it; of those made before, nobody noted who did.
ALTER TABLE calendar_feeds ADD COLUMN user_id UUID REFERENCES users (id) ON DELETE CASCADE;
CREATE INDEX calendar_feeds_by_user ON calendar_feeds (user_id);
