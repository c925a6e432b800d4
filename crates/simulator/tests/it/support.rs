//! Small scenarios and voyages for the tests.

use binnacle_simulator::nmea::Talker;
use binnacle_simulator::scenario::Scenario;
use binnacle_simulator::ship::{Reading, Ship};

/// A scenario of a day and a half from port to port along 45° N with a usual
/// ship; `more` is added to the ship, `around` before everything.
pub(crate) fn scenario(around: &str, more: &str) -> Scenario {
    parse(&text(around, more))
}

/// The scenario with the first occurrence of something replaced.
pub(crate) fn changed(old: &str, new: &str) -> Scenario {
    let text = text("", "");
    assert!(text.contains(old), "{old}");
    parse(&text.replacen(old, new, 1))
}

fn parse(text: &str) -> Scenario {
    Scenario::parse("test.toml", text).expect("the test's scenario is right")
}

fn text(around: &str, more: &str) -> String {
    format!(
        r#"
name = "test"
interval_s = 2
{around}
[routes]
along = [
    {{ lat = 45.0, lon = -30.0, port = "Westport", stay_h = 1, wait_h = 6 }},
    {{ lat = 45.5, lon = -22.0 }},
    {{ lat = 44.0, lon = -15.0, port = "Eastport", stay_h = 3, wait_h = 6 }},
]
[[ships]]
name = "Test"
route = "along"
speed_kn = 15
alignment_deg = 0.5
magnetism.b_nt = [2000, -2900, 1400]
magnetism.chi = [[-0.045, 0.0012, -0.0215], [0.0016, -0.080, 0.0022], [0.004, -0.003, 0.030]]
satellite = {{}}
{more}
"#
    )
}

/// The first ship of a scenario at its start.
pub(crate) fn ship(scenario: &Scenario, seed: u64) -> Ship {
    Ship::new(scenario, &scenario.ships[0], seed, scenario.start).expect("the date is known")
}

/// The first ship's sentences in `days` days.
pub(crate) fn sentences(scenario: &Scenario, seed: u64, days: f64) -> Vec<u8> {
    let mut talker = Talker::new(scenario, ship(scenario, seed), seed);
    let until = scenario.start.plus_seconds(days * 86_400.0);
    let mut out = Vec::new();
    while talker.next_time() <= until {
        talker.write_group(&mut out);
    }
    out
}

/// Sails `days` days and passes every reading to `each`, with the ship at that
/// time.
pub(crate) fn sail(ship: &mut Ship, days: f64, mut each: impl FnMut(&Ship, &Reading)) {
    let until = ship.time().plus_seconds(days * 86_400.0);
    while ship.time() < until {
        let reading = ship.step(2.0);
        each(ship, &reading);
    }
}
