//! One class, its fleet's prior, and new ships that meet it: one like the class, one unlike.

use crate::world::{
    Band, Dice, FAR, MEDITERRANEAN, Mixture, Normal, ShipClass, Truth, Voyage, any_ship,
    known_by_now,
};
use binnacle_analysis::fleet_prior::{Class, FleetPrior, ShipEvidence, ShipPrior};
use binnacle_compass::time::Timestamp;

pub(crate) fn when() -> Timestamp {
    Timestamp::parse("2026-11-01T00:00:00Z").expect("a time")
}

pub(crate) fn sisters() -> Class {
    Class::Sisters("Alpha".into())
}

pub(crate) fn evidence(vessel: &str, posterior: &Normal) -> ShipEvidence {
    let population = &ShipPrior::population().components[0];
    ShipEvidence::new(vessel, "a hash", &posterior.model(), population).expect("evidence")
}

/// The fleet's prior of so many like sisters, a newcomer like them, and a ship unlike them;
/// the latter two as "like" and "unlike".
pub(crate) struct Fleet {
    pub(crate) like: Truth,
    pub(crate) unlike: Truth,
    pub(crate) prior: FleetPrior,
}

pub(crate) fn fleet(sisters_known: usize, induced: f64, dice: &mut Dice) -> Fleet {
    let class = ShipClass::new(induced, dice);
    let mut ships = Vec::new();
    for i in 0..sisters_known {
        let truth = class.ship(dice);
        ships.push(evidence(&format!("{i}"), &known_by_now(&truth, dice)));
    }
    let (like, unlike) = (class.ship(dice), any_ship(dice));
    ships.push(evidence("like", &known_by_now(&like, dice)));
    ships.push(evidence("unlike", &known_by_now(&unlike, dice)));
    Fleet {
        like,
        unlike,
        prior: FleetPrior::new(sisters(), ships, when()).expect("a fleet"),
    }
}

pub(crate) fn mixture(prior: &ShipPrior) -> Mixture {
    let each = prior.components.iter();
    Mixture(
        each.map(|c| (c.weight, Normal::of(&c.mean, &c.covariance)))
            .collect(),
    )
}

/// Sums over ships: shares after [`Tally::mean`].
#[derive(Default)]
pub(crate) struct Tally {
    ships: f64,
    pub(crate) class_region: f64,
    pub(crate) region: f64,
    pub(crate) near: f64,
    pub(crate) far: f64,
    pub(crate) far_width: f64,
    pub(crate) far_width_alone: f64,
    pub(crate) far_alone: f64,
}

impl Tally {
    /// Adds a ship after a short voyage in one sea.
    pub(crate) fn add(&mut self, truth: &Truth, prior: &ShipPrior, dice: &mut Dice) {
        let prior = mixture(prior);
        let voyage = Voyage::sail(truth, &[MEDITERRANEAN], 24, 0.6, dice);
        let (posterior, alone) = (
            prior.after(&voyage),
            mixture(&ShipPrior::population()).after(&voyage),
        );
        let Band { held, width } = posterior.band(truth, FAR);
        self.ships += 1.0;
        self.region += f64::from(u8::from(prior.region_holds(truth, dice)));
        self.class_region += f64::from(u8::from(prior.class_region_holds(truth)));
        self.near += posterior.band(truth, MEDITERRANEAN).held;
        self.far += held;
        self.far_width += width;
        let alone = alone.band(truth, FAR);
        self.far_width_alone += alone.width;
        self.far_alone += alone.held;
    }

    pub(crate) fn mean(&self) -> Tally {
        let n = self.ships;
        Tally {
            ships: n,
            class_region: self.class_region / n,
            region: self.region / n,
            near: self.near / n,
            far: self.far / n,
            far_width: self.far_width / n,
            far_width_alone: self.far_width_alone / n,
            far_alone: self.far_alone / n,
        }
    }
}

/// A newcomer like its class, and one unlike it, over `fleets` fleets.
pub(crate) struct Trial {
    pub(crate) like: Tally,
    pub(crate) unlike: Tally,
}

pub(crate) fn trial(fleets: u64, sisters_known: usize, induced: f64) -> Trial {
    let (mut like, mut unlike) = (Tally::default(), Tally::default());
    for seed in 0..fleets {
        let dice = &mut Dice::new(seed);
        let fleet = fleet(sisters_known, induced, dice);
        let for_ship = |vessel| fleet.prior.prior_for(vessel).expect("a prior");
        like.add(&fleet.like, &for_ship("like"), dice);
        unlike.add(&fleet.unlike, &for_ship("unlike"), dice);
    }
    Trial {
        like: like.mean(),
        unlike: unlike.mean(),
    }
}
