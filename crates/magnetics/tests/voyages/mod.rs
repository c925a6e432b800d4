//! Voyages of ships whose magnetism is known, for judging the estimator.
//!
//! Deliberately nothing of the estimator's own is used here: the earth is a
//! tilted dipole, the deviation comes from the closed form by compass heading,
//! and the noise is stepped minute by minute from its physical description.

#![allow(clippy::unwrap_used)] // all of this is tests

use binnacle_magnetics::angle::{CompassHeading, Deviation, Variation, wrap_180};
use binnacle_magnetics::fit::Observation;
use binnacle_magnetics::model::{Model, Parameters};
use binnacle_magnetics::position::Position;
use binnacle_magnetics::time::Timestamp;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// How much of the range of magnetic latitudes a voyage sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Variety {
    /// Both hemispheres.
    Rich,
    /// Some thirty degrees.
    Medium,
    /// One sea.
    Poor,
}

/// What happened on a voyage and what was true of the ship.
pub(crate) struct Voyage {
    pub(crate) observations: Vec<Observation>,
    pub(crate) truth: Truth,
}

/// The ship as she is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub(crate) parameters: Parameters,
    /// Compass card's misalignment: reading = needle's heading less this.
    pub(crate) alignment_deg: f64,
    /// In every measured deviation, but not in the true one.
    pub(crate) gyro_constant_deg: f64,
    /// Field at the end of the voyage.
    pub(crate) h_nt: f64,
    pub(crate) z_nt: f64,
}

/// The sizes of what goes wrong.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Faults {
    pub(crate) ship: f64,
    pub(crate) schuler_deg: f64,
    pub(crate) slow_gyro_deg: f64,
    pub(crate) variation_deg: f64,
    pub(crate) swing_deg: f64,
    pub(crate) outliers: f64,
    pub(crate) speed_error: f64,
    pub(crate) storms_per_month: f64,
}

impl Faults {
    pub(crate) const USUAL: Faults = Faults {
        ship: 1.0,
        schuler_deg: 0.35,
        slow_gyro_deg: 0.3,
        variation_deg: 0.2,
        swing_deg: 0.2,
        outliers: 0.003,
        speed_error: 0.1,
        storms_per_month: 0.5,
    };
}

/// A standard Gaussian.
pub(crate) fn gauss(rng: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (rng.random(), rng.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
}

/// Declination in degrees, H and Z in nT, of the tilted dipole of 2025.
pub(crate) fn dipole(lat_deg: f64, lon_deg: f64) -> (f64, f64, f64) {
    let (g10, g11, h11) = (-29350.0, -1410.0, 4545.0);
    let (st, ct) = lat_deg.to_radians().cos_sin();
    let (sp, cp) = lon_deg.to_radians().sin_cos();
    let equatorial = g11 * cp + h11 * sp;
    let x = -(g10 * st) * 1.0 + equatorial * ct;
    let y = g11 * sp - h11 * cp;
    let z = -2.0 * (g10 * ct + equatorial * st);
    (y.atan2(x).to_degrees(), x.hypot(y), z)
}

trait CosSin {
    fn cos_sin(self) -> (f64, f64);
}
impl CosSin for f64 {
    /// Sine and cosine of the colatitude.
    fn cos_sin(self) -> (f64, f64) {
        (self.cos(), self.sin())
    }
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

pub(crate) fn array(p: &Parameters) -> [f64; 7] {
    [
        p.bx_nt,
        p.chi13,
        p.by_nt,
        p.chi23,
        p.chi11_minus_chi22,
        p.chi12,
        p.chi21,
    ]
}

/// The true deviation as the compass's user sees it.
pub(crate) fn true_deviation(truth: &Truth, compass_deg: f64, h: f64, z: f64) -> f64 {
    let needle = compass_deg + truth.alignment_deg;
    wrap_180(deviation_by_compass(&array(&truth.parameters), needle, h, z) + truth.alignment_deg)
}

/// The model's deviation and its standard error, both in degrees.
pub(crate) fn predicted(model: &Model, compass_deg: f64, h: f64, z: f64) -> (f64, f64) {
    let p = array(&model.parameters_over_lambda);
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

/// A ship's passage of `days`, one observation every ten minutes at sea.
#[allow(clippy::too_many_lines)] // one minute after another
pub(crate) fn sail(seed: u64, variety: Variety, days: f64, faults: &Faults) -> Voyage {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let sd = [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008];
    let p = sd.map(|s| s * faults.ship * gauss(&mut rng));
    let parameters = Parameters {
        bx_nt: p[0],
        chi13: p[1],
        by_nt: p[2],
        chi23: p[3],
        chi11_minus_chi22: p[4],
        chi12: p[5],
        chi21: p[6],
    };
    let alignment_deg = 0.5 * gauss(&mut rng);
    let gyro_constant_deg = 0.35 * gauss(&mut rng);
    let speed_error = faults.speed_error * gauss(&mut rng);
    let ports = ports(variety, &mut rng);
    let (mut lat, mut lon) = ports[0];
    let mut bound_for = 1;
    let mut course: f64 = 0.0;
    let mut leg_minutes = 0.0;
    let mut berth_minutes: f64 = 0.0;
    let mut turning = 0;
    let speed_kn = 12.0 + 4.0 * rng.random::<f64>();
    // Gyro: swing, its rate, slow error; compass swing; variation error.
    let (mut swing, mut rate) = (faults.schuler_deg * gauss(&mut rng), 0.0);
    let mut slow = faults.slow_gyro_deg * gauss(&mut rng);
    let mut compass_swing = 0.0;
    let mut crust = faults.variation_deg * gauss(&mut rng);
    let mut storm_left = 0.0;
    let mut storm = 0.0;
    let omega = TAU / 84.4;
    let start = Timestamp::parse("2026-09-01T00:00:00Z").unwrap();
    let mut sums = (0, 0.0, 0.0);
    let mut observations = Vec::new();
    for minute in 0..(days * 1440.0) as i64 {
        let mut kick = 0.0;
        if berth_minutes > 0.0 {
            berth_minutes -= 1.0;
        } else {
            if leg_minutes <= 0.0 {
                let (to_lat, to_lon) = ports[bound_for];
                let east = wrap_180(to_lon - lon) * lat.to_radians().cos();
                let north = to_lat - lat;
                if east.hypot(north) < 2.0 {
                    bound_for = (bound_for + 1) % ports.len();
                    berth_minutes = 720.0 + 1440.0 * rng.random::<f64>();
                }
                let wanted = east.atan2(north).to_degrees() + 30.0 * gauss(&mut rng);
                let near = if variety == Variety::Poor {
                    150.0
                } else {
                    360.0
                };
                leg_minutes = (near * (0.8 * gauss(&mut rng)).exp()).clamp(20.0, 2000.0);
                let turn = wrap_180(wanted - course);
                if turn.abs() > 20.0 {
                    kick = faults.schuler_deg * 1.2 * gauss(&mut rng);
                }
                course = wanted.rem_euclid(360.0);
                turning = 6;
                sums = (0, 0.0, 0.0);
            }
            leg_minutes -= 1.0;
            lat += speed_kn / 3600.0 * course.to_radians().cos();
            lon = wrap_180(
                lon + speed_kn / 3600.0 * course.to_radians().sin() / lat.to_radians().cos(),
            );
        }
        // Minute steps of each process.
        rate += kick * omega - (omega * omega * swing + 2.0 * 0.2 * omega * rate)
            + faults.schuler_deg * omega * (4.0f64 * 0.2 * omega * 0.3).sqrt() * gauss(&mut rng);
        swing += rate;
        step(&mut slow, 1.0 / 4320.0, faults.slow_gyro_deg, &mut rng);
        step(&mut compass_swing, 1.0 / 20.0, faults.swing_deg, &mut rng);
        let underway = berth_minutes <= 0.0;
        if underway {
            step(
                &mut crust,
                speed_kn / 60.0 / 60.0,
                faults.variation_deg,
                &mut rng,
            );
        }
        if storm_left > 0.0 {
            storm_left -= 1.0;
            step(&mut storm, 1.0 / 60.0, 1.0, &mut rng);
        } else {
            storm = 0.0;
            if rng.random::<f64>() < faults.storms_per_month / 43_200.0 {
                storm_left = 240.0 + 600.0 * rng.random::<f64>();
            }
        }
        if !underway {
            sums = (0, 0.0, 0.0);
            continue;
        }
        if turning > 0 {
            turning -= 1;
            continue;
        }
        let (variation, h, z) = dipole(lat, lon);
        let yaw = 1.0 * gauss(&mut rng);
        let true_heading = course + yaw;
        let daily = 0.12 * (TAU * (minute as f64 / 1440.0 + lon / 360.0)).sin();
        let scale = 24_000.0 / h;
        let magnetic = true_heading - variation - (crust + daily + storm) * scale;
        let compass =
            needle(&p, magnetic, h, z) - alignment_deg + compass_swing + 0.35 * gauss(&mut rng);
        let north_speed = speed_error
            * (speed_kn * course.to_radians().cos() / (902.5 * lat.to_radians().cos()))
                .to_degrees();
        let gyro = true_heading
            + gyro_constant_deg
            + (swing + slow) / lat.to_radians().cos()
            + north_speed
            + 0.15 * gauss(&mut rng);
        sums.0 += 1;
        sums.1 += wrap_180(compass - course);
        sums.2 += wrap_180(gyro - course);
        if sums.0 < 10 {
            continue;
        }
        let mut compass = course + sums.1 / 10.0;
        let mut gyro = course + sums.2 / 10.0;
        sums = (0, 0.0, 0.0);
        if rng.random::<f64>() < faults.outliers {
            gyro += 10.0 * gauss(&mut rng);
        }
        if rng.random::<f64>() < faults.outliers {
            compass += 10.0 * gauss(&mut rng);
        }
        observations.push(Observation {
            time: Some(start.plus_seconds(60.0 * minute as f64)),
            position: Some(Position::new(lat, lon).unwrap()),
            compass: CompassHeading::new(compass).unwrap(),
            deviation: Deviation::new(gyro - variation - compass).unwrap(),
            variation: Variation::new(variation).unwrap(),
            h_nt: h,
            z_nt: z,
            gyro_share: 1.0,
            sog_kn: Some(speed_kn),
            windows: 55,
            weight: 1.0,
        });
    }
    let (_, h_nt, z_nt) = dipole(lat, lon);
    Voyage {
        observations,
        truth: Truth {
            parameters,
            alignment_deg,
            gyro_constant_deg,
            h_nt,
            z_nt,
        },
    }
}

/// One step of a process that forgets `share` of itself and keeps its spread.
fn step(x: &mut f64, share: f64, sd: f64, rng: &mut ChaCha8Rng) {
    let keep = (-share).exp();
    *x = *x * keep + sd * (1.0 - keep * keep).sqrt() * gauss(rng);
}

/// Where the needle settles on a magnetic heading, by bisection on the closed form.
fn needle(p: &[f64; 7], magnetic_deg: f64, h: f64, z: f64) -> f64 {
    let (mut low, mut high) = (magnetic_deg - 90.0, magnetic_deg + 90.0);
    for _ in 0..45 {
        let middle = f64::midpoint(low, high);
        if middle + deviation_by_compass(p, middle, h, z) < magnetic_deg {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}

fn ports(variety: Variety, rng: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
    let at = |rng: &mut ChaCha8Rng, lat: f64, lon: f64, spread: f64| {
        (
            lat + spread * gauss(rng) / 2.0,
            lon + spread * gauss(rng) / 2.0,
        )
    };
    match variety {
        Variety::Rich => vec![
            at(rng, 48.0, -8.0, 5.0),
            at(rng, 10.0, -20.0, 5.0),
            at(rng, -34.0, 15.0, 3.0),
            at(rng, -23.0, -40.0, 5.0),
        ],
        Variety::Medium => vec![
            at(rng, 50.0, -10.0, 4.0),
            at(rng, 25.0, -30.0, 6.0),
            at(rng, 40.0, -60.0, 4.0),
        ],
        Variety::Poor => {
            let (lat, lon) = if rng.random::<bool>() {
                (56.0, 4.0)
            } else {
                (16.0, -68.0)
            };
            (0..6).map(|_| at(rng, lat, lon, 6.0)).collect()
        }
    }
}
