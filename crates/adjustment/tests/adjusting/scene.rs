//! One ship at one berth, with all knowledge of it.

use super::knowledge::{
    Berthed, Instruments, REFERENCE_SD_DEG, model_by, reading, reading_on, waters,
};
use super::random::Random;
use super::{Place, Standing, Truth};
use binnacle_adjustment::adjust::{
    Adjustment, Circumstances, EarlierLambda, Limits, VerticalReading, Water,
};
use binnacle_adjustment::binnacle::Binnacle;
use binnacle_compass::model::Model;
use binnacle_compass::time::Timestamp;

/// Standard deviation of a card reading before the bowl is taken out, including friction,
/// degrees.
const CARD_SD_DEG: f64 = 0.4;

/// A random scene.
pub(crate) struct Scene {
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
    /// Compass heading there with the first setting.
    compass_deg: f64,
    scale_sd: f64,
    earlier_lambda: Option<EarlierLambda>,
}

impl Scene {
    /// Makes a ship with a binnacle of one of the shipped designs.
    pub(crate) fn new(seed: u64, which: usize, instruments: Instruments) -> Scene {
        Scene::with_lot(seed, which, instruments, 1.0)
    }

    /// Makes a ship whose magnets all have this share of their stated moment.
    pub(crate) fn with_lot(seed: u64, which: usize, instruments: Instruments, share: f64) -> Scene {
        let mut rng = Random::new(seed);
        let binnacle = super::binnacle(&mut rng, which);
        let mut truth = super::ship(&mut rng, &binnacle);
        truth.fitted.lot_share = share;
        // Small binnacles, without a Flinders bar, stay in one sea.
        let waters = waters(&mut rng, if which == 0 { 1.0 } else { 0.15 });
        let standing = truth.with(&binnacle.setting);
        let reference_deg = REFERENCE_SD_DEG * rng.gaussian();
        let model = model_by(&mut rng, &standing, &waters, reference_deg);
        let place = (waters[0].h_nt, waters[0].z_nt);
        let berthed = reading(&mut rng, &standing, place, instruments);
        // A separate generator keeps everything else unchanged.
        let misread_deg = CARD_SD_DEG * Random::new(!seed).gaussian();
        let compass_deg = standing.compass_deg(place, berthed.magnetic_deg) + misread_deg;
        Scene {
            rng,
            binnacle,
            truth,
            standing,
            waters,
            model,
            reference_deg,
            berthed,
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
                ..Circumstances::default()
            },
            limits: Limits::default(),
        }
    }
}
