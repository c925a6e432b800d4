//! Sign-in through an OpenID Connect provider, if one is configured.
//!
//! Invariants:
//!
//! - No user is created here: only an existing user can sign in. The first time, the user is
//!   found by an e-mail address that the provider has verified. From then on, the provider's
//!   permanent subject identifies the user. An address that is reassigned admits nobody else.
//! - A sign-in is completed in the browser that began it, within ten minutes, and once only.
//! - A user with a second factor has to enter its code here.
//! - The provider is contacted only when someone signs in through it. While it cannot be
//!   reached, everything else works.

mod attempt;
mod claims;
mod refusal;
mod sign_in;
mod store;

pub use sign_in::router;
pub use store::forget;
