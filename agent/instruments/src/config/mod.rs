//! `[roles]` and `[silence]` of the configuration.

mod roles;
mod seconds;
mod silence;

pub use roles::{RolesConfig, SourceConfig};
pub use seconds::PositiveSeconds;
pub use silence::{RoleSilence, SilenceConfig, SteeringRoleSilence};
