//! Comparison of the compass with the field.

use super::super::*;
use super::*;

/// Returns the true compass heading from the ship herself.
fn shown(case: &Case, magnetic_deg: f64) -> f64 {
    let there = effect(&case.binnacle, &case.binnacle.setting).as_ship(BISCAY.h_nt);
    let ship = sum(&case.bare, &there);
    let deviation = ship.deviation_rad(magnetic_deg.to_radians(), BISCAY);
    binnacle_compass::angle::wrap_360(magnetic_deg - deviation.to_degrees())
}

fn planned(case: &Case, compass_deg: f64) -> Outcome {
    let mut adjustment = case.adjustment();
    adjustment.compass_deg = Some(binnacle_compass::angle::wrap_360(compass_deg));
    plan(&adjustment).unwrap()
}

fn says_card(outcome: &Outcome) -> bool {
    let card = |words: &String| words.starts_with("the compass read");
    outcome.notes.iter().any(card)
}

#[test]
fn a_card_that_does_not_follow_the_field_is_named_and_farther_off_refused() {
    for magnetic_deg in [3.0, 40.0, 135.0, 200.0, 290.0] {
        let case = case(magnetic_deg);
        let right_deg = shown(&case, magnetic_deg);
        for off_deg in [-1.0, 0.0, 1.0] {
            let outcome = planned(&case, right_deg + off_deg);
            assert!(!says_card(&outcome), "{magnetic_deg}: {:?}", outcome.notes);
        }
        for off_deg in [-3.5, 3.5] {
            let outcome = planned(&case, right_deg + off_deg);
            assert!(says_card(&outcome), "{magnetic_deg}: {:?}", outcome.notes);
            assert!(!outcome.plans.is_empty());
        }
        for off_deg in [-90.0, -8.5, 8.5, 23.0, 180.0] {
            let outcome = planned(&case, right_deg + off_deg);
            let [refused] = &outcome.refusals[..] else {
                panic!("{magnetic_deg}: {outcome:?}")
            };
            let Refusal::CardDisagrees(card) = refused.refusal else {
                panic!("{}", refused.words)
            };
            assert!((card.implied_deg - right_deg).abs() < 0.01, "{card:?}");
            assert_eq!(refused.cures, [Cure::ReadAgain]);
            assert!(
                refused.words.contains("the lubber line"),
                "{}",
                refused.words
            );
        }
    }
}

#[test]
fn the_models_constant_may_lie_between_card_and_magnetometer() {
    let mut case = case(60.0);
    case.model.constant_deg = 3.5;
    for explained_deg in [0.0, -3.5] {
        let outcome = planned(&case, shown(&case, 60.0) + explained_deg);
        assert!(!outcome.plans.is_empty() && !says_card(&outcome));
    }
    let otherwise = planned(&case, shown(&case, 60.0) + 3.5);
    assert!(!otherwise.plans.is_empty() && says_card(&otherwise));
}

#[test]
fn a_card_is_read_otherwise_once_correctors_were_moved() {
    let case = case(60.0);
    let mut moved = case.binnacle.setting.clone();
    moved.fore_and_aft.clear();
    let mut adjustment = case.adjustment();
    adjustment.now = Some(&moved);
    adjustment.compass_deg = Some(shown(&case, 60.0) + 20.0);
    assert_eq!(adjustment.card(), None);
}
