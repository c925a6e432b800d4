//! Headings at sea after a plan.

use super::super::*;
use super::*;

fn settled(model: &Model, compass_deg: f64, off_deg: f64) -> SettledHeading {
    let compass = binnacle_compass::angle::CompassHeading::new(compass_deg).unwrap();
    let predicted = model.deviation(compass, BISCAY).unwrap().deviation;
    SettledHeading {
        compass,
        deviation_deg: predicted.degrees_east() + off_deg,
        sd_deg: 0.6,
        earth: BISCAY,
    }
}

#[test]
fn headings_at_sea_pass_when_they_are_enough_and_say_how_many_are_not() {
    let model = &case(60.0).plan().plans[0].model_after;
    let Verification::MoreNeeded {
        headings: 0,
        needed,
    } = verify(model, &[], BISCAY).unwrap()
    else {
        panic!()
    };
    assert!((4..30).contains(&needed.count), "{needed:?}");
    let mut sailed: Vec<SettledHeading> = needed
        .compass_deg
        .iter()
        .map(|deg| settled(model, *deg, 0.3))
        .collect();
    let first = verify(model, &sailed[..1], BISCAY).unwrap();
    let Verification::MoreNeeded { needed: fewer, .. } = first else {
        panic!("{first:?}")
    };
    assert!(fewer.count < needed.count);
    for step in 0..24 {
        sailed.push(settled(model, f64::from(step) * 15.0, -0.2));
    }
    let passed = verify(model, &sailed, BISCAY).unwrap();
    let Verification::Passed {
        headings: 24,
        band95_deg,
        ..
    } = passed
    else {
        panic!("{passed:?}")
    };
    assert!(band95_deg < 1.0);
}

#[test]
fn a_heading_that_is_off_raises_the_alarm_on_either_side() {
    let model = &case(60.0).plan().plans[0].model_after;
    for (compass_deg, off_deg) in [(359.0, 2.3), (1.0, -2.3), (180.0, 2.3)] {
        let found = verify(model, &[settled(model, compass_deg, off_deg)], BISCAY).unwrap();
        let Verification::Alarm {
            off_deg: found_deg, ..
        } = found
        else {
            panic!("{found:?}")
        };
        assert!((found_deg - off_deg).abs() < 1e-9);
    }
    let mut sure = settled(model, 90.0, 1.8);
    sure.sd_deg = 0.1;
    let mut known = model.clone();
    known.covariance = Some([[0.0; 8]; 8]);
    let found = verify(&known, &[sure], BISCAY).unwrap();
    assert!(
        matches!(found, Verification::Alarm { .. }),
        "beyond three standard errors"
    );
}
