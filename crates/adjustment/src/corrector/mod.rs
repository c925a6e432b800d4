//! What correctors do at the card, as contributions to Poisson's equations.
//!
//! Ideal shapes by docs/science.md, §10, or what was measured of this binnacle
//! (`calibration`), which wins. What always holds: effects are in ship axes and
//! nT at the card's centre, the earth's field is that of no ship, and magnets add up
//! linearly once the soft iron stands: their poles magnetise spheres and bar.

mod effect;

mod flinders;
mod magnet;
mod sphere;

mod iron;
mod setting_effect;

pub use effect::{Effect, Vector};
pub use flinders::{Bar, demagnetising};
pub use iron::Iron;
pub use magnet::{BarMagnet, MAGNETIC};
pub use setting_effect::{effect, heeling_effect, heeling_field, magnet_field, tray_effect};
pub use sphere::{KAPPA, Pair};

#[cfg(test)]
mod tests;
