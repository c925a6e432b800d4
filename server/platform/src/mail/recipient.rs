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

/// Someone who is to get mail.
#[derive(Clone, Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewMailRecipient)]
pub(super) struct NewRecipient {
    /// E-mail address of the recipient.
    #[schema(max_length = 254, example = "superintendent@example.com")]
    pub(super) address: String,
    /// Of alerts as bad as this or worse; `warning` if not said.
    #[serde(default = "warning")]
    pub(super) severity: Severity,
}

fn warning() -> Severity {
    Severity::Warning
}

/// A new minimum severity for a recipient.
#[derive(Clone, Copy, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = ChangedMailRecipient)]
pub(super) struct ChangedRecipient {
    /// Of alerts as bad as this or worse.
    pub(super) severity: Severity,
}

/// Someone who gets mail.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = MailRecipient)]
pub(super) struct Recipient {
    /// The recipient's id.
    pub(super) id: RecipientId,
    /// E-mail address of the recipient.
    #[schema(example = "superintendent@example.com")]
    pub(super) address: String,
    /// Of alerts as bad as this or worse.
    pub(super) severity: Severity,
    /// Time at which the recipient was added.
    pub(super) created_at: Time,
    /// Letters that wait.
    pub(super) pending: i64,
    /// Letters that were given up.
    pub(super) dead: i64,
}

/// A page of those who get mail.
#[derive(Serialize, ToSchema)]
#[schema(as = MailRecipientList)]
pub(super) struct RecipientList {
    /// In the order in which they were added.
    pub(super) items: Vec<Recipient>,
    /// `after` of the next page.
    #[schema(required)]
    pub(super) next: Option<String>,
    /// True if mail is set up on this server.
    pub(super) sending: bool,
}

impl NewRecipient {
    /// Returns the recipient if mail can be sent to the address.
    ///
    /// # Errors
    /// When it cannot.
    pub(super) fn checked(self) -> Result<NewRecipient> {
        Ok(NewRecipient {
            address: address("address", &self.address)?,
            ..self
        })
    }
}

/// An address that mail can go to, its domain in small letters.
///
/// # Errors
/// When mail cannot go there.
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
    // Beyond ASCII an address asks every relay on its way for SMTPUTF8.
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
    fn only_what_is_one_address_is_one() {
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
