//! Effects of correctors at the card, as contributions to Poisson's equations.
//!
//! Ideal shapes by docs/science.md, §10, or measured effects of this binnacle
//! (`calibration`), which take precedence. Invariants: effects are in ship axes and nT at
//! the card's centre, and the earth's field contains no ship. Magnets add up linearly once
//! the soft iron is set: their poles magnetise spheres and bar.

mod effect;

mod flinders;
mod magnet;
mod sphere;

mod iron;
mod needles;
mod setting_effect;

pub use effect::{Effect, Vector};
pub use flinders::{Bar, demagnetising};
pub use iron::Iron;
pub use magnet::{BarMagnet, MAGNETIC};
pub use needles::needles_of_model;
pub(crate) use needles::{NEEDLE_SD, needle_induction};
pub use setting_effect::{effect, heeling_effect, heeling_field, magnet_field, tray_effect};
pub use sphere::{KAPPA, Pair};

#[cfg(test)]
mod tests;
