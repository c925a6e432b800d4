//! Changes of the ship's magnetism since the model that a berth cannot show.

use super::super::*;
use super::*;
use binnacle_compass::time::Timestamp;

/// A berth on this heading of a ship whose permanent field changed along and across the
/// needle, nT, with this error of the heading.
fn changed([along_nt, across_nt]: [f64; 2], heading_sd_deg: f64) -> Case {
    let mut case = case(60.0);
    let [x, y] = case.reading.field_nt();
    let (north, east) = (x / x.hypot(y), y / x.hypot(y));
    let field = [
        x + along_nt * north - across_nt * east,
        y + along_nt * east + across_nt * north,
    ];
    let errors = ReadingErrors {
        heading_sd_deg,
        ..case.reading.errors()
    };
    case.reading =
        BerthReading::new(case.reading.magnetic(), field, errors, Alignment::Keel).unwrap();
    case
}

fn usual(case: &Case) -> Adjustment<'_> {
    Adjustment {
        limits: Limits::default(),
        ..case.adjustment()
    }
}

#[test]
fn no_uncertain_heading_lets_a_ship_pass_that_has_changed_across_the_needle() {
    for across_nt in [-2_600.0, -1_900.0, 1_900.0, 2_600.0] {
        for heading_sd_deg in [2.0, 3.0, 5.0] {
            let case = changed([0.0, across_nt], heading_sd_deg);
            let outcome = plan(&usual(&case)).unwrap();
            assert!(outcome.plans.is_empty(), "{across_nt} {heading_sd_deg}");
            let refused = &outcome.refusals[0];
            let expected = match refused.refusal {
                Refusal::UncheckedBerth { .. } => true,
                Refusal::InconsistentBerth { .. } => heading_sd_deg < 4.0,
                _ => false,
            };
            assert!(expected, "{}", refused.words);
            assert_eq!(refused.cures[0], Cure::ReadAgain);
        }
    }
}

#[test]
fn what_the_check_leaves_open_is_across_the_needle_in_the_model_after() {
    let case = changed([0.0, 1_900.0], 5.0);
    let state = MagneticState::new(&case.adjustment()).unwrap();
    let lambda = state.lambda();
    let [x, y] = case.reading.field_nt();
    let field_nt = x.hypot(y);
    let after = state.model_with(&case.binnacle.setting).unwrap();
    let (old, new) = (case.model.covariance.unwrap(), after.covariance.unwrap());
    let more = |row: usize, column: usize| new[row][column] - old[row][column];
    // Nothing along the needle; across it the angle beyond 2.58° and the heading's error
    // beyond 2°.
    let (north, east) = (x / field_nt, y / field_nt);
    let along = north * north * more(0, 0) + 2.0 * north * east * more(0, 2);
    let along = along + east * east * more(2, 2);
    let across = (more(0, 0) + more(2, 2)).sqrt() * lambda;
    assert!(along.abs() < 1e-6 * across * across, "{along}");
    let angle_deg = state.estimate.consistency.angle_deg;
    let expected_deg = (angle_deg.powi(2) - 2.576_f64.powi(2) + 25.0 - 4.0).sqrt();
    let across_deg = (across / field_nt).to_degrees();
    assert!(
        (across_deg - expected_deg).abs() < 0.01,
        "{across_deg} {expected_deg}"
    );
    // A good berth leaves nothing open.
    let good = changed([0.0, 300.0], 1.0);
    let same = MagneticState::new(&good.adjustment()).unwrap();
    let same = same.model_with(&good.binnacle.setting).unwrap();
    let covariance = same.covariance.unwrap();
    for index in [0, 2] {
        let (is, was) = (covariance[index][index], old[index][index]);
        assert!((is - was).abs() < 1e-9 * was);
    }
}

#[test]
fn a_check_that_shows_little_says_what_it_could_not_have_shown() {
    let notes = |heading_sd_deg: f64| {
        let case = changed([0.0, 0.0], heading_sd_deg);
        case.plan().notes.join("\n")
    };
    assert!(!notes(0.5).contains("could not have shown"));
    let wide = notes(1.9);
    assert!(
        wide.contains("turns the field by less than 5 degrees"),
        "{wide}"
    );
}

fn earlier(case: &Case) -> EarlierLambda {
    let at = Timestamp::parse("2026-05-01T00:00:00Z").unwrap();
    EarlierLambda::from_berth(at, &case.adjustment())
        .unwrap()
        .unwrap()
}

#[test]
fn a_change_along_the_needle_contradicts_an_earlier_lambda() {
    let before = case(200.0);
    let earlier = earlier(&before);
    for along_nt in [-2_500.0, 0.0, 2_500.0] {
        let case = changed([along_nt, 0.0], 0.5);
        let mut adjustment = usual(&case);
        adjustment.limits.residual_deg = 10.0;
        // Nothing else shows it: without an earlier λ the berth is accepted with a note.
        let alone = plan(&adjustment).unwrap();
        assert!(!alone.plans.is_empty(), "{:?}", alone.refusals);
        assert!(alone.notes.iter().any(|n| n.contains("along the needle")));
        adjustment.circumstances.earlier_lambda =
            earlier.adapted_to(&case.binnacle, &before.binnacle.setting);
        let outcome = plan(&adjustment).unwrap();
        if along_nt == 0.0 {
            assert!(!outcome.plans.is_empty(), "{:?}", outcome.refusals);
            continue;
        }
        let refused = &outcome.refusals[0];
        let Refusal::OtherLambda {
            along_nt: found, ..
        } = refused.refusal
        else {
            panic!("{}", refused.words);
        };
        assert!((found - 2_500.0).abs() < 100.0, "{found}");
        assert!(
            refused.words.contains("berth of 2026-05-01"),
            "{}",
            refused.words
        );
    }
}

/// Spheres add to λ: an earlier λ with other spheres is converted before the comparison.
#[test]
fn an_earlier_lambda_follows_the_spheres() {
    let now = case(60.0);
    let mut form: BinnacleForm = now.binnacle.clone().into();
    form.setting.quadrantal.as_mut().unwrap().mark_mm -= 40.0;
    let before = Case::new(bare(), form.try_into().unwrap(), 200.0);
    let original = earlier(&before);
    let carried = original
        .adapted_to(&now.binnacle, &before.binnacle.setting)
        .unwrap();
    let lambda = MagneticState::new(&now.adjustment()).unwrap().lambda();
    assert!(
        (original.lambda - lambda).abs() > 0.01,
        "{}",
        original.lambda
    );
    assert!(
        (carried.lambda - lambda).abs() < 1e-3,
        "{} {lambda}",
        carried.lambda
    );
    assert!(carried.standard_error > original.standard_error);
}

/// bx and by drift by 60 nT in thirty days, in any direction.
#[test]
fn an_older_model_has_a_wider_band() {
    let case = case(60.0);
    let widest = |days: f64| {
        let mut adjustment = case.adjustment();
        adjustment.circumstances.model_age_days = Some(days);
        plan(&adjustment).unwrap().plans[0].widest_band_deg
    };
    let (fresh, old) = (widest(0.0), widest(60.0));
    assert!(old > fresh + 0.1 && old < fresh + 0.3, "{fresh} {old}");
}
