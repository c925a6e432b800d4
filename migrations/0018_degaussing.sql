-- How a vessel's degaussing coils are, in words, as a deviation card has to say.
ALTER TABLE vessels ADD COLUMN degaussing TEXT;
