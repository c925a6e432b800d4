//! Knowledge of a true ship from a model and a berth reading.

use super::random::Random;
use super::{Place, Standing};
use binnacle_adjustment::adjust::Water;
use binnacle_adjustment::berth::{Alignment, BerthReading, ReadingErrors};
use binnacle_compass::angle::MagneticHeading;
use binnacle_compass::model::{Identifiable, Model, Parameters, ReferenceGrade};
use nalgebra::{SMatrix, SVector};

/// Errors of the ship's instruments.
#[derive(Clone, Copy)]
pub(crate) struct Instruments {
    /// Noise of the magnetometer and unknown field of the berth, nT.
    pub(crate) field_sd_nt: f64,
    pub(crate) scale_sd: f64,
    pub(crate) heading_sd_deg: f64,
    /// Errors of its alignment, and of its tilt in roll and in pitch, degrees.
    pub(crate) turned_sd_deg: f64,
}

/// A fluxgate of docs/plan.md, with the usual steel of a quay.
pub(crate) const FLUXGATE: Instruments = Instruments {
    field_sd_nt: 141.0,
    scale_sd: 0.003,
    heading_sd_deg: 0.5,
    turned_sd_deg: 0.3,
};

/// A telephone of docs/plan.md.
pub(crate) const PHONE: Instruments = Instruments {
    field_sd_nt: 1_005.0,
    scale_sd: 0.03,
    heading_sd_deg: 0.5,
    turned_sd_deg: 1.0,
};

/// The ship's waters, the berth's first: over this share of all.
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

/// Constant error of the reference, degrees, which no heading shows.
pub(crate) const REFERENCE_SD_DEG: f64 = 0.35;
/// Prior standard deviations over ships, as in an estimator.
const PRIOR: [f64; 8] = [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008, 0.5];

/// A model with the errors and covariance that headings in these waters would leave.
pub(crate) fn model(rng: &mut Random, truth: &Standing, waters: &[Water]) -> Model {
    let reference_deg = REFERENCE_SD_DEG * rng.gaussian();
    model_by(rng, truth, waters, reference_deg)
}

/// A model from a reference with this error.
pub(crate) fn model_by(
    rng: &mut Random,
    truth: &Standing,
    waters: &[Water],
    reference_deg: f64,
) -> Model {
    let mut model = exactly(truth, waters);
    let mut covariance = SMatrix::<f64, 8, 8>::from(model.covariance.unwrap());
    covariance[(7, 7)] -= REFERENCE_SD_DEG.powi(2);
    let error =
        covariance.cholesky().unwrap().l() * SVector::<f64, 8>::from_fn(|_, _| rng.gaussian());
    let mut parameters = model.parameters_over_lambda.to_array();
    for (parameter, error) in parameters.iter_mut().zip(&error) {
        *parameter += error;
    }
    model.parameters_over_lambda = Parameters::from_array(parameters);
    model.constant_deg += error[7] + reference_deg;
    model
}

/// Model from headings without errors, with the covariance that they leave: one heading in
/// each 15° of a water, twice, precise to 0.7°, weighted by the time there.
pub(crate) fn exactly(truth: &Standing, waters: &[Water]) -> Model {
    let weights: f64 = waters.iter().map(|w| w.weight).sum();
    let mean_h = weights / waters.iter().map(|w| w.weight / w.h_nt).sum::<f64>();
    let ratios = truth.ratios(mean_h);
    let rows = |of: &[f64; 7]| -> Vec<Row> {
        let each = waters.iter().flat_map(|water| {
            let weight = 2.0 * water.weight / weights / f64::powi(0.7, 2);
            (0..24).map(move |i| ((water.h_nt, water.z_nt), f64::from(i) * 15.0, weight))
        });
        each.map(|(place, magnetic_deg, weight)| Row {
            slope: slopes(of, place, magnetic_deg),
            off_deg: {
                let shown = magnetic_deg - truth.compass_deg(place, magnetic_deg);
                super::wrap(shown - deviation(of, place, magnetic_deg))
            },
            weight,
        })
        .collect()
    };
    let mut information = SMatrix::<f64, 8, 8>::zeros();
    for (index, sd) in PRIOR.iter().enumerate() {
        information[(index, index)] = sd.powi(-2);
    }
    for row in rows(&ratios) {
        information += row.weight * row.slope * row.slope.transpose();
    }
    let inverse = information.try_inverse().unwrap();
    // With needles' induction the card does not exactly follow seven parameters: the
    // nearest are fitted to its headings.
    let mut fitted = SVector::<f64, 8>::from_fn(|i, _| ratios.get(i).copied().unwrap_or(0.0));
    let start = fitted;
    for _ in 0..12 {
        let mut step = (start - fitted).zip_map(&SVector::from(PRIOR), |off, sd| off / (sd * sd));
        for row in rows(&std::array::from_fn(|i| fitted[i])) {
            step += row.weight * (row.off_deg - fitted[7]) * row.slope;
        }
        fitted += inverse * step;
    }
    let mut covariance = (inverse + inverse.transpose()) / 2.0;
    covariance[(7, 7)] += REFERENCE_SD_DEG.powi(2);
    Model {
        parameters_over_lambda: Parameters::from_array(std::array::from_fn(|i| fitted[i])),
        constant_deg: fitted[7],
        covariance: Some(covariance.transpose().into()),
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
        reference_grade: ReferenceGrade::Heading,
        mean_h_nt: Some(mean_h),
        needles: None,
    }
}

/// One heading: slopes of its deviation, and its residual from a model.
struct Row {
    slope: SVector<f64, 8>,
    off_deg: f64,
    weight: f64,
}

/// Deviation, degrees, on a magnetic heading.
fn deviation(p: &[f64; 7], place: Place, magnetic_deg: f64) -> f64 {
    let (sin, cos) = magnetic_deg.to_radians().sin_cos();
    let (hx, hy, z) = (place.0 * cos, -place.0 * sin, place.1);
    let x = hx * (1.0 + p[4] / 2.0) + p[5] * hy + p[1] * z + p[0];
    let y = hy * (1.0 - p[4] / 2.0) + p[6] * hx + p[3] * z + p[2];
    super::wrap(magnetic_deg - (-y).atan2(x).to_degrees())
}

/// Slopes of the deviation, degrees, on a magnetic heading, by small differences.
fn slopes(ratios: &[f64; 7], place: Place, magnetic_deg: f64) -> SVector<f64, 8> {
    let deviation = |p: &[f64; 7]| deviation(p, place, magnetic_deg);
    let steps = [1.0, 1e-5, 1.0, 1e-5, 1e-5, 1e-5, 1e-5];
    SVector::from_fn(|i, _| {
        let Some(step) = steps.get(i) else { return 1.0 };
        let mut moved = *ratios;
        moved[i] += step;
        super::wrap(deviation(&moved) - deviation(ratios)) / step
    })
}

/// Reading at a berth, with the true heading.
pub(crate) struct Berthed {
    pub(crate) reading: BerthReading,
    pub(crate) down_nt: f64,
    pub(crate) magnetic_deg: f64,
    /// Gain of the magnetometer.
    scale: f64,
    given_deg: f64,
    noise_nt: [f64; 3],
}

impl Berthed {
    /// Returns the reading with a given heading that is off by this.
    pub(crate) fn misheaded(self, off_deg: f64, instruments: Instruments) -> Berthed {
        let given_deg = self.given_deg + off_deg;
        Berthed {
            reading: read(self.reading.field_nt(), given_deg, instruments),
            given_deg,
            ..self
        }
    }

    /// Returns the reading with other stated errors.
    pub(crate) fn said_by(self, instruments: Instruments) -> Berthed {
        Berthed {
            reading: read(self.reading.field_nt(), self.given_deg, instruments),
            ..self
        }
    }
}

/// Share of the noise that is steady steel, as a standard deviation.
const STEEL_SHARE: f64 = 0.5;

/// Makes a reading at the berth on a random heading from ashore.
pub(crate) fn reading(
    rng: &mut Random,
    truth: &Standing,
    place: Place,
    instruments: Instruments,
) -> Berthed {
    let heading = rng.between(0.0, 360.0);
    reading_on(rng, truth, place, heading, instruments)
}

/// Makes a reading on this heading.
pub(crate) fn reading_on(
    rng: &mut Random,
    truth: &Standing,
    place: Place,
    heading: f64,
    instruments: Instruments,
) -> Berthed {
    let errors = errors(instruments);
    let [x, y, z] = truth.field(place, heading);
    let tilt = [0, 1].map(|_| (errors.tilt_sd_deg * rng.gaussian()).to_radians());
    let (sin, cos) = (errors.alignment_sd_deg * rng.gaussian())
        .to_radians()
        .sin_cos();
    let scale = 1.0 + instruments.scale_sd * rng.gaussian();
    let turned = [x * cos + y * sin, y * cos - x * sin];
    let noise = |rng: &mut Random| errors.field_sd_nt * rng.gaussian();
    let across_nt = [noise(rng), noise(rng)];
    let read_nt = [0, 1].map(|axis| scale * (turned[axis] + tilt[axis] * z) + across_nt[axis]);
    let given = heading + errors.heading_sd_deg * rng.gaussian();
    let upright = z - tilt[0] * x - tilt[1] * y;
    let down_nt = noise(rng);
    Berthed {
        reading: read(read_nt, given, instruments),
        down_nt: scale * upright + down_nt,
        magnetic_deg: heading,
        scale,
        given_deg: given,
        noise_nt: [across_nt[0], across_nt[1], down_nt],
    }
}

/// Makes another reading of the same magnetometer on the same heading with other
/// correctors: forward, to starboard and down, nT.
pub(crate) fn again(
    rng: &mut Random,
    truth: &Standing,
    place: Place,
    instruments: Instruments,
    first: &Berthed,
) -> (BerthReading, f64) {
    let errors = errors(instruments);
    let [x, y, z] = truth.field(place, first.magnetic_deg);
    let tilt = [0, 1].map(|_| (errors.tilt_sd_deg * rng.gaussian()).to_radians());
    let turned = (errors.alignment_sd_deg * rng.gaussian()).to_radians();
    let (sin, cos) = turned.sin_cos();
    let tilted = [
        x * cos + y * sin + tilt[0] * z,
        y * cos - x * sin + tilt[1] * z,
        z - tilt[0] * x - tilt[1] * y,
    ];
    let new = (1.0 - STEEL_SHARE * STEEL_SHARE).sqrt() * errors.field_sd_nt;
    let [forward, starboard, down] = [0, 1, 2].map(|axis| {
        first.scale * tilted[axis] + STEEL_SHARE * first.noise_nt[axis] + new * rng.gaussian()
    });
    let reading = read([forward, starboard], first.given_deg, instruments);
    (reading, down)
}

/// Makes a reading of this field.
pub(crate) fn read(
    field_nt: [f64; 2],
    magnetic_deg: f64,
    instruments: Instruments,
) -> BerthReading {
    let errors = errors(instruments);
    let magnetic = MagneticHeading::new(magnetic_deg).unwrap();
    BerthReading::new(magnetic, field_nt, errors, Alignment::Keel).unwrap()
}

fn errors(instruments: Instruments) -> ReadingErrors {
    ReadingErrors {
        field_sd_nt: instruments.field_sd_nt,
        heading_sd_deg: instruments.heading_sd_deg,
        alignment_sd_deg: instruments.turned_sd_deg,
        tilt_sd_deg: instruments.turned_sd_deg,
    }
}
