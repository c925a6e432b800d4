//! Each row of a handbook's table is applied to an empty binnacle, one coefficient at a
//! time (Pub. 226, "mechanics of magnetic compass adjustment"; ISO 25862 for red).

use super::world::Ship;
use super::{Case, NORTHERN, SOUTHERN, water};
use serde_json::json;

/// Hard iron.
fn hard(hard_nt: [f64; 3]) -> Ship {
    Ship {
        hard_nt,
        ..Ship::default()
    }
}

/// Soft iron: a, b and d together, e, c, f.
fn soft(a: f64, bd: f64, e: f64, c: f64, f: f64) -> Ship {
    Ship {
        hard_nt: [0.0; 3],
        soft: [[a, bd, 0.0], [bd, e, 0.0], [c, f, 0.0]],
    }
}

/// Fitted correctors, in words, at one berth.
fn fitted(ship: Ship, berth: (f64, f64)) -> Vec<String> {
    let case = Case::new(ship, &json!({}), berth, 55.0);
    let plan = case.plan(&[water("north", NORTHERN), water("south", SOUTHERN)]);
    plan.steps.into_iter().map(|step| step.words).collect()
}

#[test]
fn each_coefficient_alone_is_cured_as_the_handbook_says() {
    let cases = [
        // Easterly on east and westerly on west is +B.
        (
            hard([2_500.0, 0.0, 0.0]),
            "fore-and-aft magnets",
            "red forward",
        ),
        (
            hard([-2_500.0, 0.0, 0.0]),
            "fore-and-aft magnets",
            "red aft",
        ),
        // Easterly on north and westerly on south is +C.
        (
            hard([0.0, 2_500.0, 0.0]),
            "athwartship magnets",
            "red starboard",
        ),
        (
            hard([0.0, -2_500.0, 0.0]),
            "athwartship magnets",
            "red port",
        ),
        // Easterly on north-east and south-west is +D: spheres athwartships; −D: before and
        // abaft.
        (soft(-0.05, 0.0, -0.16, 0.0, 0.0), "quadrantal", " mm"),
        (
            soft(-0.16, 0.0, -0.05, 0.0, 0.0),
            "quadrantal",
            "starboard one 90 degrees aft",
        ),
        // Easterly on north and south is +E: slewed clockwise, seen from above.
        (
            soft(-0.05, 0.03, -0.13, 0.0, 0.0),
            "quadrantal",
            "starboard one 20 degrees aft",
        ),
        (
            soft(-0.05, -0.03, -0.13, 0.0, 0.0),
            "quadrantal",
            "starboard one 20 degrees forward",
        ),
        (
            soft(-0.13, 0.03, -0.05, 0.0, 0.0),
            "quadrantal",
            "starboard one 70 degrees aft",
        ),
        (
            soft(-0.13, -0.03, -0.05, 0.0, 0.0),
            "quadrantal",
            "starboard one 70 degrees forward",
        ),
        // Vertical iron abaft the card, as on most ships, needs the bar forward of it.
        (
            soft(0.0, 0.0, 0.0, -0.07, 0.0),
            "Flinders bar",
            "forward of the card",
        ),
        (
            soft(0.0, 0.0, 0.0, 0.07, 0.0),
            "Flinders bar",
            "abaft the card",
        ),
        (
            soft(0.0, 0.0, 0.0, -0.065, -0.024),
            "Flinders bar",
            "forward of the card, 20 degrees to starboard",
        ),
        (
            soft(0.0, 0.0, 0.0, -0.065, 0.024),
            "Flinders bar",
            "forward of the card, 20 degrees to port",
        ),
        (
            soft(0.0, 0.0, 0.0, 0.065, -0.024),
            "Flinders bar",
            "abaft the card, 20 degrees to starboard",
        ),
        (
            soft(0.0, 0.0, 0.0, 0.065, 0.024),
            "Flinders bar",
            "abaft the card, 20 degrees to port",
        ),
        // The ship pulls north down; red up cancels it.
        (hard([0.0, 0.0, 3_000.0]), "heeling magnets", "red up"),
        (hard([0.0, 0.0, -3_000.0]), "heeling magnets", "red down"),
    ];
    for (ship, corrector, place) in cases {
        for berth in [NORTHERN, SOUTHERN] {
            let words = fitted(ship, berth);
            let of_it = words.iter().find(|words| words.starts_with(corrector));
            let of_it = of_it.unwrap_or_else(|| panic!("no {corrector} for {ship:?}: {words:?}"));
            assert!(
                of_it.contains(": fit ") && of_it.ends_with(place),
                "{place}: {of_it}"
            );
        }
    }
}
