//! Mail recipients, as requested and as shown.

use crate::error::{Error, Result};
use crate::ids::RecipientId;
use crate::severity::Severity;
use crate::time::Time;
use lettre::Address;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Longest address (RFC 5321, section 4.5.3.1.3, without the brackets).
const MAX_ADDRESS: usize = 254;

/// Mail recipient to be added.
#[derive(Clone, Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewMailRecipient)]
pub(super) struct NewRecipient {
    /// E-mail address of the recipient.
    #[schema(max_length = 254, example = "superintendent@example.com")]
    pub(super) address: String,
    /// Minimum severity of the alerts sent; `warning` by default.
    #[serde(default = "warning")]
    pub(super) severity: Severity,
}

fn warning() -> Severity {
    Severity::Warning
}

/// New minimum severity of a recipient.
#[derive(Clone, Copy, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = ChangedMailRecipient)]
pub(super) struct ChangedRecipient {
    /// Minimum severity of the alerts sent.
    pub(super) severity: Severity,
}

/// Mail recipient.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = MailRecipient)]
pub(super) struct Recipient {
    /// The recipient's id.
    pub(super) id: RecipientId,
    /// E-mail address of the recipient.
    #[schema(example = "superintendent@example.com")]
    pub(super) address: String,
    /// Minimum severity of the alerts sent.
    pub(super) severity: Severity,
    /// Time at which the recipient was added.
    pub(super) created_at: Time,
    /// Number of pending letters.
    pub(super) pending: i64,
    /// Number of letters that were given up.
    pub(super) dead: i64,
}

/// Page of mail recipients.
#[derive(Serialize, ToSchema)]
#[schema(as = MailRecipientList)]
pub(super) struct RecipientList {
    /// Recipients in the order in which they were added.
    pub(super) items: Vec<Recipient>,
    /// Value of `after` for the next page.
    #[schema(required)]
    pub(super) next: Option<String>,
    /// True if mail is set up on this server.
    pub(super) sending: bool,
}

impl NewRecipient {
    /// Returns the recipient if mail can be sent to the address.
    ///
    /// # Errors
    /// Fails when mail cannot be sent there.
    pub(super) fn checked(self) -> Result<NewRecipient> {
        Ok(NewRecipient {
            address: address("address", &self.address)?,
            ..self
        })
    }
}

/// Returns an address with its domain in lower case.
///
/// # Errors
/// Fails when mail cannot be sent there.
pub fn address(field: &'static str, given: &str) -> Result<String> {
    let invalid = |detail: &str| {
        Err(Error::Invalid {
            field,
            detail: detail.to_owned(),
        })
    };
    if given.len() > MAX_ADDRESS {
        return invalid("is longer than 254 characters");
    }
    // A non-ASCII address requires SMTPUTF8 of every relay on the way.
    if !given.is_ascii() {
        return invalid("has non-ASCII characters");
    }
    let Ok(address) = given.trim().parse::<Address>() else {
        return invalid("is not an address like name@example.com");
    };
    let domain = address.domain().to_ascii_lowercase();
    Ok(format!("{}@{domain}", address.user()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(address: &str) -> Option<String> {
        let new = NewRecipient {
            address: address.to_owned(),
            severity: Severity::Warning,
        };
        new.checked().ok().map(|new| new.address)
    }

    #[test]
    fn only_a_single_address_is_accepted() {
        assert_eq!(
            checked(" Ada.L@Example.COM ").as_deref(),
            Some("Ada.L@example.com")
        );
        for bad in [
            "",
            "ada",
            "ada@",
            "@example.com",
            "ada@example.com, eve@example.com",
            "Ada <ada@example.com>",
            "ada@example.com\r\nBcc: eve@example.com",
            "ada\n@example.com",
            "ada@ex ample.com",
            "ádá@example.com",
            &format!("{}@example.com", "a".repeat(300)),
        ] {
            assert_eq!(checked(bad), None, "{bad:?}");
        }
    }
}
