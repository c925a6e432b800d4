//! Slows down those who guess passwords and codes.
//!
//! Invariants: an e-mail that nobody has is throttled like any other, so
//! that the answer does not tell which exist. Failures count for the e-mail, and, so
//! that one password is not tried on every e-mail, for the address they come from.

use crate::audit::RequestContext;
use crate::client_address::Origin;
use crate::db::{Db, execute, row};
use crate::error::{Error, Result};
use crate::secret;
use crate::time::Time;
use binnacle_compass::time::Timestamp;

/// Wrong passwords that cost an e-mail nothing.
const FREE_FOR_EMAIL: i64 = 5;
/// And an address: a whole office may be behind it.
const FREE_FOR_ADDRESS: i64 = 50;
/// The longest wait between two attempts.
const LONGEST_WAIT_S: i64 = 900;
/// After so long without a failure all is forgotten.
const FORGET_AFTER_S: f64 = 86_400.0;

/// The subjects whose failures are counted.
pub struct Subjects<'a> {
    /// The e-mail that is tried, as it is stored; none where nobody says it.
    email: Option<&'a str>,
    /// From where.
    from: &'a Origin,
}

impl<'a> Subjects<'a> {
    /// An e-mail, and where the attempt comes from.
    pub fn person(email: &'a str, from: &'a Origin) -> Subjects<'a> {
        let email = Some(email);
        Subjects { email, from }
    }

    /// Only where the attempt comes from.
    pub fn address(from: &'a Origin) -> Subjects<'a> {
        Subjects { email: None, from }
    }

    fn hashes(&self) -> Vec<(Vec<u8>, i64)> {
        let email = self.email.map(|email| (email.to_owned(), FREE_FOR_EMAIL));
        let all = email
            .into_iter()
            .chain([(self.from.network(), FREE_FOR_ADDRESS)]);
        all.map(|(subject, free)| (secret::hash(&subject), free))
            .collect()
    }
}

/// Refuses an attempt that comes too soon after failed ones.
///
/// # Errors
/// Saying how long to wait.
pub async fn check(db: &Db, subjects: &Subjects<'_>, now: Timestamp) -> Result<()> {
    let hashes = subjects.hashes();
    let (first, last) = (hashes.first(), hashes.last());
    let hash = |subject: Option<&(Vec<u8>, i64)>| subject.map(|(hash, _)| hash.clone());
    let locked = row!(
        db,
        (Time,),
        "SELECT locked_until FROM login_failures
         WHERE subject_hash = $1 OR subject_hash = $2
         ORDER BY locked_until DESC
         LIMIT 1",
        hash(first),
        hash(last)
    )?;
    let Some((Time(until),)) = locked.filter(|(until,)| until.0 > now) else {
        return Ok(());
    };
    Err(Error::Throttled {
        retry_after_s: until.seconds_since(now).ceil() as u64,
    })
}

/// Counts a wrong password or code.
pub async fn note_failure(
    request: &RequestContext,
    subjects: &Subjects<'_>,
    now: Timestamp,
) -> Result<()> {
    let mut tx = request.begin().await?;
    execute!(
        &mut tx,
        "DELETE FROM login_failures WHERE last_at < $1",
        Time(now.plus_seconds(-FORGET_AFTER_S))
    )?;
    for (subject, free) in subjects.hashes() {
        let counted = row!(
            in &mut tx,
            (i64,),
            "INSERT INTO login_failures (subject_hash, failures, last_at, locked_until)
             VALUES ($1, 1, $2, $2)
             ON CONFLICT (subject_hash) DO UPDATE
             SET failures = login_failures.failures + 1, last_at = excluded.last_at
             RETURNING failures",
            subject.as_slice(),
            Time(now)
        )?;
        let failures = counted.map_or(0, |(failures,)| failures);
        execute!(
            &mut tx,
            "UPDATE login_failures SET locked_until = $2 WHERE subject_hash = $1",
            subject.as_slice(),
            Time(now.plus_seconds(wait_s(failures - free) as f64))
        )?;
    }
    tx.commit().await?;
    Ok(())
}

/// Nothing at first, then twice as long each time.
fn wait_s(beyond_free: i64) -> i64 {
    match beyond_free {
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
    fn the_wait_doubles_after_the_free_failures_up_to_a_quarter_of_an_hour() {
        let waits: Vec<i64> = [-4, -1, 0, 1, 2, 9, 10, 995].map(wait_s).to_vec();
        assert_eq!(waits, [0, 0, 1, 2, 4, 512, 900, 900]);
    }
}
