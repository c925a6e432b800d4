//! The fleet's prior: honest, exact when one vessel is left out, and the same to the byte.

mod trial;
mod world;

use binnacle_analysis::fleet_prior::{Class, FleetPrior, FleetPriorError, ShipEvidence, ShipPrior};
use nalgebra::SMatrix;
use trial::{evidence, fleet, sisters, trial, when};
use world::{Dice, FAR, MEDITERRANEAN, Mixture, Normal, Voyage, any_ship, known_by_now};

#[test]
fn a_class_much_alike_narrows_the_band_far_away_and_stays_honest() {
    let trial = trial(150, 10, 0.3);
    let like = &trial.like;
    // Of 150 ships 93 % within two standard errors.
    assert!(like.class_region > 0.89, "{}", like.class_region);
    assert!(like.region > 0.93, "{}", like.region);
    assert!(like.near > 0.93, "{}", like.near);
    assert!(like.far > 0.93, "{}", like.far);
    let gain = like.far_width / like.far_width_alone;
    assert!(gain < 0.9, "{gain}");
    let unlike = &trial.unlike;
    assert!(unlike.near > 0.93, "{}", unlike.near);
    assert!(unlike.far > unlike.far_alone - 0.02, "{}", unlike.far);
}

#[test]
fn a_class_spread_as_the_population_takes_nothing_from_the_band() {
    let trial = trial(80, 10, 1.0);
    let gain = trial.like.far_width / trial.like.far_width_alone;
    assert!((0.95..1.1).contains(&gain), "{gain}");
    assert!(trial.like.far > 0.93, "{}", trial.like.far);
}

#[test]
fn two_sisters_narrow_the_band_less_than_twenty() {
    let width = |sisters| trial(40, sisters, 0.3).like.far_width;
    assert!(width(2) > 1.15 * width(20));
}

#[test]
fn permanent_parts_that_spread_keep_their_width_where_induced_ones_agree() {
    let prior = fleet(20, 0.1, &mut Dice::new(3)).prior;
    let prior = prior.prior_for("unlike").unwrap();
    let share = |j: usize| {
        let like = prior.components[0].covariance[j][j];
        like / prior.components[1].covariance[j][j]
    };
    assert!(
        share(0) > 0.5 && share(2) > 0.5,
        "{} {}",
        share(0),
        share(2)
    );
    assert!(
        share(1) < 0.1 && share(4) < 0.1,
        "{} {}",
        share(1),
        share(4)
    );
}

#[test]
fn the_prior_of_a_vessel_is_as_though_it_had_never_been_in_the_class() {
    let all = fleet(5, 0.3, &mut Dice::new(7)).prior;
    let others: Vec<ShipEvidence> = without(&all, "like");
    let never = FleetPrior::new(sisters(), others, when()).unwrap();
    let left_out = all.prior_for("like").unwrap();
    assert_eq!(text(&left_out), text(&never.prior_for("like").unwrap()));
    assert_eq!(text(&all.without("like").unwrap()), text(&never));
    let basis = left_out.basis.unwrap();
    assert!(basis.ships.iter().all(|ship| ship.vessel != "like"));
    assert_eq!(basis.ships.len(), 6);
}

#[test]
fn the_order_of_the_vessels_changes_no_byte() {
    let fleet = fleet(6, 0.3, &mut Dice::new(8)).prior;
    let mut ships = fleet.ships().to_vec();
    ships.reverse();
    ships.swap(1, 4);
    let other = FleetPrior::new(sisters(), ships, when()).unwrap();
    assert_eq!(text(&fleet), text(&other));
    assert_eq!(
        text(&fleet.prior_for("new").unwrap()),
        text(&other.prior_for("new").unwrap())
    );
}

#[test]
fn written_and_read_again_an_artefact_gives_the_same_priors() {
    for seed in 0..20 {
        let fleet = fleet(4, 0.3, &mut Dice::new(seed)).prior;
        let read: FleetPrior = serde_json::from_str(&text(&fleet)).unwrap();
        assert_eq!(read, fleet);
        let prior = fleet.prior_for("like").unwrap();
        assert_eq!(text(&read.prior_for("like").unwrap()), text(&prior));
        let prior_read: ShipPrior = serde_json::from_str(&text(&prior)).unwrap();
        assert_eq!(prior_read, prior);
    }
}

#[test]
fn weights_add_up_to_one_and_covariances_are_positive_definite() {
    for seed in 0..40 {
        let fleet = fleet(2 + seed as usize % 5, 0.3, &mut Dice::new(seed)).prior;
        let prior = fleet.prior_for("new").unwrap();
        let sum: f64 = prior.components.iter().map(|c| c.weight).sum();
        assert!((sum - 1.0).abs() < 1e-12);
        for component in &prior.components {
            let normal = Normal::of(&component.mean, &component.covariance);
            assert!(normal.covariance.cholesky().is_some());
        }
    }
}

#[test]
fn a_sister_fleet_of_one_is_named_and_refused() {
    let dice = &mut Dice::new(1);
    let known = known_by_now(&any_ship(dice), dice);
    let one = FleetPrior::new(sisters(), vec![evidence("a", &known)], when()).unwrap_err();
    assert_eq!(
        one,
        FleetPriorError::TooFewShips {
            class: sisters(),
            ships: 1
        }
    );
    assert!(
        one.to_string().contains("sister class \"Alpha\" has 1"),
        "{one}"
    );
    // Of two, each has but one sister; a third vessel has two.
    let pair = vec![evidence("a", &known), evidence("b", &known)];
    let pair = FleetPrior::new(Class::Operator("o".into()), pair, when()).unwrap();
    assert!(matches!(
        pair.prior_for("a"),
        Err(FleetPriorError::TooFewShips { ships: 1, .. })
    ));
    assert!(pair.prior_for("c").is_ok());
    assert_eq!(ShipPrior::population().components.len(), 1);
}

#[test]
fn a_vessel_counts_once_and_only_with_what_its_headings_say() {
    let dice = &mut Dice::new(2);
    let known = known_by_now(&any_ship(dice), dice);
    let twice = vec![
        evidence("a", &known),
        evidence("b", &known),
        evidence("a", &known),
    ];
    let refused = FleetPrior::new(sisters(), twice, when()).unwrap_err();
    assert!(matches!(refused, FleetPriorError::SameShipTwice { vessel, .. } if vessel == "a"));

    let population = &ShipPrior::population().components[0];
    let of = |model| ShipEvidence::new("a", "hash", &model, population).unwrap_err();
    let nothing = of(Normal::population().model());
    assert_eq!(
        nothing,
        FleetPriorError::NothingLearnt { vessel: "a".into() }
    );
    let mut bare = known.model();
    bare.covariance = None;
    assert_eq!(
        of(bare),
        FleetPriorError::NoCovariance { vessel: "a".into() }
    );
    let mut senseless = known.model();
    senseless.covariance.as_mut().unwrap()[2][2] = f64::NAN;
    assert_eq!(
        of(senseless),
        FleetPriorError::NoCovariance { vessel: "a".into() }
    );
}

#[test]
fn the_evidence_is_without_the_prior_of_the_fit() {
    let dice = &mut Dice::new(5);
    let voyage = Voyage::sail(&any_ship(dice), &[MEDITERRANEAN, FAR], 24, 0.5, dice);
    let class = &fleet(10, 0.3, dice)
        .prior
        .prior_for("new")
        .unwrap()
        .components[0];
    let population = &ShipPrior::population().components[0];
    let by = |prior: &binnacle_analysis::fleet_prior::PriorComponent| {
        let normal = Normal::of(&prior.mean, &prior.covariance);
        let model = voyage.posterior(&normal).0.model();
        ShipEvidence::new("a", "hash", &model, prior).unwrap()
    };
    let (by_class, by_population) = (information(&by(class)), information(&by(population)));
    for (one, other) in by_class.iter().zip(&by_population) {
        assert!(
            (one - other).abs() < 1e-3 * (1.0 + other.abs()),
            "{one} {other}"
        );
    }
}

#[test]
fn a_mixtures_bound_knows_at_least_as_much_as_each_hypothesis() {
    let population = ShipPrior::population();
    assert_eq!(population.bound().unwrap(), population.components[0]);
    for seed in 0..20 {
        let fleet = fleet(2 + seed as usize % 9, 0.5, &mut Dice::new(seed)).prior;
        let prior = fleet.prior_for("new").unwrap();
        let bound = prior.bound().unwrap();
        let bound = Normal::of(&bound.mean, &bound.covariance).covariance;
        for component in &prior.components {
            let wider = Normal::of(&component.mean, &component.covariance).covariance - &bound;
            let least = wider.symmetric_eigenvalues().min();
            assert!(least > -1e-4, "{least}");
        }
    }
    let none = ShipPrior {
        basis: None,
        components: Vec::new(),
    };
    assert_eq!(none.bound(), Err(FleetPriorError::NoHypothesis));
}

#[test]
fn evidence_beyond_the_bound_counts_no_prior_again() {
    let dice = &mut Dice::new(11);
    for _ in 0..20 {
        let prior = fleet(6, 0.3, dice).prior.prior_for("new").unwrap();
        let voyage = Voyage::sail(&any_ship(dice), &[MEDITERRANEAN, FAR], 24, 0.5, dice);
        let by = |prior: &ShipPrior| {
            let each = prior.components.iter();
            let each = each.map(|c| (c.weight, Normal::of(&c.mean, &c.covariance)));
            let model = Mixture(each.collect()).after(&voyage).matched().model();
            ShipEvidence::new("a", "hash", &model, &prior.bound().unwrap()).unwrap()
        };
        let alone = by(&ShipPrior::population());
        let more = information(&alone) - information(&by(&prior));
        let least = more.symmetric_eigenvalues().min();
        let most = information(&alone).symmetric_eigenvalues().max();
        assert!(least > -0.02 * most, "{least} {most}");
    }
}

#[test]
fn an_artefact_of_another_method_or_of_senseless_numbers_is_refused() {
    let fleet = fleet(3, 0.3, &mut Dice::new(9)).prior;
    let mut json = serde_json::to_value(&fleet).unwrap();
    json["method"] = 99.into();
    let other = serde_json::from_value::<FleetPrior>(json).unwrap_err();
    assert!(other.to_string().contains("method 99"), "{other}");
    let mut json = serde_json::to_value(&fleet).unwrap();
    json["ships"][0]["information"][0][0] = (-5.0).into();
    assert!(serde_json::from_value::<FleetPrior>(json).is_err());
}

fn without(fleet: &FleetPrior, vessel: &str) -> Vec<ShipEvidence> {
    let ships = fleet.ships().iter();
    ships
        .filter(|ship| ship.vessel() != vessel)
        .cloned()
        .collect()
}

fn information(ship: &ShipEvidence) -> SMatrix<f64, 7, 7> {
    let json = serde_json::to_value(ship).expect("JSON");
    let rows: [[f64; 7]; 7] = serde_json::from_value(json["information"].clone()).expect("numbers");
    SMatrix::from_fn(|i, j| rows[i][j])
}

fn text<T: serde::Serialize>(value: &T) -> String {
    serde_json::to_string(value).expect("JSON")
}
