//! Defences: against guesses, against whoever has a copy of the database, and against too much.

mod quotas;
mod refusals;
mod sealing;
mod sqlite_file;
mod throttle;
