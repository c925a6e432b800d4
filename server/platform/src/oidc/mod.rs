//! Signing in by the word of an OpenID Connect provider, for those who set one up.
//!
//! Invariants:
//!
//! - Nobody is made a user here: a person of the provider's is let in who was one before,
//!   found the first time by an e-mail that the provider has verified, and from then on by
//!   the name that the provider gives them for good. An e-mail that goes over to someone
//!   else lets nobody else in.
//! - A sign-in ends in the browser that began it, within ten minutes, once.
//! - Whoever has a second factor here is asked for it here.
//! - The provider is asked for nothing before someone wants to sign in by it; while it
//!   cannot be reached, everything else goes on.

mod attempt;
mod claims;
mod refusal;
mod sign_in;
mod store;

pub use sign_in::router;
pub use store::forget;
