//! What a model and a berth reading come to know of a true ship.

use super::random::Random;
use super::{Place, Standing};
use binnacle_magnetics::adjust::Water;
use binnacle_magnetics::angle::MagneticHeading;
use binnacle_magnetics::berth::{Alignment, BerthReading, ReadingErrors};
use binnacle_magnetics::model::{Identifiable, Model, Parameters};
use nalgebra::{SMatrix, SVector};

/// How a ship and her instruments are measured.
#[derive(Clone, Copy)]
pub(crate) struct Instruments {
    /// Of the magnetometer and what the berth's field is not known to, nT.
    pub(crate) field_sd_nt: f64,
    pub(crate) scale_sd: f64,
    pub(crate) heading_sd_deg: f64,
}

pub(crate) const FLUXGATE: Instruments = Instruments {
    field_sd_nt: 150.0,
    scale_sd: 0.003,
    heading_sd_deg: 0.5,
};

pub(crate) const PHONE: Instruments = Instruments {
    field_sd_nt: 1_000.0,
    scale_sd: 0.02,
    heading_sd_deg: 1.0,
};

/// The waters of a ship, the berth's first: over this share of what there is.
pub(crate) fn waters(rng: &mut Random, share: f64) -> Vec<Water> {
    let count = 2 + rng.below(3);
    let (low, high) = ([17_000.0, -25_000.0], [36_000.0, 47_000.0]);
    let home = [0, 1].map(|i| rng.between(low[i], high[i]));
    (0..count)
        .map(|index| {
            let away = [0, 1].map(|i| rng.between(low[i], high[i]) - home[i]);
            Water {
                name: format!("water {index}"),
                h_nt: home[0] + share * away[0],
                z_nt: home[1] + share * away[1],
                weight: rng.between(0.2, 1.0),
            }
        })
        .collect()
}

/// A model with the errors that headings in these waters would leave, and their
/// covariance.
pub(crate) fn model(rng: &mut Random, truth: &Standing, waters: &[Water]) -> Model {
    let weights: f64 = waters.iter().map(|w| w.weight).sum();
    let mean_h = weights / waters.iter().map(|w| w.weight / w.h_nt).sum::<f64>();
    let ratios = truth.ratios(mean_h);
    let prior = [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008, 0.5];
    let mut information = SMatrix::<f64, 8, 8>::zeros();
    for (index, sd) in prior.iter().enumerate() {
        information[(index, index)] = 1.0 / f64::powi(*sd, 2);
    }
    for water in waters {
        for heading in 0..24 {
            let row = slopes(&ratios, (water.h_nt, water.z_nt), f64::from(heading) * 15.0);
            // One heading of each 15° in a water, good to 0.7°, weighted by the time there.
            let weight = 2.0 * water.weight / weights / f64::powi(0.7, 2);
            information += weight * row * row.transpose();
        }
    }
    let mut covariance = information.try_inverse().unwrap();
    // The reference's own constant, which no heading tells.
    covariance[(7, 7)] += 0.35 * 0.35;
    covariance = (covariance + covariance.transpose()) / 2.0;
    let error =
        covariance.cholesky().unwrap().l() * SVector::<f64, 8>::from_fn(|_, _| rng.gaussian());
    let parameters: [f64; 7] = std::array::from_fn(|i| ratios[i] + error[i]);
    Model {
        parameters_over_lambda: Parameters::from_array(parameters),
        constant_deg: truth.alignment_deg + error[7],
        covariance: Some(std::array::from_fn(|r| {
            std::array::from_fn(|c| covariance[(r, c)])
        })),
        identifiable: Some(Identifiable {
            bx_nt: true,
            chi13: true,
            by_nt: true,
            chi23: true,
            chi11_minus_chi22: true,
            chi12: false,
            chi21: false,
            constant_deg: false,
        }),
        rms_deg: Some(0.6),
        samples_used: 1000,
        samples_rejected: 0,
        quality: None,
    }
}

/// Slopes of the deviation, degrees, on a magnetic heading, by small differences.
fn slopes(ratios: &[f64; 7], place: Place, magnetic_deg: f64) -> SVector<f64, 8> {
    let deviation = |p: &[f64; 7]| {
        let (sin, cos) = magnetic_deg.to_radians().sin_cos();
        let (hx, hy, z) = (place.0 * cos, -place.0 * sin, place.1);
        let x = hx * (1.0 + p[4] / 2.0) + p[5] * hy + p[1] * z + p[0];
        let y = hy * (1.0 - p[4] / 2.0) + p[6] * hx + p[3] * z + p[2];
        super::wrap(magnetic_deg - (-y).atan2(x).to_degrees())
    };
    let steps = [1.0, 1e-5, 1.0, 1e-5, 1e-5, 1e-5, 1e-5];
    SVector::from_fn(|i, _| {
        let Some(step) = steps.get(i) else { return 1.0 };
        let mut moved = *ratios;
        moved[i] += step;
        super::wrap(deviation(&moved) - deviation(ratios)) / step
    })
}

/// A reading at the berth on a heading from ashore.
pub(crate) fn reading(
    rng: &mut Random,
    truth: &Standing,
    place: Place,
    instruments: Instruments,
) -> BerthReading {
    let errors = ReadingErrors {
        field_sd_nt: instruments.field_sd_nt,
        heading_sd_deg: instruments.heading_sd_deg,
        alignment_sd_deg: 0.3,
        tilt_sd_deg: 0.3,
    };
    let heading = rng.between(0.0, 360.0);
    let [x, y, z] = truth.field(place, heading);
    let tilt = [0, 1].map(|_| (errors.tilt_sd_deg * rng.gaussian()).to_radians());
    let (sin, cos) = (errors.alignment_sd_deg * rng.gaussian())
        .to_radians()
        .sin_cos();
    let scale = 1.0 + instruments.scale_sd * rng.gaussian();
    let turned = [x * cos + y * sin, y * cos - x * sin];
    let read = [0, 1]
        .map(|axis| scale * (turned[axis] + tilt[axis] * z) + errors.field_sd_nt * rng.gaussian());
    let told = heading + errors.heading_sd_deg * rng.gaussian();
    let magnetic = MagneticHeading::new(told).unwrap();
    BerthReading::new(magnetic, read, errors, Alignment::Keel).unwrap()
}
