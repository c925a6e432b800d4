-- What is kept of a segment is compressed already: PostgreSQL need not try.
ALTER TABLE segments ALTER COLUMN diagnoses SET STORAGE EXTERNAL;
ALTER TABLE segments ALTER COLUMN state SET STORAGE EXTERNAL;
