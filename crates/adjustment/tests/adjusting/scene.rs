//! One ship at one berth, with all knowledge of it.

use super::knowledge::{
    Berthed, Instruments, REFERENCE_SD_DEG, model_by, reading, reading_on, waters,
};
use super::random::Random;
use super::{Place, Standing, Truth};
use binnacle_adjustment::adjust::{
    Adjustment, Circumstances, EarlierLambda, Limits, VerticalReading, Water,
};
use binnacle_adjustment::berth::BerthReading;
use binnacle_adjustment::binnacle::{Axis, Binnacle, Setting, Tray};
use binnacle_compass::model::Model;
use binnacle_compass::time::Timestamp;

/// Standard deviation of a card reading before the bowl is taken out, including friction,
/// degrees.
const CARD_SD_DEG: f64 = 0.4;

/// Facts that the planner does not know, and whether a second heading was read.
#[allow(clippy::struct_excessive_bools)] // one for each fact, by name
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hidden {
    /// Share of their stated moment that all magnets have.
    pub(crate) lot_share: f64,
    /// The model was fitted in other waters than the plan's.
    pub(crate) model_from_elsewhere: bool,
    /// The model does not say in which waters it was fitted.
    pub(crate) model_without_waters: bool,
    /// Field of steel on the quay in some direction, nT.
    pub(crate) steel_nt: f64,
    /// Error of the given heading, degrees.
    pub(crate) heading_off_deg: f64,
    /// One tray of magnets has the wrong red end in the inventory.
    pub(crate) wrong_end: bool,
    /// The ship was shifted to another heading and read there too.
    pub(crate) is_shifted: bool,
}

/// Nothing is hidden from the planner.
pub(crate) const ALL_KNOWN: Hidden = Hidden {
    lot_share: 1.0,
    model_from_elsewhere: false,
    model_without_waters: false,
    steel_nt: 0.0,
    heading_off_deg: 0.0,
    wrong_end: false,
    is_shifted: false,
};

/// A random scene.
pub(crate) struct Scene {
    pub(crate) seed: u64,
    pub(crate) rng: Random,
    pub(crate) binnacle: Binnacle,
    pub(crate) truth: Truth,
    /// The ship as it came to the berth.
    pub(crate) standing: Standing,
    pub(crate) waters: Vec<Water>,
    pub(crate) model: Model,
    /// Error of the model's reference.
    pub(crate) reference_deg: f64,
    pub(crate) berthed: Berthed,
    /// The tray with the wrong end in the inventory: its axis, as written, and as it is.
    pub(crate) misrecorded: Option<(Axis, Tray, Tray)>,
    /// Reading on another heading of the berth.
    shifted: Option<BerthReading>,
    /// Field of steel on the quay in ship axes, nT.
    steel_nt: [f64; 2],
    /// Compass heading there with the first setting.
    compass_deg: f64,
    scale_sd: f64,
    earlier_lambda: Option<EarlierLambda>,
}

impl Scene {
    /// Makes a ship with a binnacle of one of the shipped designs.
    pub(crate) fn new(seed: u64, which: usize, instruments: Instruments) -> Scene {
        Scene::with(seed, which, instruments, ALL_KNOWN)
    }

    /// Makes a ship of which the planner does not know everything.
    pub(crate) fn with(seed: u64, which: usize, instruments: Instruments, hidden: Hidden) -> Scene {
        let mut rng = Random::new(seed);
        // A separate generator keeps everything else unchanged.
        let mut hidden_rng = Random::new(seed ^ 0x5eed);
        let binnacle = super::binnacle(&mut rng, which);
        let mut truth = super::ship(&mut rng, &binnacle);
        truth.fitted.lot_share = hidden.lot_share;
        // Small binnacles, without a Flinders bar, stay in one sea.
        let waters = waters(&mut rng, if which == 0 { 1.0 } else { 0.15 });
        let standing = truth.with(&binnacle.setting);
        let reference_deg = REFERENCE_SD_DEG * rng.gaussian();
        let fitted_in = if hidden.model_from_elsewhere {
            super::knowledge::waters(&mut hidden_rng, if which == 0 { 1.0 } else { 0.15 })
        } else {
            waters.clone()
        };
        let mut model = model_by(&mut rng, &standing, &fitted_in, reference_deg);
        if hidden.model_without_waters {
            model.mean_h_nt = None;
        }
        let (sin, cos) = hidden_rng.between(0.0, std::f64::consts::TAU).sin_cos();
        let steel_nt = [cos, sin].map(|part| hidden.steel_nt * part);
        let standing = standing.beside(steel_nt);
        let place = (waters[0].h_nt, waters[0].z_nt);
        let berthed = reading(&mut rng, &standing, place, instruments);
        let shifted = hidden.is_shifted.then(|| {
            let heading = berthed.magnetic_deg + hidden_rng.between(80.0, 280.0);
            // She lies otherwise to the steel there.
            let quay_nt = {
                let (sin, cos) = hidden_rng.between(0.0, std::f64::consts::TAU).sin_cos();
                let size_nt = hidden.steel_nt * hidden_rng.unit();
                [cos * size_nt, sin * size_nt]
            };
            let there = truth.with(&binnacle.setting).beside(quay_nt);
            reading_on(&mut hidden_rng, &there, place, heading, instruments).reading
        });
        let side = if hidden_rng.unit() < 0.5 { -1.0 } else { 1.0 };
        let berthed = berthed.misheaded(side * hidden.heading_off_deg, instruments);
        let (binnacle, misrecorded) = if hidden.wrong_end {
            misrecord(&mut hidden_rng, binnacle)
        } else {
            (binnacle, None)
        };
        let misread_deg = CARD_SD_DEG * Random::new(!seed).gaussian();
        let compass_deg = standing.compass_deg(place, berthed.magnetic_deg) + misread_deg;
        Scene {
            seed,
            rng,
            binnacle,
            truth,
            standing,
            waters,
            model,
            reference_deg,
            berthed,
            misrecorded,
            shifted,
            steel_nt,
            compass_deg: compass_deg.rem_euclid(360.0),
            scale_sd: instruments.scale_sd,
            earlier_lambda: None,
        }
    }

    /// Changes the permanent field since the model, along the needle and across it, nT, and
    /// reads the berth again, with other stated errors.
    pub(crate) fn changed(
        mut self,
        [along_nt, across_nt]: [f64; 2],
        instruments: Instruments,
        said: Instruments,
    ) -> Scene {
        let (place, magnetic_deg) = (self.place(), self.berthed.magnetic_deg);
        let [x, y, _] = self.standing.field(place, magnetic_deg);
        let (north, east) = (x / x.hypot(y), y / x.hypot(y));
        self.truth.bare_b_nt[0] += along_nt * north - across_nt * east;
        self.truth.bare_b_nt[1] += along_nt * east + across_nt * north;
        self.standing = self.truth.with(&self.binnacle.setting);
        let (rng, standing) = (&mut self.rng, &self.standing);
        let berthed = reading_on(rng, standing, place, magnetic_deg, instruments);
        self.berthed = berthed.said_by(said);
        self.compass_deg = (standing.compass_deg(place, magnetic_deg)
            + CARD_SD_DEG * rng.gaussian())
        .rem_euclid(360.0);
        self
    }

    /// Adds λ of an earlier berth with this standard error.
    pub(crate) fn add_earlier_lambda(&mut self, standard_error: f64) {
        self.earlier_lambda = Some(EarlierLambda {
            at: Timestamp::parse("2026-05-01T00:00:00Z").unwrap(),
            lambda: self.standing.lambda() + standard_error * self.rng.gaussian(),
            standard_error,
        });
    }

    /// The ship at the berth with a setting of the correctors.
    pub(crate) fn at_berth(&self, setting: &Setting) -> Standing {
        self.truth.with(setting).beside(self.steel_nt)
    }

    /// The setting as it is, where the inventory says this one.
    pub(crate) fn truly(&self, written: &Setting) -> Setting {
        let mut truly = written.clone();
        if let Some((axis, wrong, right)) = &self.misrecorded {
            for tray in truly.trays_mut(*axis).iter_mut().filter(|t| *t == wrong) {
                tray.clone_from(right);
            }
        }
        truly
    }

    /// Field at the berth.
    pub(crate) fn place(&self) -> Place {
        (self.waters[0].h_nt, self.waters[0].z_nt)
    }

    /// Input of the planner.
    pub(crate) fn adjustment(&self) -> Adjustment<'_> {
        Adjustment {
            model: &self.model,
            earth: self.waters[0].earth(),
            reading: &self.berthed.reading,
            scale_sd: self.scale_sd,
            compass_deg: Some(self.compass_deg),
            vertical: Some(VerticalReading {
                down_nt: self.berthed.down_nt,
            }),
            binnacle: &self.binnacle,
            now: None,
            waters: &self.waters,
            circumstances: Circumstances {
                earlier_lambda: self.earlier_lambda,
                shifted: self.shifted,
                ..Circumstances::default()
            },
            limits: Limits::default(),
        }
    }
}

/// Writes one tray of the binnacle's magnets with the wrong red end.
fn misrecord(rng: &mut Random, binnacle: Binnacle) -> (Binnacle, Option<(Axis, Tray, Tray)>) {
    let mut setting = binnacle.setting.clone();
    let axis = Axis::BOTH[rng.below(2)];
    let Some(tray) = setting.trays_mut(axis).first_mut() else {
        return (binnacle, None);
    };
    let right = tray.clone();
    tray.red = tray.red.reversed();
    let wrong = tray.clone();
    (
        binnacle.with_setting(setting).unwrap(),
        Some((axis, wrong, right)),
    )
}
