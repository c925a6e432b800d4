//! Advice on what to sail next, judged by refits of voyages with the watches sailed, and by
//! laws that any advice must keep.

#![allow(clippy::unwrap_used)] // all of this is tests

#[allow(dead_code)]
mod voyages;

use binnacle_analysis::advice::{AdviceError, NOTICEABLE_DEG, Question, advise};
use binnacle_analysis::fit::{Observation, RobustFit, RobustOptions, fit_robust};
use binnacle_compass::angle::{CompassHeading, Deviation};
use binnacle_compass::coverage::{Coverage, coverage};
use binnacle_compass::model::{Model, Parameters, ReferenceGrade};
use binnacle_compass::position::Position;
use binnacle_compass::result::{Band, HeadingRange, NoiseLevels, SailNext};
use binnacle_compass::ship::EarthField;
use nalgebra::{SMatrix, SVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use voyages::{Faults, Truth, Variety, Voyage, dipole, gauss, sail, true_deviation};

const USUAL: NoiseLevels = NoiseLevels {
    white_deg: 0.15,
    schuler_deg: 0.35,
    slow_gyro_deg: 0.3,
    compass_swing_deg: 0.25,
    variation_deg: 0.2,
    drift_nt: 60.0,
    turn_deg: 0.3,
    satellite_deg: 0.2,
    difference_deg: 0.2,
    drift_angle_deg: 0.0,
};
const BISCAY: EarthField = EarthField {
    h_nt: 24_000.0,
    z_nt: 38_500.0,
};
const REFERENCE_SD_DEG: f64 = 0.5;

/// Returns a ship known from the population and `rows` of half a degree in the field given,
/// on headings from north to south by east.
fn known_ship(rng: &mut ChaCha8Rng, rows: u32, earth: EarthField) -> Model {
    let sd = [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008, 3.0];
    let mut information = SMatrix::<f64, 8, 8>::zeros();
    for (j, sd) in sd.iter().enumerate() {
        information[(j, j)] = 1.0 / (sd * sd);
    }
    let parameters = Parameters::from_array(std::array::from_fn(|j| 0.7 * sd[j] * gauss(rng)));
    for _ in 0..rows {
        let compass = rng.random_range(0.0..std::f64::consts::PI);
        let slope = parameters.linearised_at_magnetic(compass, earth).gradient;
        let mut row = SVector::<f64, 8>::from_element(1.0);
        for (by, radians) in row.iter_mut().zip(slope) {
            *by = radians.to_degrees();
        }
        information += row * row.transpose() / 0.25;
    }
    let known = information.cholesky().unwrap().inverse();
    let mut covariance = [[0.0; 8]; 8];
    for (i, line) in covariance.iter_mut().enumerate() {
        for (j, value) in line.iter_mut().enumerate() {
            *value = known[(i, j)];
        }
    }
    covariance[7][7] += REFERENCE_SD_DEG.powi(2);
    Model {
        parameters_over_lambda: parameters,
        constant_deg: 0.3,
        covariance: Some(covariance),
        identifiable: None,
        rms_deg: None,
        samples_used: 0,
        samples_rejected: 0,
        quality: None,
        reference_grade: ReferenceGrade::Heading,
        mean_h_nt: None,
        needles: None,
    }
}

fn ask(model: &Model, here: EarthField) -> Result<SailNext, AdviceError> {
    advise(&Question {
        model,
        noise: &USUAL,
        reference_constant_sd_deg: REFERENCE_SD_DEG,
        gyro_share: 1.0,
        here,
        elsewhere: &[],
        coverage: &Coverage::default(),
    })
}

/// Returns the ship with some of its parameters of opposite sign.
fn turned(model: &Model, signs: [f64; 8]) -> Model {
    let mut turned = model.clone();
    let parameters = model.parameters_over_lambda.to_array();
    turned.parameters_over_lambda =
        Parameters::from_array(std::array::from_fn(|j| signs[j] * parameters[j]));
    turned.constant_deg *= signs[7];
    for (i, line) in turned.covariance.as_mut().unwrap().iter_mut().enumerate() {
        for (j, value) in line.iter_mut().enumerate() {
            *value *= signs[i] * signs[j];
        }
    }
    turned
}

fn assert_same(a: Band, b: Band) {
    assert!((a.rms_deg - b.rms_deg).abs() < 1e-6, "{a:?} {b:?}");
    assert!((a.worst_deg - b.worst_deg).abs() < 1e-6, "{a:?} {b:?}");
}

#[test]
fn no_watch_widens_a_band_or_goes_below_the_references_constant() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let floor = 1.959_964 * REFERENCE_SD_DEG;
    let mut made = 0;
    for rows in (0..300).step_by(3) {
        let next = ask(&known_ship(&mut rng, rows, BISCAY), BISCAY).unwrap();
        assert!((next.floor_deg - floor).abs() < 1e-9);
        let elsewhere = next.elsewhere.unwrap();
        let here = next.here.suggestions.iter();
        let here = here.map(|s| (next.here.band, s.after_one, s.after_three));
        let there = elsewhere.suggestions.iter();
        let there = there.map(|s| (elsewhere.band, s.after_one, s.after_three));
        for (now, one, three) in here.chain(there) {
            made += 1;
            for of in [|b: Band| b.rms_deg, |b: Band| b.worst_deg] {
                assert!(of(now) >= of(one) - 1e-9 && of(one) >= of(three) - 1e-9);
                assert!(of(three) >= floor, "{three:?}");
            }
            assert!(now.rms_deg - three.rms_deg >= NOTICEABLE_DEG);
        }
        let most = next.here.narrows_at_most_deg;
        assert!((next.here.band.rms_deg - most - floor).abs() < 1e-9);
    }
    assert!(made > 100, "{made}");
}

/// A settled ship's band is that of her reference's constant, and azimuths go below it.
#[test]
fn twenty_azimuths_narrow_a_settled_band_of_one_degree_to_about_four_tenths() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let next = ask(&known_ship(&mut rng, 10_000, BISCAY), BISCAY).unwrap();
    let azimuths = next.azimuths.unwrap();
    assert!((azimuths.band.rms_deg - 1.0).abs() < 0.08, "{azimuths:?}");
    assert!(azimuths.after_twenty.rms_deg < 0.45, "{azimuths:?}");
    assert!(azimuths.after_twenty.rms_deg > 0.25, "{azimuths:?}");
    let one = azimuths.after_one.rms_deg;
    assert!(one < azimuths.band.rms_deg && one > azimuths.after_twenty.rms_deg);
}

#[test]
fn the_mirrored_ship_is_given_the_mirrored_headings() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..20 {
        let ship = known_ship(&mut rng, 30, BISCAY);
        let next = ask(&ship, BISCAY).unwrap();
        // Port for starboard: the athwartship field and what couples the axes.
        let mirrored = turned(&ship, [1.0, 1.0, -1.0, -1.0, 1.0, -1.0, -1.0, -1.0]);
        let mirrored = ask(&mirrored, BISCAY).unwrap();
        assert_same(next.here.band, mirrored.here.band);
        assert!(!next.here.suggestions.is_empty());
        let pairs = next.here.suggestions.iter();
        for (a, b) in pairs.zip(&mirrored.here.suggestions) {
            assert_same(a.after_three, b.after_three);
            let across = |degrees: u16| (360 - degrees) % 360;
            assert_eq!(
                across(a.range.heading_from_deg),
                b.range.heading_to_deg % 360
            );
            assert_eq!(across(a.range.heading_to_deg), b.range.heading_from_deg);
        }
    }
}

#[test]
fn the_other_hemisphere_is_the_mirror_image_of_this_one() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let south = EarthField {
        z_nt: -BISCAY.z_nt,
        ..BISCAY
    };
    for _ in 0..20 {
        let ship = known_ship(&mut rng, 200, BISCAY);
        let next = ask(&ship, BISCAY).unwrap();
        let upside_down = turned(&ship, [1.0, -1.0, 1.0, -1.0, 1.0, 1.0, 1.0, 1.0]);
        let there = ask(&upside_down, south).unwrap();
        assert_same(next.here.band, there.here.band);
        let (a, b) = (next.elsewhere.unwrap(), there.elsewhere.unwrap());
        assert_same(a.band, b.band);
        assert!(!a.suggestions.is_empty());
        for (a, b) in a.suggestions.iter().zip(&b.suggestions) {
            assert_same(a.after_three, b.after_three);
            assert_eq!(a.magnetic_latitude_from_deg, -b.magnetic_latitude_to_deg);
            assert_eq!(a.magnetic_latitude_to_deg, -b.magnetic_latitude_from_deg);
            assert_eq!(a.headings, b.headings);
        }
    }
}

#[test]
fn a_ship_of_one_latitude_is_sent_across_the_equator() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let one_sea = known_ship(&mut rng, 500, BISCAY);
    let elsewhere = ask(&one_sea, BISCAY).unwrap().elsewhere.unwrap();
    let best = &elsewhere.suggestions[0];
    assert!(best.magnetic_latitude_from_deg < 0, "{best:?}");
    assert!(best.magnetic_latitude_to_deg < 40, "{best:?}");
    assert!(best.after_three.rms_deg < 0.7 * elsewhere.band.rms_deg);
    assert_eq!(best.headings.len(), 3);

    // The band is narrowed in the waters asked about.
    let cape = EarthField {
        h_nt: 10_500.0,
        z_nt: -23_000.0,
    };
    let asked = advise(&Question {
        model: &one_sea,
        noise: &USUAL,
        reference_constant_sd_deg: REFERENCE_SD_DEG,
        gyro_share: 1.0,
        here: BISCAY,
        elsewhere: &[cape],
        coverage: &Coverage::default(),
    });
    let off_the_cape = asked.unwrap().elsewhere.unwrap();
    assert!(off_the_cape.band.rms_deg > 1.5 * elsewhere.band.rms_deg);
}

#[test]
fn a_fit_that_no_heading_can_improve_is_reported_as_such() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut ship = known_ship(&mut rng, 0, BISCAY);
    for line in ship.covariance.as_mut().unwrap() {
        for value in line {
            *value *= 1e-4;
        }
    }
    ship.covariance.as_mut().unwrap()[7][7] += REFERENCE_SD_DEG.powi(2);
    let next = ask(&ship, BISCAY).unwrap();
    assert!(next.here.suggestions.is_empty());
    assert!(next.elsewhere.unwrap().suggestions.is_empty());
    assert!(next.here.narrows_at_most_deg < NOTICEABLE_DEG);
    assert!((next.here.band.rms_deg - 0.98).abs() < 0.01);
}

#[test]
fn what_cannot_be_advised_is_refused_by_name() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let ship = known_ship(&mut rng, 50, BISCAY);
    let mut silent = ship.clone();
    silent.covariance = None;
    assert_eq!(ask(&silent, BISCAY), Err(AdviceError::NoCovariance));
    for wrong in [f64::NAN, f64::INFINITY, -1.0] {
        let mut broken = ship.clone();
        broken.covariance.as_mut().unwrap()[3][3] = wrong;
        assert_eq!(ask(&broken, BISCAY), Err(AdviceError::NotACovariance));
    }
    for weak in [0.0, 10.0, f64::NAN] {
        let pole = EarthField {
            h_nt: weak,
            z_nt: 60_000.0,
        };
        assert!(matches!(ask(&ship, pole), Err(AdviceError::Deviation(_))));
    }
    let noise = NoiseLevels {
        white_deg: f64::NAN,
        ..USUAL
    };
    let asked = advise(&Question {
        model: &ship,
        noise: &noise,
        reference_constant_sd_deg: REFERENCE_SD_DEG,
        gyro_share: 1.0,
        here: BISCAY,
        elsewhere: &[],
        coverage: &Coverage::default(),
    });
    assert_eq!(asked, Err(AdviceError::NotNoise));
}

/// A voyage in one sea that saw no heading west of south.
struct HalfSeen {
    voyage: Voyage,
    fitted: RobustFit,
}

impl HalfSeen {
    fn sail(seed: u64) -> HalfSeen {
        let mut voyage = sail(seed, Variety::Poor, 20.0, &Faults::USUAL);
        voyage
            .observations
            .retain(|o| (20.0..190.0).contains(&o.compass.degrees()));
        let fitted = fit_robust(&voyage.observations, &RobustOptions::default()).unwrap();
        HalfSeen { voyage, fitted }
    }

    fn here(&self) -> EarthField {
        let Truth { h_nt, z_nt, .. } = self.voyage.truth;
        EarthField { h_nt, z_nt }
    }

    fn advice(&self) -> SailNext {
        let seen = self.voyage.observations.iter();
        advise(&Question {
            model: &self.fitted.model,
            noise: &self.fitted.noise,
            reference_constant_sd_deg: REFERENCE_SD_DEG,
            gyro_share: 1.0,
            here: self.here(),
            elsewhere: &[],
            coverage: &coverage(seen.map(|o| (o.compass, o.h_nt, o.z_nt))),
        })
        .unwrap()
    }

    /// Returns the estimator's own fit after some watches, a day apart, from a week after
    /// the voyage: each a compass heading and a place.
    fn refit(&self, watches: &[(f64, Position)], rng: &mut ChaCha8Rng) -> Model {
        let mut observations = self.voyage.observations.clone();
        let last = *observations.last().unwrap();
        let truth = &self.voyage.truth;
        let wander = truth.gyro_constant_deg + 0.4 * gauss(rng);
        for (day, (compass_deg, place)) in watches.iter().enumerate() {
            let (_, h_nt, z_nt) = dipole(place.lat_deg(), place.lon_deg());
            let deviation = true_deviation(truth, *compass_deg, h_nt, z_nt) + wander;
            for row in 0..24 {
                let seconds = (7.0 + day as f64) * 86_400.0 + 600.0 * f64::from(row);
                observations.push(Observation {
                    time: Some(last.time.unwrap().plus_seconds(seconds)),
                    position: Some(*place),
                    compass: CompassHeading::new(*compass_deg).unwrap(),
                    deviation: Deviation::new(deviation + 0.15 * gauss(rng)).unwrap(),
                    h_nt,
                    z_nt,
                    ..last
                });
            }
        }
        fit_robust(&observations, &RobustOptions::default())
            .unwrap()
            .model
    }

    fn place(&self) -> Position {
        self.voyage.observations.last().unwrap().position.unwrap()
    }
}

fn rms_band(model: &Model, here: EarthField) -> f64 {
    let squares: f64 = (0..24)
        .map(|sector| {
            let compass = CompassHeading::new(15.0 * f64::from(sector) + 7.5).unwrap();
            let band = model.deviation(compass, here).unwrap().band95_deg.unwrap();
            band * band
        })
        .sum();
    (squares / 24.0).sqrt()
}

fn middle(range: HeadingRange) -> f64 {
    f64::from(range.heading_from_deg) + width(range) / 2.0
}

fn width(range: HeadingRange) -> f64 {
    let wide = f64::from(range.heading_to_deg) - f64::from(range.heading_from_deg);
    if wide > 0.0 { wide } else { wide + 360.0 }
}

fn holds(range: HeadingRange, compass_deg: f64) -> bool {
    let past = compass_deg - f64::from(range.heading_from_deg);
    past.rem_euclid(360.0) < width(range)
}

fn mean(list: &[f64]) -> f64 {
    list.iter().sum::<f64>() / list.len() as f64
}

#[test]
fn a_refit_with_the_watch_sailed_narrows_most_where_it_was_advised() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for seed in 6000..6008 {
        let ship = HalfSeen::sail(seed);
        let next = ship.advice();
        let now = rms_band(&ship.fitted.model, ship.here());
        assert!((next.here.band.rms_deg - now).abs() < 1e-9, "the same band");

        let best = &next.here.suggestions[0];
        let narrowed: Vec<f64> = (0..24)
            .map(|sector| {
                let watch = (15.0 * f64::from(sector) + 7.5, ship.place());
                now - rms_band(&ship.refit(&[watch], &mut rng), ship.here())
            })
            .collect();
        let advised = |sector: usize| holds(best.range, 15.0 * sector as f64 + 7.5);
        let top = (0..24).max_by(|&a, &b| narrowed[a].total_cmp(&narrowed[b]));
        assert!(advised(top.unwrap()), "{seed} {best:?} {narrowed:?}");
        let (inside, outside): (Vec<usize>, Vec<usize>) = (0..24).partition(|&s| advised(s));
        let [inside, outside] = [inside, outside].map(|sectors| {
            let narrowed: Vec<f64> = sectors.into_iter().map(|s| narrowed[s]).collect();
            mean(&narrowed)
        });
        assert!(outside < 0.5 * inside, "{seed} {outside} {inside}");
        // Every heading of the range must keep the promise.
        let promised = now - best.after_one.rms_deg;
        let kept = inside / promised;
        assert!((1.0..1.5).contains(&kept), "{seed} {kept}");
    }
}

#[test]
fn a_refit_with_the_visit_made_narrows_the_band_elsewhere() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let far = EarthField {
        h_nt: 22_000.0,
        z_nt: -40_000.0,
    };
    for seed in 6100..6104 {
        let ship = HalfSeen::sail(seed);
        let elsewhere = ship.advice().elsewhere.unwrap();
        let best = &elsewhere.suggestions[0];
        assert!(!(40..60).contains(&best.magnetic_latitude_from_deg));
        let lat = best.magnetic_latitude_from_deg + best.magnetic_latitude_to_deg;
        let visited = Position::new(f64::from(lat) / 2.0, -20.0).unwrap();
        let [there, here] = [visited, ship.place()].map(|place| {
            let headings = best.headings.iter().map(|&range| middle(range));
            let watches: Vec<_> = headings.map(|heading| (heading, place)).collect();
            rms_band(&ship.refit(&watches, &mut rng), far)
        });
        let now = rms_band(&ship.fitted.model, far);
        assert!(
            now - there > 2.0 * (now - here),
            "{seed} {now} {there} {here}"
        );
    }
}
