//! Course over ground in place of a heading, on a ship without gyro and satellite compass.

mod course_use;
mod drift_angle;

pub(super) use course_use::CourseUse;
pub(super) use drift_angle::constant_sd_deg;
