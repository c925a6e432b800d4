-- Form of a webhook's messages: ours, or that of a chat.
ALTER TABLE webhooks ADD COLUMN format TEXT NOT NULL DEFAULT 'binnacle'
    CHECK (format IN ('binnacle', 'slack', 'teams'));
