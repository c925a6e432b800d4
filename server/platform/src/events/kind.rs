//! Kinds of live events: names that the capabilities of the server declare.

use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use utoipa::ToSchema;

/// Kind of change to a vessel.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(transparent)]
#[schema(as = EventKind, value_type = String)]
pub struct Kind(Cow<'static, str>);

impl Kind {
    /// Returns the kind with a name, which the API shows and the database stores.
    pub const fn new(name: &'static str) -> Kind {
        Kind(Cow::Borrowed(name))
    }

    /// Returns the name of the kind.
    pub fn name(&self) -> &str {
        &self.0
    }
}

impl From<String> for Kind {
    /// Returns the kind that a database or another process names.
    fn from(name: String) -> Kind {
        Kind(Cow::Owned(name))
    }
}
