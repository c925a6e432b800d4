//! Observations as rows of a linear problem: once what does not depend on the
//! parameters, then the residual and its slopes at the current ones.

use super::needle::Needle;
use super::noise::{STATES, Transition};
use super::prior::scales;
use crate::angle::wrap_180;
use crate::deviation::Coefficients;
use crate::fit::{Observation, gyro_speed_error_deg};
use crate::model::Parameters;
use crate::position::Position;
use crate::ship::{EarthField, PARAMETERS};
use std::f64::consts::TAU;

/// Unknowns that do not change: seven parameters, the constant, the gyro's
/// leftover speed error, and two of the daily variation.
pub(crate) const UNKNOWNS: usize = PARAMETERS + 1 + 3;
/// Where the constant stands.
pub(crate) const CONSTANT: usize = PARAMETERS;

/// Standard deviation of what is left of a gyro's speed error, as a part of it.
const SPEED_ERROR_SD: f64 = 0.15;
/// Standard deviation of the daily swing of variation, degrees at 24 µT.
const DAILY_SD_DEG: f64 = 0.08;
/// Where H is this, an error of variation has its nominal size.
const NOMINAL_H_NT: f64 = 24_000.0;
/// Share of the reference in the heading at which rows are linearised, from the
/// sizes of the sample-to-sample noise of compass and reference.
const FUSION_WEIGHT: f64 = 0.6;
/// A residual beyond this says nothing about the heading.
const FUSION_LIMIT_DEG: f64 = 3.0;
/// Knots taken where speed is not known.
const TYPICAL_SPEED_KN: f64 = 12.0;
/// Windows of ten seconds in ten minutes.
const FULL_WINDOWS: f64 = 60.0;

/// An observation's part that does not depend on the parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Station {
    /// From the row before in the filter's order (which is later in time).
    pub(crate) transition: Transition,
    /// How the states but the drift add to the residual; the Schuler pair's
    /// rate does not.
    pub(crate) gyro_load: f64,
    pub(crate) variation_load: f64,
    /// White variance in units of a full, unit-weight row's.
    pub(crate) white_factor: f64,
    /// Columns of the leftover speed error and the daily swing, in units of
    /// their prior's standard deviations.
    nuisance: [f64; 3],
}

/// A row at the current parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Measured less predicted, degrees.
    pub(crate) residual: f64,
    /// Its (negative) slopes by the unknowns, in population units.
    pub(crate) columns: [f64; UNKNOWNS],
    /// Its (negative) slopes by bx and by, degrees per nT.
    pub(crate) drift: [f64; 2],
}

/// Stations in the order of the observations, which the caller has sorted from
/// the latest to the earliest.
pub(crate) fn stations(observations: &[Observation]) -> Vec<Station> {
    let mut later: Option<&Observation> = None;
    let mut stations = Vec::with_capacity(observations.len());
    for observation in observations {
        let (seconds, miles) = later.map_or((0.0, 0.0), |later| step(later, observation));
        stations.push(station(observation, Transition::over(seconds, miles)));
        later = Some(observation);
    }
    stations
}

/// Seconds and miles from one observation back to the one before it.
fn step(later: &Observation, earlier: &Observation) -> (f64, f64) {
    let seconds = match (later.time, earlier.time) {
        (Some(later), Some(earlier)) => later.seconds_since(earlier).max(0.0),
        // Rows without times have no memory in common.
        _ => 1e9,
    };
    let miles = match (later.position, earlier.position) {
        (Some(a), Some(b)) => {
            let dlat = a.lat_deg() - b.lat_deg();
            let mid = (f64::midpoint(a.lat_deg(), b.lat_deg())).to_radians();
            let dlon = wrap_180(a.lon_deg() - b.lon_deg()) * mid.cos();
            60.0 * dlat.hypot(dlon)
        }
        _ => later.sog_kn.unwrap_or(TYPICAL_SPEED_KN).abs() * seconds / 3600.0,
    };
    (seconds, miles)
}

fn station(o: &Observation, transition: Transition) -> Station {
    // A gyro loses its sense of north towards the poles; 80° is as far as the
    // rule is meant to hold.
    let lat_deg = o.position.map_or(0.0, Position::lat_deg);
    let per_cos_lat = 1.0 / lat_deg.to_radians().cos().max(0.17);
    let heading = (o.compass + o.deviation) + o.variation;
    let variation_load = (NOMINAL_H_NT / o.h_nt).clamp(0.5, 4.0);
    let speed_error = o
        .sog_kn
        .map_or(0.0, |sog_kn| gyro_speed_error_deg(heading, sog_kn, lat_deg));
    let (sin, cos) = match (o.time, o.position) {
        (Some(time), Some(position)) => {
            let day = time.micros().rem_euclid(86_400_000_000) as f64 / 86_400e6;
            (TAU * (day + position.lon_deg() / 360.0)).sin_cos()
        }
        _ => (0.0, 0.0),
    };
    let windows = f64::from(o.windows).clamp(1.0, FULL_WINDOWS);
    Station {
        transition,
        gyro_load: o.gyro_share * per_cos_lat,
        variation_load,
        white_factor: (1.0 + FULL_WINDOWS / windows) / (2.0 * o.weight),
        nuisance: [
            SPEED_ERROR_SD * o.gyro_share * speed_error,
            DAILY_SD_DEG * variation_load * sin,
            DAILY_SD_DEG * variation_load * cos,
        ],
    }
}

/// The current unknowns in population units: what the rows are taken at.
pub(crate) type Unknowns = [f64; UNKNOWNS];

/// Parameters and constant (degrees) of a set of unknowns.
pub(crate) fn in_own_units(unknowns: &Unknowns) -> ([f64; PARAMETERS], f64) {
    let scale = scales();
    let mut parameters = [0.0; PARAMETERS];
    for j in 0..PARAMETERS {
        parameters[j] = unknowns[j] * scale[j];
    }
    (parameters, unknowns[CONSTANT] * scale[CONSTANT])
}

/// Predicted deviation (degrees) as the compass's user sees it, with the needle
/// it comes from, on the magnetic heading that compass and reference agree on.
fn predict(o: &Observation, unknowns: &Unknowns) -> (f64, Needle) {
    let (parameters, constant) = in_own_units(unknowns);
    let p = Parameters::from_array(parameters);
    let earth = EarthField {
        h_nt: o.h_nt,
        z_nt: o.z_nt,
    };
    let at = |magnetic_deg: f64| {
        let needle = Needle::at(&p, (magnetic_deg - constant).to_radians(), earth);
        let deviation = magnetic_deg - needle.compass_rad().to_degrees();
        (wrap_180(deviation), needle)
    };
    let by_reference = o.compass.degrees() + o.deviation.degrees_east();
    let disagreement = wrap_180(o.deviation.degrees_east() - at(by_reference).0)
        .clamp(-FUSION_LIMIT_DEG, FUSION_LIMIT_DEG);
    at(by_reference - (1.0 - FUSION_WEIGHT) * disagreement)
}

/// The row of `o` at `unknowns`.
pub(crate) fn row(o: &Observation, station: &Station, unknowns: &Unknowns) -> Row {
    let (predicted, needle) = predict(o, unknowns);
    let gradient = needle.gradient();
    let scale = scales();
    // The heading of the row moves with the parameters too.
    let follows = 1.0 + (1.0 - FUSION_WEIGHT) * (1.0 - needle.compass_per_magnetic());
    let mut columns = [0.0; UNKNOWNS];
    for j in 0..PARAMETERS {
        columns[j] = gradient[j].to_degrees() * scale[j] * follows;
    }
    columns[CONSTANT] = needle.compass_per_magnetic() * scale[CONSTANT] * follows;
    columns[CONSTANT + 1..].copy_from_slice(&station.nuisance);
    let mut residual = wrap_180(o.deviation.degrees_east() - predicted);
    for j in CONSTANT + 1..UNKNOWNS {
        residual -= columns[j] * unknowns[j];
    }
    Row {
        residual,
        columns,
        drift: [gradient[0].to_degrees(), gradient[2].to_degrees()],
    }
}

/// Measured less predicted on the compass heading as read, degrees, with what
/// is put down to the reference still in it.
pub(crate) fn plain_residual(o: &Observation, unknowns: &Unknowns) -> f64 {
    let (parameters, constant) = in_own_units(unknowns);
    let earth = EarthField {
        h_nt: o.h_nt,
        z_nt: o.z_nt,
    };
    let by_compass = Coefficients::new(&Parameters::from_array(parameters), earth)
        .ok()
        .and_then(|coefficients| coefficients.deviation_at_compass_rad(o.compass.radians()))
        .map(|deviation| deviation.to_degrees() + constant);
    let predicted = by_compass.unwrap_or_else(|| predict(o, unknowns).0);
    wrap_180(o.deviation.degrees_east() - predicted)
}

/// States that a row sees, as the filter's measurement vector.
pub(crate) fn loads(station: &Station, row: &Row) -> [f64; STATES] {
    [
        station.gyro_load,
        0.0,
        station.gyro_load,
        1.0,
        station.variation_load,
        row.drift[0],
        row.drift[1],
    ]
}
