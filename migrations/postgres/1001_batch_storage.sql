-- Batches are compressed already: keep the database from trying again.
ALTER TABLE batches ALTER COLUMN bytes SET STORAGE EXTERNAL;
