//! Rate limit of sign-ins: failed attempts delay further ones.
//!
//! Invariants:
//!
//! - An unknown e-mail address is throttled like any other, so that the response does not reveal
//!   which exist.
//! - A browser in which the user signed in before is throttled by itself. All others share the count
//!   of the e-mail address and that of their network, so that strangers who guess do not keep the
//!   user out.
//! - Failures also count for the network, so that one password cannot be tried on every user.
//! - A wait follows from the count and the time of the last failure. If that time is in the future,
//!   the clock was wrong, and the failures are forgotten.

use super::device::{self, Visitor};
use crate::audit::{Refusal, RequestContext};
use crate::client_address::Origin;
use crate::db::{self, Db, Tx, execute, rows};
use crate::error::{Error, Result};
use crate::ids::SessionId;
use crate::secret;
use crate::time::Time;
use binnacle_compass::time::Timestamp;

/// Failed attempts of a browser, a session, or for an e-mail address, that cause no delay.
const FREE_FOR_PERSON: i64 = 5;
/// Failed attempts from a network address that cause no delay: a whole office may share it.
const FREE_FOR_ADDRESS: i64 = 50;
/// Failed attempts from an IPv6 /48 that cause no delay: a site, or several customers of one
/// provider.
const FREE_FOR_SITE: i64 = 200;
/// Longest wait between two attempts, seconds.
const LONGEST_WAIT_S: i64 = 900;
/// Time without a failure after which all failures are forgotten, seconds.
const FORGET_AFTER_S: f64 = 86_400.0;
/// Difference of the clocks of two servers that is no mistake, seconds.
const CLOCKS_DIFFER_S: f64 = 60.0;

/// Subjects for which failures are counted.
pub struct Subjects {
    /// E-mail address tried, as it is stored; none if the attempt names none.
    account: Option<String>,
    /// The person's subject first, if there is one.
    all: Vec<Subject>,
}

struct Subject {
    hash: Vec<u8>,
    free: i64,
}

impl Subject {
    fn new(name: &str, free: i64) -> Subject {
        Subject {
            hash: secret::hash(name),
            free,
        }
    }
}

impl Subjects {
    /// Returns the subjects of an attempt that names an e-mail address.
    ///
    /// # Errors
    /// Fails when the database fails.
    pub async fn person(db: &Db, email: &str, visitor: &Visitor) -> Result<Subjects> {
        let account = Some(email.to_owned());
        if let Some(device) = device::find_known(db, email, visitor).await? {
            let all = vec![Subject::new(&device, FREE_FOR_PERSON)];
            return Ok(Subjects { account, all });
        }
        let mut all = vec![Subject::new(&format!("e-mail {email}"), FREE_FOR_PERSON)];
        all.extend(networks(&visitor.from));
        Ok(Subjects { account, all })
    }

    /// Returns the subjects of an attempt that names no e-mail address.
    pub fn address(from: &Origin) -> Subjects {
        Subjects {
            account: None,
            all: networks(from).collect(),
        }
    }

    /// Returns the subject of an attempt within a session of the user.
    pub fn session(id: SessionId, email: &str) -> Subjects {
        Subjects {
            account: Some(email.to_owned()),
            all: vec![Subject::new(&format!("session {id}"), FREE_FOR_PERSON)],
        }
    }

    /// Forgets the failures of the person; those of the network stay.
    pub(super) async fn forget(&self, tx: &mut Tx) -> db::Result<()> {
        if let (Some(_), Some(person)) = (&self.account, self.all.first()) {
            execute!(
                tx,
                "DELETE FROM login_failures WHERE subject_hash = $1",
                person.hash.as_slice()
            )?;
        }
        Ok(())
    }

    /// Returns the latest end of a wait of these subjects.
    async fn locked_until(&self, db: &Db, now: Timestamp) -> db::Result<Option<Timestamp>> {
        let hash = |at: usize| self.all.get(at).map(|subject| subject.hash.as_slice());
        let found = rows!(
            db,
            (Vec<u8>, i64, Time),
            "SELECT subject_hash, failures, last_at FROM login_failures
             WHERE subject_hash IN ($1, $2, $3) AND last_at <= $4
             ORDER BY subject_hash",
            hash(0),
            hash(1),
            hash(2),
            Time(now.plus_seconds(CLOCKS_DIFFER_S))
        )?;
        let ends = found.into_iter().filter_map(|(hash, failures, last_at)| {
            let subject = self.all.iter().find(|subject| subject.hash == hash)?;
            let wait_s = wait_s(failures - subject.free);
            Some(last_at.0.plus_seconds(wait_s as f64))
        });
        Ok(ends.max())
    }
}

/// Returns the networks of a client as subjects.
fn networks(from: &Origin) -> impl Iterator<Item = Subject> {
    let site = from.site().map(|site| Subject::new(&site, FREE_FOR_SITE));
    [Subject::new(&from.network(), FREE_FOR_ADDRESS)]
        .into_iter()
        .chain(site)
}

/// Refuses an attempt that follows failed ones too soon.
///
/// # Errors
/// [`Error::Throttled`] with the time to wait.
pub async fn check(request: &RequestContext, subjects: &Subjects, now: Timestamp) -> Result<()> {
    let until = subjects.locked_until(request.db(), now).await?;
    let Some(until) = until.filter(|until| *until > now) else {
        return Ok(());
    };
    request.refuse(Refusal::Throttled, subjects.account.as_deref());
    Err(Error::Throttled {
        retry_after_s: until.seconds_since(now).ceil() as u64,
    })
}

/// Counts a failed attempt.
pub async fn note_failure(
    request: &RequestContext,
    subjects: &Subjects,
    why: Refusal,
    now: Timestamp,
) -> Result<()> {
    request.refuse(why, subjects.account.as_deref());
    let mut tx = request.begin().await?;
    execute!(
        &mut tx,
        "DELETE FROM login_failures WHERE last_at < $1 OR last_at > $2",
        Time(now.plus_seconds(-FORGET_AFTER_S)),
        Time(now.plus_seconds(CLOCKS_DIFFER_S))
    )?;
    for subject in &subjects.all {
        execute!(
            &mut tx,
            "INSERT INTO login_failures (subject_hash, failures, last_at) VALUES ($1, 1, $2)
             ON CONFLICT (subject_hash) DO UPDATE
             SET failures = login_failures.failures + 1, last_at = excluded.last_at",
            subject.hash.as_slice(),
            Time(now)
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
