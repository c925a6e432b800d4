-- No late days were the default, and stand in settings that nobody chose them for: a job that
-- can only be late is planned late unless somebody says how late it may be.
UPDATE schedule_settings SET settings = REPLACE(settings, '"late_days":0,', '"late_days":null,');
