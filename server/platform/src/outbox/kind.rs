//! Kinds of messages: names that the capabilities of the server declare.

use serde::Serialize;
use utoipa::ToSchema;

/// Subject of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(transparent)]
#[schema(as = MessageKind)]
pub struct Kind(&'static str);

impl Kind {
    /// A user requested a test.
    pub const TEST: Kind = Kind::new("test");

    /// Returns the kind with a name, which the API shows and the database stores.
    pub const fn new(name: &'static str) -> Kind {
        Kind(name)
    }

    /// Returns the name of the kind.
    pub fn name(self) -> &'static str {
        self.0
    }
}
