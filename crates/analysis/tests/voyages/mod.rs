//! Voyages of ships whose magnetism is known, for judging the estimator.
//!
//! Deliberately nothing of the estimator's own is used here: the earth is a
//! tilted dipole, the deviation comes from the closed form by compass heading,
//! and the noise is stepped minute by minute from its physical description.

#![allow(clippy::unwrap_used)] // all of this is tests

#[allow(dead_code, reason = "only the studies ask for it")]
pub(crate) mod bound;
mod errors;
#[allow(dead_code, reason = "only what is about changes asks for it")]
pub(crate) mod fleet;
#[allow(dead_code, reason = "only the study of real ships asks for them all")]
pub(crate) mod habits;
#[allow(dead_code, reason = "only the study of real ships asks for them all")]
pub(crate) mod incidents;
mod kept;
#[allow(dead_code, reason = "only the comparison of detectors asks for it")]
pub(crate) mod lorden;
mod passage;
#[allow(dead_code, reason = "only what is about changes asks for it")]
mod patch;
#[allow(dead_code, reason = "only what is about changes asks for it")]
mod plan;
pub(crate) mod tally;
#[allow(dead_code, reason = "only what is about changes asks for it")]
mod world;

use binnacle_analysis::fit::Observation;
use binnacle_compass::angle::{CompassHeading, Deviation, Variation, wrap_180};
use binnacle_compass::model::{Model, Parameters};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

pub(crate) use errors::Errors;
pub(crate) use passage::Passage;

/// The gyro's share of the reference where both are read.
const GYRO_SHARE_OF_BOTH: f64 = 0.7;

/// Range of magnetic latitudes on a voyage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Variety {
    /// Both hemispheres.
    Rich,
    /// Some thirty degrees.
    Medium,
    /// One sea.
    Poor,
}

/// A voyage and its truth.
pub(crate) struct Voyage {
    pub(crate) observations: Vec<Observation>,
    pub(crate) truth: Truth,
    /// Its first minute.
    #[allow(dead_code, reason = "only the bound asks")]
    pub(crate) start: Timestamp,
    /// Sizes of the errors on this ship.
    pub(crate) sizes: Faults,
    /// Minutes of the turns that disturb the gyro.
    #[allow(dead_code, reason = "only the bound asks")]
    pub(crate) turns: Vec<i64>,
}

/// True state of a ship.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub(crate) parameters: Parameters,
    /// Compass card's misalignment: reading = needle's heading less this.
    pub(crate) alignment_deg: f64,
    /// In every measured deviation, but not in the true one.
    pub(crate) gyro_constant_deg: f64,
    /// Constant error of the satellite compass, where there is one.
    pub(crate) satellite_constant_deg: f64,
    /// Field at the end of the voyage.
    pub(crate) h_nt: f64,
    pub(crate) z_nt: f64,
}

impl Voyage {
    /// Returns the constant error of the reference that the deviations were measured by.
    pub(crate) fn reference_constant_deg(&self) -> f64 {
        let truth = &self.truth;
        if self.sizes.satellite {
            f64::midpoint(truth.gyro_constant_deg, truth.satellite_constant_deg)
        } else {
            truth.gyro_constant_deg
        }
    }
}

/// Sizes of errors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Faults {
    pub(crate) ship: f64,
    /// Difference between ships: standard deviation of the logarithm of each noise level.
    pub(crate) variety: f64,
    pub(crate) gyro_constant_deg: f64,
    pub(crate) schuler_deg: f64,
    pub(crate) slow_gyro_deg: f64,
    pub(crate) variation_deg: f64,
    pub(crate) swing_deg: f64,
    pub(crate) outliers: f64,
    pub(crate) speed_error: f64,
    pub(crate) storms_per_month: f64,
    /// Random walk of bx and by, standard deviation in thirty days.
    pub(crate) drift_nt: f64,
    /// True if a satellite compass is on board beside the gyro.
    pub(crate) satellite: bool,
}

impl Faults {
    pub(crate) const USUAL: Faults = Faults {
        ship: 1.0,
        variety: 0.3,
        gyro_constant_deg: 0.5,
        schuler_deg: 0.35,
        slow_gyro_deg: 0.3,
        variation_deg: 0.2,
        swing_deg: 0.2,
        outliers: 0.003,
        speed_error: 0.1,
        storms_per_month: 0.5,
        drift_nt: 60.0,
        satellite: false,
    };

    /// Returns the sizes of one ship out of many.
    fn of_one_ship(&self, rng: &mut ChaCha8Rng) -> Faults {
        let mut vary = |size: f64| size * (self.variety * gauss(rng)).exp();
        Faults {
            schuler_deg: vary(self.schuler_deg),
            slow_gyro_deg: vary(self.slow_gyro_deg),
            variation_deg: vary(self.variation_deg),
            swing_deg: vary(self.swing_deg),
            drift_nt: vary(self.drift_nt),
            ..*self
        }
    }
}

/// A standard Gaussian.
pub(crate) fn gauss(rng: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (rng.random(), rng.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
}

/// Declination in degrees, H and Z in nT, of the tilted dipole of 2025.
pub(crate) fn dipole(lat_deg: f64, lon_deg: f64) -> (f64, f64, f64) {
    let (g10, g11, h11) = (-29_350.0, -1410.0, 4545.0);
    let (sin_lat, cos_lat) = lat_deg.to_radians().sin_cos();
    let (sin_lon, cos_lon) = lon_deg.to_radians().sin_cos();
    let equatorial = g11 * cos_lon + h11 * sin_lon;
    let x = -g10 * cos_lat + equatorial * sin_lat;
    let y = g11 * sin_lon - h11 * cos_lon;
    let z = -2.0 * (g10 * sin_lat + equatorial * cos_lat);
    (y.atan2(x).to_degrees(), x.hypot(y), z)
}

/// Exact deviation by compass heading, degrees (closed form).
pub(crate) fn deviation_by_compass(p: &[f64; 7], compass_deg: f64, h: f64, z: f64) -> f64 {
    let a = (p[6] - p[5]) / 2.0;
    let b = (p[0] + p[1] * z) / h;
    let c = (p[2] + p[3] * z) / h;
    let d = p[4] / 2.0;
    let e = f64::midpoint(p[6], p[5]);
    let (s, co) = compass_deg.to_radians().sin_cos();
    let (s2, c2) = (2.0 * compass_deg.to_radians()).sin_cos();
    let k1 = 1.0 - d * c2 + e * s2;
    let k2 = a + d * s2 + e * c2;
    let k3 = b * s + c * co;
    ((k3 / k1.hypot(k2)).asin() + k2.atan2(k1)).to_degrees()
}

/// The true deviation as the compass's user sees it.
pub(crate) fn true_deviation(truth: &Truth, compass_deg: f64, h: f64, z: f64) -> f64 {
    let needle = compass_deg + truth.alignment_deg;
    wrap_180(deviation_by_compass(&truth.parameters.to_array(), needle, h, z) + truth.alignment_deg)
}

/// The model's deviation and its standard error, both in degrees.
pub(crate) fn predicted(model: &Model, compass_deg: f64, h: f64, z: f64) -> (f64, f64) {
    let p = model.parameters_over_lambda.to_array();
    let centre = deviation_by_compass(&p, compass_deg, h, z);
    let steps = [1.0, 1e-5, 1.0, 1e-5, 1e-5, 1e-5, 1e-5];
    let mut gradient = [1.0; 8];
    for j in 0..7 {
        let mut moved = p;
        moved[j] += steps[j];
        gradient[j] = (deviation_by_compass(&moved, compass_deg, h, z) - centre) / steps[j];
    }
    let covariance = model.covariance.unwrap();
    let mut variance = 0.0;
    for i in 0..8 {
        for j in 0..8 {
            variance += gradient[i] * covariance[i][j] * gradient[j];
        }
    }
    (centre + model.constant_deg, variance.sqrt())
}

/// A ship's passage of `days`, one observation every ten minutes at sea, on an
/// earth that is a dipole.
pub(crate) fn sail(seed: u64, variety: Variety, days: f64, faults: &Faults) -> Voyage {
    sail_on(|lat, lon, _| dipole(lat, lon), seed, variety, days, faults)
}

/// Returns a passage on an earth whose declination, H and Z follow from latitude, longitude
/// and time.
pub(crate) fn sail_on(
    earth: impl Fn(f64, f64, Timestamp) -> (f64, f64, f64),
    seed: u64,
    variety: Variety,
    days: f64,
    faults: &Faults,
) -> Voyage {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let sizes = faults.of_one_ship(&mut rng);
    let faults = &sizes;
    let mut turns = Vec::new();
    let mut truth = Truth::for_unknown_vessel(faults, &mut rng);
    let mut passage = Passage::new(variety, &mut rng);
    let mut errors = Errors::new(faults, &mut rng);
    let start = Timestamp::parse("2026-09-01T00:00:00Z").unwrap();
    let mut mean = Mean::default();
    let mut observations = Vec::new();
    for minute in 0..(days * 1440.0) as i64 {
        let turned = passage.minute(&mut rng);
        if turned.abs() > 20.0 {
            turns.push(minute);
        }
        if minute % 60 == 0 {
            let hourly = faults.drift_nt / 720.0_f64.sqrt();
            truth.parameters.bx_nt += hourly * gauss(&mut rng);
            truth.parameters.by_nt += hourly * gauss(&mut rng);
        }
        errors.minute(faults, &passage, turned, &mut rng);
        if passage.berth_minutes > 0.0 || passage.turning_minutes > 0.0 {
            mean = Mean::default();
            continue;
        }
        let time = start.plus_seconds(60.0 * minute as f64);
        let (variation, h_nt, z_nt) = earth(passage.lat, passage.lon, time);
        let read = errors.read(&truth, &passage, minute, (variation, h_nt, z_nt), &mut rng);
        let Some([mut compass, mut gyro, satellite]) = mean.add(read) else {
            continue;
        };
        if rng.random::<f64>() < faults.outliers {
            gyro += 10.0 * gauss(&mut rng);
        }
        if rng.random::<f64>() < faults.outliers {
            compass += 10.0 * gauss(&mut rng);
        }
        // The two are centred on each other, as their check would do.
        let apart = truth.gyro_constant_deg - truth.satellite_constant_deg;
        let (gyro, satellite) = if faults.satellite {
            (gyro - apart / 2.0, Some(satellite + apart / 2.0))
        } else {
            (gyro, None)
        };
        let (reference, gyro_share) = satellite.map_or((gyro, 1.0), |satellite| {
            let share = GYRO_SHARE_OF_BOTH;
            (satellite + share * wrap_180(gyro - satellite), share)
        });
        observations.push(Observation {
            time: Some(time),
            position: Some(Position::new(passage.lat, passage.lon).unwrap()),
            compass: CompassHeading::new(compass).unwrap(),
            deviation: Deviation::new(reference - variation - compass).unwrap(),
            variation: Variation::new(variation).unwrap(),
            h_nt,
            z_nt,
            gyro_share,
            gyro_less_satellite_deg: satellite.map(|s| wrap_180(gyro - s)),
            sog_kn: Some(passage.speed_kn),
            windows: 55,
            spread_deg: None,
            weight: 1.0,
        });
    }
    let end = start.plus_seconds(days * 86_400.0);
    let (_, h_nt, z_nt) = earth(passage.lat, passage.lon, end);
    Voyage {
        observations,
        truth: Truth {
            h_nt,
            z_nt,
            ..truth
        },
        start,
        sizes,
        turns,
    }
}

impl Truth {
    fn for_unknown_vessel(faults: &Faults, rng: &mut ChaCha8Rng) -> Truth {
        let sd = [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008];
        Truth {
            parameters: Parameters::from_array(sd.map(|s| s * faults.ship * gauss(rng))),
            alignment_deg: 0.5 * gauss(rng),
            gyro_constant_deg: faults.gyro_constant_deg * gauss(rng),
            satellite_constant_deg: faults.gyro_constant_deg * gauss(rng),
            h_nt: 0.0,
            z_nt: 0.0,
        }
    }
}

/// The mean of ten readings of each instrument on one course.
#[derive(Default)]
struct Mean {
    count: u32,
    /// First reading, and the mean of the others' distance from it: a compass may point astern.
    first: [f64; 3],
    off: [f64; 3],
}

impl Mean {
    fn add(&mut self, read: [f64; 3]) -> Option<[f64; 3]> {
        if self.count == 0 {
            self.first = read;
        }
        self.count += 1;
        for ((sum, reading), first) in self.off.iter_mut().zip(read).zip(self.first) {
            *sum += wrap_180(reading - first) / 10.0;
        }
        if self.count < 10 {
            return None;
        }
        let mean = std::array::from_fn(|i| self.first[i] + self.off[i]);
        *self = Mean::default();
        Some(mean)
    }
}

/// Returns the needle's heading on a magnetic heading: Poisson's equations over λ.
fn needle(p: &Parameters, magnetic_deg: f64, h: f64, z: f64) -> f64 {
    let (sin, cos) = magnetic_deg.to_radians().sin_cos();
    let (forward, starboard) = (h * cos, -h * sin);
    let half = p.chi11_minus_chi22 / 2.0;
    let x = (1.0 + half) * forward + p.chi12 * starboard + p.chi13 * z + p.bx_nt;
    let y = p.chi21 * forward + (1.0 - half) * starboard + p.chi23 * z + p.by_nt;
    (-y).atan2(x).to_degrees()
}
