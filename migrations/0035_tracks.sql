-- Where a compass's samples were lately taken, thinned for a map of the fleet: derived
-- from the samples like everything else here; none before the next analysis.
ALTER TABLE analyses ADD COLUMN track TEXT; -- JSON array of [north, east], oldest first
