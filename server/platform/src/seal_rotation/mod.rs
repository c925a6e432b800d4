//! Change of the key: secrets that another key has sealed, or none, are sealed by the present one.

use crate::db::{Db, Result, Tx, rows};
use crate::sealing::SealError;
use crate::{second_factor, signing_keys, webhooks};
use tracing::warn;

/// Checks that each secret in the database can be opened, as far as the ids of the keys show, and
/// warns of secrets in plain.
///
/// # Errors
/// Fails when a secret is sealed by a key that is not known.
pub async fn check(db: &Db) -> Result<()> {
    let found = rows!(
        db,
        (Option<String>, i64),
        "SELECT sealed_by, COUNT(*) FROM
             (SELECT sealed_by FROM second_factors
              UNION ALL SELECT sealed_by FROM webhooks
              UNION ALL SELECT sealed_by FROM signing_keys) AS secrets
         GROUP BY sealed_by
         ORDER BY sealed_by"
    )?;
    for (sealed_by, secrets) in found {
        match sealed_by {
            Some(key) if !db.seals().has(&key) => return Err(SealError::UnknownKey(key).into()),
            Some(_) => {}
            None => warn!(
                secrets,
                "secrets are stored in plain: set BINNACLE_SECRETS_KEY and run `admin seal-secrets`"
            ),
        }
    }
    Ok(())
}

/// Seals all secrets by the present key, and returns the number of those that were not.
///
/// # Errors
/// Fails when one of them cannot be opened. Then none is changed, if the transaction is dropped.
pub async fn seal_all(tx: &mut Tx) -> Result<u64> {
    Ok(second_factor::reseal(tx).await?
        + webhooks::reseal(tx).await?
        + signing_keys::reseal(tx).await?)
}
