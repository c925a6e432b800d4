//! Failures of a database that are nobody's mistake and pass: it is away or busy, or its disk
//! is full.

mod disk;

pub use disk::Disk;

/// Result code of SQLite when the disk is full (sqlite.org, Result Codes).
const SQLITE_FULL: &str = "13";
/// Result codes of SQLite for a lock that another process has held too long.
const SQLITE_BUSY: [&str; 3] = ["5", "261", "517"];
/// Error code `disk_full` of PostgreSQL (its documentation, appendix A).
const DISK_FULL: &str = "53100";
/// Error codes `admin_shutdown`, `crash_shutdown`, `cannot_connect_now` and
/// `too_many_connections` of PostgreSQL.
const AWAY: [&str; 4] = ["57P01", "57P02", "57P03", "53300"];
/// Class of PostgreSQL's connection exceptions.
const CONNECTION_EXCEPTION: &str = "08";

/// Reason for which a database cannot work now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outage {
    /// It does not respond, or it has more to do than it can.
    Unavailable,
    /// It has no space left on its disk.
    DiskFull,
}

impl Outage {
    /// Returns the outage that an error is about, if any.
    pub fn of(error: &sqlx::Error) -> Option<Outage> {
        let error = match error {
            sqlx::Error::PoolTimedOut
            | sqlx::Error::PoolClosed
            | sqlx::Error::WorkerCrashed
            | sqlx::Error::Io(_) => return Some(Outage::Unavailable),
            sqlx::Error::Database(error) => error,
            _ => return None,
        };
        let code = error.code()?;
        match &*code {
            SQLITE_FULL | DISK_FULL => Some(Outage::DiskFull),
            code if SQLITE_BUSY.contains(&code)
                || AWAY.contains(&code)
                || (code.len() == 5 && code.starts_with(CONNECTION_EXCEPTION)) =>
            {
                Some(Outage::Unavailable)
            }
            _ => None,
        }
    }
}
