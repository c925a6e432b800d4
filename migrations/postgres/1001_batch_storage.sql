-- Batches are compressed already: PostgreSQL need not try.
ALTER TABLE batches ALTER COLUMN bytes SET STORAGE EXTERNAL;
