-- What began the model's epoch: a kind of logbook entry, or the cause of a change;
-- none in the first epoch, and in what was stored before it was kept.
ALTER TABLE models ADD COLUMN epoch_begun_by TEXT;

-- The epochs say why the current one has no model.
ALTER TABLE analyses DROP COLUMN refusal;
