//! Letters to the platform's admins about the server itself, sent at once: the outbox may be on
//! the disk that is full.

use super::Mailer;
use crate::db::{self, Db, rows};
use crate::time::Time;
use anyhow::{Context, Result};

impl Mailer {
    /// Hands a letter over for each of the platform's admins. Returns their number.
    ///
    /// # Errors
    /// Fails when the relay does not accept one of them, after trying all.
    pub async fn write_to_platform_admins(
        &self,
        db: &Db,
        subject: &str,
        text: &str,
        now: Time,
    ) -> Result<usize> {
        let admins = platform_admins(db).await?;
        let mut problem = Ok(());
        for (address,) in &admins {
            let sent = self
                .sender()
                .write(address, subject, &[text], "", now)
                .await;
            problem = problem.and(sent.with_context(|| format!("no letter to {address}")));
        }
        problem.map(|()| admins.len())
    }
}

async fn platform_admins(db: &Db) -> db::Result<Vec<(String,)>> {
    rows!(
        db,
        (String,),
        "SELECT email FROM users WHERE role = 'platform_admin' AND disabled_at IS NULL
         ORDER BY email"
    )
}
