//! Registry of the kinds of messages and the webhooks that may subscribe to them.

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
}

/// All kinds of messages of the server, in the order in which the API lists them.
#[derive(Clone, Debug)]
pub struct MessageKinds(Arc<[DeclaredKind]>);

impl DeclaredKind {
    /// Declares a kind of message with its audience.
    pub const fn new(kind: Kind, audience: Audience) -> DeclaredKind {
        DeclaredKind { kind, audience }
    }
}

impl FromIterator<DeclaredKind> for MessageKinds {
    fn from_iter<I: IntoIterator<Item = DeclaredKind>>(declared: I) -> MessageKinds {
        MessageKinds(declared.into_iter().collect())
    }
}

impl MessageKinds {
    /// Returns the names of all kinds.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.0.iter().map(|declared| declared.kind.name())
    }

    /// Returns the kinds of the given names that webhooks may subscribe to, in order and without
    /// repetitions.
    ///
    /// # Errors
    /// Fails when a name is not that of a kind, with the reason.
    pub(super) fn find(&self, names: &[String]) -> Result<Vec<DeclaredKind>, String> {
        let is_unknown = |name: &String| !self.names().any(|known| known == name);
        if let Some(at) = names.iter().position(is_unknown) {
            let known: Vec<String> = self.names().map(|known| format!("`{known}`")).collect();
            return Err(format!(
                "kinds[{at}]: unknown variant `{}`, expected one of {}",
                names[at],
                known.join(", ")
            ));
        }
        let is_wanted = |declared: &&DeclaredKind| {
            declared.audience != Audience::Nobody
                && names.iter().any(|name| name == declared.kind.name())
        };
        Ok(self.0.iter().filter(is_wanted).copied().collect())
    }
}
