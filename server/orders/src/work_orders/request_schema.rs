//! How the OpenAPI document describes what a reading and its limits are; they themselves
//! are the science crate's.

use binnacle_platform::time::Time;
use serde::Serialize;
use utoipa::ToSchema;

/// What was read at the berth; docs/plan.md has every field.
#[derive(ToSchema)]
#[schema(as = BerthReading, example = json!({
    "at": "2026-11-22T08:20:00Z", "lat": 43.35, "lon": -3.04,
    "heading_true_deg": 312.0, "heading_from": "model_reference",
    "forward": 17.2, "starboard": 14.9, "unit": "microtesla",
    "magnetometer": "fluxgate", "compass_deg": 310.5
}))]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::adjust::ReadingForm"
)]
pub(crate) struct BerthReadingSchema {
    /// When it was read.
    at: Time,
    /// The berth, degrees north.
    #[schema(minimum = -90, maximum = 90)]
    lat: f64,
    /// The berth, degrees east.
    #[schema(minimum = -180, maximum = 180)]
    lon: f64,
    /// The ship's true heading at the berth.
    #[schema(minimum = 0, maximum = 360)]
    heading_true_deg: f64,
    /// What that heading is from: `model_reference`, the gyro or satellite compass that the
    /// model was fitted with, or `ashore`.
    heading_from: HeadingFrom,
    /// Its standard deviation, degrees; 0.5 where it is not said.
    #[schema(minimum = 0, maximum = 5)]
    heading_sd_deg: Option<f64>,
    /// Horizontal field at the card's centre, bowl out, forward positive.
    forward: f64,
    /// The same, starboard positive.
    starboard: f64,
    /// Vertical field there, down positive; without it the heeling magnets stay.
    down: Option<f64>,
    /// What all three are in.
    unit: FieldUnit,
    /// What they were read with.
    magnetometer: Magnetometer,
    /// Its maker, type and number.
    #[schema(max_length = 200)]
    magnetometer_serial: Option<String>,
    /// Its standard deviation, nT; its kind's where it is not said.
    #[schema(minimum = 1, maximum = 5000)]
    field_sd_nt: Option<f64>,
    /// Relative standard deviation of its scale; its kind's where it is not said.
    #[schema(minimum = 0, maximum = 0.5)]
    scale_sd: Option<f64>,
    /// Standard deviation of how it lies, degrees; its kind's where it is not said.
    #[schema(minimum = 0, maximum = 5)]
    alignment_sd_deg: Option<f64>,
    /// Standard deviation of its tilt, degrees; its kind's where it is not said.
    #[schema(minimum = 0, maximum = 4)]
    tilt_sd_deg: Option<f64>,
    /// Standard deviation of what steel may add to each part, nT.
    #[schema(minimum = 0, maximum = 5000)]
    steel_sd_nt: Option<f64>,
    /// What the compass read before the bowl was taken out, degrees.
    #[schema(minimum = 0, maximum = 360)]
    compass_deg: Option<f64>,
    /// The ship's heel, degrees to starboard.
    #[schema(required = false, minimum = -5, maximum = 5)]
    heel_deg: f64,
    /// Whether there is steel near: a crane, a ship alongside, a quay of steel piles.
    #[schema(required = false)]
    steel_nearby: bool,
    /// Whether magnetic cargo is on board.
    #[schema(required = false)]
    cargo_on_board: bool,
}

/// A unit of the magnetic field.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[allow(dead_code, reason = "describes binnacle_adjustment::adjust::Unit")]
pub(crate) enum FieldUnit {
    Nanotesla,
    Microtesla,
    Gauss,
    Milligauss,
}

/// What a heading at the berth is from.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::adjust::HeadingFrom"
)]
enum HeadingFrom {
    /// The gyro or satellite compass that the model was fitted with.
    ModelReference,
    /// A surveyed quay, leading marks, the sun.
    Ashore,
}

/// Kinds of magnetometer, by how well they read.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[allow(
    dead_code,
    reason = "describes binnacle_adjustment::adjust::Magnetometer"
)]
enum Magnetometer {
    /// 0.1 µT.
    Fluxgate,
    /// 0.3 µT.
    Magnetoresistive,
    /// 1.5 µT: enough for magnets, too poor for spheres.
    Phone,
    /// 0.5 µT.
    Other,
}

/// What a plan must keep to; what is left out is the usual.
#[derive(ToSchema)]
#[schema(as = PlanLimits, example = json!({ "residual_deg": 3.0, "band_deg": 1.5 }))]
#[allow(dead_code, reason = "describes binnacle_adjustment::adjust::Limits")]
pub(crate) struct LimitsSchema {
    /// The greatest residual that may be foretold, band included, degrees; usually 3.
    #[schema(required = false, minimum = 0.5, maximum = 5)]
    residual_deg: f64,
    /// The widest 95 % band, degrees; usually 2.5.
    #[schema(required = false, minimum = 0.2, maximum = 4)]
    band_deg: f64,
    /// Settings within this are as good as each other, degrees; usually 0.1.
    #[schema(required = false, minimum = 0, maximum = 1)]
    near_equal_deg: f64,
    /// The oldest model, days; usually 60.
    #[schema(required = false, minimum = 1, maximum = 90)]
    model_age_days: f64,
    /// With a λ less sure than this share soft iron stays; usually 0.03.
    #[schema(required = false, minimum = 0.005, maximum = 0.1)]
    lambda_sd: f64,
}
