//! API tokens: credentials of programs that act for a user.
//!
//! Invariants: a token is shown once and stored as a hash. It may do no more than its user, and
//! may only read unless its scope is `write`.

mod made;
mod store;

pub(crate) use made::list_made;
pub use made::{Made, MadeByTokens, MadeKind, RevokedWithMade, named};
pub(crate) use store::{delete, delete_with_made, find_holder, insert, list};
pub use store::{delete_all, is_valid};

use crate::ids::TokenId;
use crate::quotas::Quota;
use crate::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Prefix of an API token; an agent's token has none.
pub const PREFIX: &str = "bna_";

/// Quota of the API tokens of a company's people.
pub const QUOTA: Quota = Quota::new("api_tokens", "API tokens", 200, store::count);

/// Scope of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = TokenScope)]
pub enum Scope {
    /// Read access to all that its user may see.
    Read,
    /// Permission for all that its user may do.
    Write,
}

/// Token, without its secret.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
pub struct Token {
    /// The token's id.
    pub id: TokenId,
    /// Purpose of the token, in the user's words.
    pub name: String,
    /// Scope of the token.
    pub scope: Scope,
    /// Expiry time.
    pub expires_at: Time,
    /// Creation time.
    pub created_at: Time,
    /// Time of the last use, to the hour.
    #[schema(required)]
    pub last_used_at: Option<Time>,
    /// Things made with the token that go on without it.
    #[sqlx(skip)]
    pub made: Vec<Made>,
}
