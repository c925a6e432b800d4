//! Registry of the kinds of messages and the webhooks that may subscribe to them.

use crate::http::unknown_name;
use crate::outbox::Kind;
use std::sync::Arc;

/// Webhooks that may subscribe to a kind of message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Audience {
    /// Webhooks of operators.
    Operators,
    /// Webhooks of operators and firms.
    OperatorsAndFirms,
    /// No webhook: such messages have their receivers by other means.
    Nobody,
}

/// Kind of message with its audience, declared by the capability that sends it.
#[derive(Clone, Copy, Debug)]
pub struct DeclaredKind {
    /// Kind of message.
    pub kind: Kind,
    /// Webhooks that may subscribe to it.
    pub audience: Audience,
    /// Occasion of such a message, in a sentence.
    pub occasion: &'static str,
}

/// Kinds of messages, in the order in which the API lists them: all of the server, or those of
/// one webhook.
#[derive(Clone, Debug)]
pub struct MessageKinds {
    kinds: Arc<[DeclaredKind]>,
    firms_subject: &'static str,
}

impl DeclaredKind {
    /// Declares a kind of message with its audience and occasion.
    pub const fn new(kind: Kind, audience: Audience, occasion: &'static str) -> DeclaredKind {
        DeclaredKind {
            kind,
            audience,
            occasion,
        }
    }
}

impl MessageKinds {
    /// Creates the registry of all kinds. `firms_subject` names what the kinds for firms are
    /// about, for the refusal of any other.
    pub fn new(
        kinds: impl IntoIterator<Item = DeclaredKind>,
        firms_subject: &'static str,
    ) -> MessageKinds {
        MessageKinds {
            kinds: kinds.into_iter().collect(),
            firms_subject,
        }
    }

    /// Returns all kinds, as declared.
    pub fn iter(&self) -> impl Iterator<Item = &DeclaredKind> {
        self.kinds.iter()
    }

    /// Returns the names of all kinds.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.kinds.iter().map(|declared| declared.kind.name())
    }

    /// Returns the kinds of the given names that webhooks may subscribe to, in order and without
    /// repetitions.
    ///
    /// # Errors
    /// Fails when a name is not that of a kind, with the reason.
    pub(super) fn find(&self, names: &[String]) -> Result<MessageKinds, String> {
        let is_unknown = |name: &String| !self.names().any(|known| known == name);
        if let Some(at) = names.iter().position(is_unknown) {
            return Err(format!(
                "kinds[{at}]: {}",
                unknown_name(&names[at], self.names())
            ));
        }
        let is_wanted = |declared: &&DeclaredKind| {
            declared.audience != Audience::Nobody
                && names.iter().any(|name| name == declared.kind.name())
        };
        let kinds = self.kinds.iter().filter(is_wanted).copied();
        Ok(MessageKinds::new(kinds, self.firms_subject))
    }

    /// Checks that a firm may subscribe to each of the kinds.
    ///
    /// # Errors
    /// Fails with the reason when one of them is not for firms.
    pub(super) fn check_for_firm(&self) -> Result<(), String> {
        let is_for_firms = |one: &DeclaredKind| one.audience == Audience::OperatorsAndFirms;
        if self.kinds.iter().all(is_for_firms) {
            return Ok(());
        }
        Err(format!(
            "a firm can only receive messages about {}",
            self.firms_subject
        ))
    }
}
