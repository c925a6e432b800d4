//! Rate limit of sign-ins: failed attempts delay further ones.
//!
//! Invariants: an unknown e-mail address is throttled like any other, so that the response does
//! not reveal which exist. Failures count for the e-mail address. They also count for the
//! network address, so that one password cannot be tried on every user.

use crate::audit::RequestContext;
use crate::client_address::Origin;
use crate::db::{Db, execute, row};
use crate::error::{Error, Result};
use crate::secret;
use crate::time::Time;
use binnacle_compass::time::Timestamp;

/// Failed attempts for an e-mail address that cause no delay.
const FREE_FOR_EMAIL: i64 = 5;
/// Failed attempts from a network address that cause no delay: a whole office may share it.
const FREE_FOR_ADDRESS: i64 = 50;
/// Longest wait between two attempts, seconds.
const LONGEST_WAIT_S: i64 = 900;
/// Time without a failure after which all failures are forgotten, seconds.
const FORGET_AFTER_S: f64 = 86_400.0;

/// Subjects for which failures are counted.
pub struct Subjects<'a> {
    /// E-mail address tried, as it is stored; none if the attempt names none.
    email: Option<&'a str>,
    /// Origin of the attempt.
    from: &'a Origin,
}

impl<'a> Subjects<'a> {
    /// Returns the subjects of an attempt that names an e-mail address.
    pub fn person(email: &'a str, from: &'a Origin) -> Subjects<'a> {
        let email = Some(email);
        Subjects { email, from }
    }

    /// Returns the subjects of an attempt that names no e-mail address.
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

/// Refuses an attempt that follows failed ones too soon.
///
/// # Errors
/// [`Error::Throttled`] with the time to wait.
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

/// Returns the wait after failures beyond the free ones: it doubles each time.
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
