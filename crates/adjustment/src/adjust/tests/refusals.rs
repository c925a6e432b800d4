//! Refusals and invalid input.

use super::super::*;
use super::*;

fn refusal_of(change: impl FnOnce(&mut Adjustment<'_>)) -> Refused {
    let case = case(60.0);
    let mut adjustment = case.adjustment();
    adjustment.limits = Limits::default();
    change(&mut adjustment);
    let outcome = plan(&adjustment).unwrap();
    assert!(outcome.plans.is_empty(), "a refused plan is not given");
    outcome.refusals.into_iter().next().unwrap()
}

#[test]
fn what_is_refused_says_why_and_what_would_cure_it() {
    let refused = refusal_of(|a| a.circumstances.cargo_on_board = true);
    assert_eq!(refused.refusal, Refusal::CargoOnBoard);
    assert_eq!(refused.cures[0], Cure::AfterDischarge);
    let refused = refusal_of(|a| a.circumstances.model_age_days = Some(400.0));
    assert!(refused.words.contains("400 days old"), "{}", refused.words);
    assert_eq!(refused.cures[0], Cure::HeadingsAtSea);
    let refused = refusal_of(|a| a.limits.band_deg = 0.2);
    assert!(matches!(refused.refusal, Refusal::BandTooWide { .. }));
    // The residual is mostly the model's constant, which no corrector cures.
    let refused = refusal_of(|a| a.limits.residual_deg = 0.5);
    assert!(
        matches!(refused.refusal, Refusal::ResidualTooLarge { .. }),
        "{}",
        refused.words
    );
    assert_eq!(refused.cures[0], Cure::Alignment);
}

#[test]
fn a_lubber_line_is_no_matter_for_more_magnets() {
    let mut case = case(60.0);
    case.model.constant_deg = 4.0;
    let mut adjustment = case.adjustment();
    adjustment.limits = Limits::default();
    let refused = plan(&adjustment).unwrap().refusals.remove(0);
    assert!(refused.words.contains("alignment"), "{}", refused.words);
    assert_eq!(refused.cures[0], Cure::Alignment);
    assert!(!refused.cures.contains(&Cure::OtherCorrectors));
}

#[test]
fn a_model_without_covariance_is_refused() {
    let mut case = case(60.0);
    case.model.covariance = None;
    let outcome = case.plan();
    assert_eq!(outcome.refusals[0].refusal, Refusal::NoCovariance);
}

#[test]
fn where_spheres_must_move_and_lambda_is_poor_the_magnetometer_is_named() {
    let mut ship = bare();
    ship.chi[1][1] = -0.30;
    (ship.b_nt[0], ship.b_nt[1]) = (4_500.0, -3_500.0);
    let case = Case::new(ship, class_a(), 60.0);
    let mut adjustment = case.adjustment();
    adjustment.scale_sd = 0.15;
    adjustment.limits = Limits::default();
    let outcome = plan(&adjustment).unwrap();
    let refused = &outcome.refusals[0];
    assert!(
        matches!(refused.refusal, Refusal::MagnetometerTooPoor { .. }),
        "{}",
        refused.words
    );
    assert_eq!(refused.cures[0], Cure::BetterMagnetometer);
    assert!(refused.cures.contains(&Cure::ReadAgain));
    // Correctors on board would suffice, so none are asked for.
    assert_eq!(outcome.refusals.len(), 1, "{:?}", outcome.refusals);
}

/// Without a cliff at any error of λ: they move as long as they gain more than they widen the
/// band, and not where little D is left to gain.
#[test]
fn spheres_move_where_they_gain_more_than_they_widen_the_band() {
    let binnacle = class_a();
    let of_spheres = effect(&binnacle, &binnacle.setting).chi_at(BISCAY.h_nt);
    let moves = |left_d: f64, scale_sd: f64| {
        let mut ship = bare();
        let there = of_spheres[0][0] - of_spheres[1][1];
        ship.chi[1][1] = ship.chi[0][0] + there - 2.0 * left_d;
        let case = Case::new(ship, binnacle.clone(), 60.0);
        let mut adjustment = case.adjustment();
        adjustment.scale_sd = scale_sd;
        (adjustment.limits.residual_deg, adjustment.limits.band_deg) = (20.0, 20.0);
        let outcome = plan(&adjustment).unwrap();
        outcome.plans[0].setting.quadrantal != case.binnacle.setting.quadrantal
    };
    for scale_sd in [0.029, 0.031, 0.1] {
        assert!(moves(0.06, scale_sd), "{scale_sd}");
    }
    assert!(!moves(0.002, 0.1));
}

#[test]
fn a_bar_is_left_alone_where_the_data_do_not_tell_chi13() {
    let mut case = case(60.0);
    case.model.identifiable = Some(Identifiable {
        bx_nt: false,
        chi13: false,
        by_nt: true,
        chi23: true,
        chi11_minus_chi22: true,
        chi12: false,
        chi21: false,
        constant_deg: false,
    });
    let outcome = case.plan();
    for plan in &outcome.plans {
        assert_eq!(plan.setting.flinders, case.binnacle.setting.flinders);
    }
}

#[test]
fn mistakes_at_the_berth_are_named() {
    let case = case(60.0);
    let [x, y] = case.reading.field_nt();
    for (heading, field, misreading) in [
        (60.0, [x / 1e5, y / 1e5], Misreading::Gauss),
        (60.0, [x / 1e3, y / 1e3], Misreading::Microtesla),
        (60.0, [y, x], Misreading::SwappedAxes),
        (60.0, [x, -y], Misreading::StarboardReversed),
        (60.0, [-x, y], Misreading::ForwardReversed),
        (240.0, [x, y], Misreading::HeadingReversed),
    ] {
        let found = find_misreadings(
            &case.model,
            BISCAY,
            MagneticHeading::new(heading).unwrap(),
            field,
            Unit::Nanotesla,
            case.reading.errors(),
            Alignment::Keel,
        );
        assert_eq!(found, [misreading], "{misreading}");
    }
    let right = find_misreadings(
        &case.model,
        BISCAY,
        case.reading.magnetic(),
        [x, y],
        Unit::Nanotesla,
        case.reading.errors(),
        Alignment::Keel,
    );
    assert_eq!(right, []);
    let mut wrong = case;
    let heading = MagneticHeading::new(240.0).unwrap();
    let errors = wrong.reading.errors();
    wrong.reading = BerthReading::new(heading, [x, y], errors, Alignment::Keel).unwrap();
    let outcome = wrong.plan();
    let words = &outcome.refusals[0].words;
    assert!(words.contains("the heading is 180 degrees off"), "{words}");
}

#[test]
fn what_cannot_be_is_named() {
    let case = case(60.0);
    let named = |change: &dyn Fn(&mut Adjustment<'_>)| {
        let mut adjustment = case.adjustment();
        change(&mut adjustment);
        plan(&adjustment).unwrap_err().to_string()
    };
    assert!(named(&|a| a.waters = &[]).starts_with("waters: at least one"));
    assert!(named(&|a| a.scale_sd = -1.0).starts_with("scale_sd is -1"));
    assert!(named(&|a| a.compass_deg = Some(f64::NAN)).starts_with("compass_deg is NaN"));
    let error = named(&|a| a.vertical = Some(VerticalReading { down_nt: 1e9 }));
    assert!(error.starts_with("down_nt is"), "{error}");
    let weak = [water("pole", 900.0, 55_000.0, 1.0)];
    let mut adjustment = case.adjustment();
    adjustment.waters = &weak;
    let error = plan(&adjustment).unwrap_err().to_string();
    assert!(error.starts_with("waters[0].h_nt is 900"), "{error}");
}

#[test]
fn a_lambda_that_is_not_usual_is_named_and_one_that_is_no_compass_s_refused() {
    let case = case(60.0);
    let found = |times: f64| {
        let [x, y] = case.reading.field_nt();
        let field_nt = [x * times, y * times];
        let (errors, heading) = (case.reading.errors(), case.reading.magnetic());
        let reading = BerthReading::new(heading, field_nt, errors, Alignment::Keel).unwrap();
        let mut adjustment = case.adjustment();
        adjustment.reading = &reading;
        plan(&adjustment).unwrap()
    };
    let is_named = |outcome: &Outcome| {
        let named = |note: &String| note.starts_with("lambda is");
        outcome.notes.iter().any(named)
    };
    let right = found(1.0);
    let lambda = right.berth.unwrap().lambda.value;
    assert!(
        !right.plans.is_empty() && !is_named(&right),
        "{:?}",
        right.notes
    );
    for unusual in [0.55, 0.62, 1.13, 1.2] {
        let outcome = found(unusual / lambda);
        assert!(!outcome.plans.is_empty() && is_named(&outcome), "{unusual}");
    }
    for none in [0.40, 0.47, 1.29, 1.40] {
        let refused = found(none / lambda).refusals.remove(0).refusal;
        assert!(
            matches!(refused, Refusal::ImplausibleLambda { .. }),
            "{none}"
        );
    }
}

#[test]
fn an_age_that_nobody_said_is_said_not_to_be_checked() {
    let case = case(60.0);
    let said = |days: Option<f64>| {
        let mut adjustment = case.adjustment();
        adjustment.circumstances.model_age_days = days;
        let notes = plan(&adjustment).unwrap().notes;
        notes
            .iter()
            .any(|note| note.starts_with("the age of the model is"))
    };
    assert!(said(None) && !said(Some(3.0)));
}

/// A ship with hardly any deviation, for which several explanations fit.
fn nearly_nil() -> Case {
    let mut case = case(45.0);
    let magnitude = 0.9 * BISCAY.h_nt;
    case.model.parameters_over_lambda = Parameters::from_array([0.0; 7]);
    let mut form: BinnacleForm = case.binnacle.clone().into();
    form.setting = Setting::default();
    case.binnacle = Binnacle::try_from(form).unwrap();
    let field_nt = [magnitude * 0.5_f64.sqrt(), -magnitude * 0.5_f64.sqrt()];
    let (errors, heading) = (case.reading.errors(), case.reading.magnetic());
    case.reading = BerthReading::new(heading, field_nt, errors, Alignment::Keel).unwrap();
    case
}

#[test]
fn all_mistakes_that_explain_a_reading_are_listed_with_the_heading_first() {
    let case = nearly_nil();
    let found = find_misreadings(
        &case.model,
        BISCAY,
        MagneticHeading::new(225.0).unwrap(),
        case.reading.field_nt(),
        Unit::Nanotesla,
        case.reading.errors(),
        Alignment::Keel,
    );
    assert_eq!(
        found,
        [Misreading::HeadingReversed, Misreading::SwappedAxes]
    );
}

#[test]
fn what_a_heading_cannot_show_of_the_axes_is_said() {
    let mut case = nearly_nil();
    let notes = |case: &Case| case.plan().notes.join(" ");
    assert!(
        !notes(&case).contains("cannot show whether"),
        "{}",
        notes(&case)
    );
    let side = -0.9 * BISCAY.h_nt * 0.5_f64.sqrt();
    let (errors, heading) = (case.reading.errors(), MagneticHeading::new(135.0).unwrap());
    case.reading = BerthReading::new(heading, [side, side], errors, Alignment::Keel).unwrap();
    assert!(notes(&case).contains("whether the magnetometer's axes are swapped"));
    assert!(!notes(&case).contains("points to port"), "{}", notes(&case));
}

#[test]
fn what_the_correctors_cannot_reach_no_heading_at_sea_and_no_swing_cures() {
    let refused = |change: fn(&mut ShipMagnetism), magnets: u16| {
        let mut ship = bare();
        change(&mut ship);
        let mut form: BinnacleForm = class_a().into();
        form.inventory.magnets[0].count = magnets;
        let case = Case::new(ship, Binnacle::try_from(form).unwrap(), 60.0);
        let mut adjustment = case.adjustment();
        adjustment.limits = Limits::default();
        let mut refusals = plan(&adjustment).unwrap().refusals;
        assert_eq!(refusals.len(), 1, "{refusals:?}");
        refusals.remove(0)
    };
    // D is negative, and spheres fit athwartships only.
    let negative_d = refused(|ship| (ship.chi[0][0], ship.chi[1][1]) = (-0.25, 0.0), 12);
    // The ship's field exceeds the few magnets on board.
    let strong = refused(|ship| ship.b_nt = [12_000.0, -9_000.0, 0.0], 4);
    for refused in [negative_d, strong] {
        assert!(
            matches!(refused.refusal, Refusal::ResidualTooLarge { .. }),
            "{}",
            refused.words
        );
        assert_eq!(refused.cures, [Cure::OtherCorrectors]);
    }
}

#[test]
fn a_telephone_is_not_believed_to_be_a_fluxgate() {
    let form = |magnetometer: &str| -> crate::adjust::ReadingForm {
        serde_json::from_value(serde_json::json!({
            "at": "2026-11-21T06:30:00Z", "lat": 43.3, "lon": -3.0, "heading_true_deg": 40.0,
            "heading_from": "ashore", "forward": 15.0, "starboard": 17.0, "unit": "microtesla",
            "magnetometer": magnetometer, "field_sd_nt": 20.0,
        }))
        .unwrap()
    };
    assert_eq!(form("fluxgate").check_ranges(), Ok(()));
    let error = form("phone").check_ranges().unwrap_err();
    assert_eq!(error.field, "field_sd_nt");
    assert!(error.what.contains("500"), "{error}");
}

#[test]
fn a_weak_horizontal_field_is_said() {
    let note_in = |h_nt: f64| {
        let mut ship = bare();
        ship.b_nt = [0.0; 3];
        let mut form: BinnacleForm = class_a().into();
        form.setting = Setting::default();
        let mut case = Case::new(ship, Binnacle::try_from(form).unwrap(), 60.0);
        let earth = EarthField {
            h_nt,
            z_nt: 55_000.0,
        };
        let [x, y, _] = case
            .bare
            .field_at_compass(earth.in_ship_axes(60.0_f64.to_radians()));
        let (errors, heading) = (case.reading.errors(), case.reading.magnetic());
        case.reading = BerthReading::new(heading, [x, y], errors, Alignment::Keel).unwrap();
        let mut adjustment = case.adjustment();
        adjustment.earth = earth;
        adjustment.limits.residual_deg = 15.0;
        adjustment.limits.band_deg = 15.0;
        let outcome = plan(&adjustment).unwrap();
        assert!(!outcome.plans.is_empty(), "{:?}", outcome.refusals);
        let mut notes = outcome.notes.into_iter();
        notes.find(|note| note.contains("horizontal field here is only"))
    };
    assert_eq!(note_in(6_100.0), None);
    let note = note_in(5_000.0).unwrap();
    assert!(
        note.contains("5.0 microtesla") && note.contains("0.6 degrees"),
        "{note}"
    );
}
