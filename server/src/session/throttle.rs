//! Slows down those who guess passwords.
//!
//! What always holds: an e-mail that nobody has is throttled like any other, so
//! that the answer does not tell which exist.

use crate::db::{Db, execute, row};
use crate::error::{Error, Result};
use crate::secret;
use crate::time::Time;
use binnacle_magnetics::time::Timestamp;

/// Wrong passwords that cost nothing.
const FREE_FAILURES: i64 = 5;
/// The longest wait between two attempts.
const LONGEST_WAIT_S: i64 = 900;
/// After so long without a failure all is forgotten.
const FORGET_AFTER_S: f64 = 86_400.0;

/// Refuses an attempt that comes too soon after failed ones.
pub(super) async fn check(db: &Db, email: &str, now: Timestamp) -> Result<()> {
    let locked = row!(
        db,
        (Time,),
        "SELECT locked_until FROM login_failures WHERE email_hash = $1 ORDER BY email_hash",
        secret::hash(email)
    )?;
    let Some((Time(until),)) = locked.filter(|(until,)| until.0 > now) else {
        return Ok(());
    };
    Err(Error::Throttled {
        retry_after_s: until.seconds_since(now).ceil() as u64,
    })
}

/// Counts a wrong password.
pub(super) async fn note_failure(db: &Db, email: &str, now: Timestamp) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "DELETE FROM login_failures WHERE last_at < $1",
        Time(now.plus_seconds(-FORGET_AFTER_S))
    )?;
    let counted = row!(
        in &mut tx,
        (i64,),
        "INSERT INTO login_failures (email_hash, failures, last_at, locked_until)
         VALUES ($1, 1, $2, $2)
         ON CONFLICT (email_hash) DO UPDATE
         SET failures = login_failures.failures + 1, last_at = excluded.last_at
         RETURNING failures",
        secret::hash(email),
        Time(now)
    )?;
    let failures = counted.map_or(0, |(failures,)| failures);
    execute!(
        &mut tx,
        "UPDATE login_failures SET locked_until = $2 WHERE email_hash = $1",
        secret::hash(email),
        Time(now.plus_seconds(wait_s(failures) as f64))
    )?;
    tx.commit().await?;
    Ok(())
}

/// Nothing at first, then twice as long each time.
fn wait_s(failures: i64) -> i64 {
    match failures - FREE_FAILURES {
        ..0 => 0,
        more => 2_i64
            .saturating_pow(more.min(20) as u32)
            .min(LONGEST_WAIT_S),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wait_doubles_after_five_failures_up_to_a_quarter_of_an_hour() {
        let waits: Vec<i64> = [1, 4, 5, 6, 7, 14, 15, 1000].map(wait_s).to_vec();
        assert_eq!(waits, [0, 0, 1, 2, 4, 512, 900, 900]);
    }
}
