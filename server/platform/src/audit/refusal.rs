//! Refused sign-ins, codes and tokens: why, and for which account.
//!
//! Invariants: each one is in the server's own log. Each failed attempt has an audit line, and of
//! those only turned away a network has one a minute for each reason, whatever it sends, so that
//! nobody can fill the audit log. What was typed is kept only if it has the form of an e-mail
//! address: it may be a password.

use crate::db::{self, Tx, row};
use crate::ids::{FirmId, OperatorId};
use crate::request_rates::RequestRates;
use crate::secret;
use crate::tenants::Tenant;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Longest account to keep, bytes.
const MAX_ACCOUNT: usize = 200;

/// Reason for which a sign-in, a code or a token was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = SignInRefusal)]
pub enum Refusal {
    /// Wrong password, or no such account.
    WrongPassword,
    /// Wrong code of a second factor.
    WrongCode,
    /// Too many failed attempts before this one.
    Throttled,
    /// Person whom the sign-in provider did not identify.
    Provider,
    /// API token or agent's token that is unknown, expired or revoked.
    InvalidToken,
    /// One-time code or calendar address that is unknown or expired.
    InvalidCode,
}

/// Refusal of a request, and the account that was tried.
#[derive(Clone, Debug)]
pub(super) struct Refused {
    pub(super) why: Refusal,
    pub(super) account: Option<String>,
}

impl Refusal {
    /// Returns the name as it is stored and logged.
    pub(super) fn name(self) -> &'static str {
        match self {
            Refusal::WrongPassword => "wrong_password",
            Refusal::WrongCode => "wrong_code",
            Refusal::Throttled => "throttled",
            Refusal::Provider => "provider",
            Refusal::InvalidToken => "invalid_token",
            Refusal::InvalidCode => "invalid_code",
        }
    }

    /// Returns true if something was compared with a guess. These are slowed down, and no others.
    fn is_guess(self) -> bool {
        matches!(
            self,
            Refusal::WrongPassword | Refusal::WrongCode | Refusal::Provider
        )
    }
}

impl Refused {
    /// Keeps the account if it looks like an e-mail address.
    pub(super) fn new(why: Refusal, account: Option<&str>) -> Refused {
        let is_address = |text: &&str| {
            let harmless = !text.chars().any(|c| c.is_control() || c.is_whitespace());
            harmless && text.contains('@') && text.len() <= MAX_ACCOUNT
        };
        Refused {
            why,
            account: account.filter(is_address).map(str::to_owned),
        }
    }

    /// Returns true if the refusal has an audit line: every guess, and one a minute of what is
    /// turned away.
    pub(super) fn is_listed(&self, rates: &RequestRates, network: &str, now_s: u64) -> bool {
        if self.why.is_guess() {
            return true;
        }
        let caller = format!("{} {network}", self.why.name());
        !rates.count(secret::hash(&caller), now_s, 1).is_exceeded
    }

    /// Returns the tenant of the account, if there is such an account.
    pub(super) async fn tenant(&self, tx: &mut Tx) -> db::Result<Option<Tenant>> {
        let Some(account) = &self.account else {
            return Ok(None);
        };
        let found = row!(
            in tx,
            (Option<OperatorId>, Option<FirmId>),
            "SELECT operator_id, firm_id FROM users WHERE email = $1 ORDER BY id",
            account.as_str()
        )?;
        Ok(found.and_then(|(operator, firm)| {
            let operator = operator.map(Tenant::Operator);
            operator.or(firm.map(Tenant::Firm))
        }))
    }
}
