//! Tables of BENCHMARKS.md on adjusting at the berth: coverage of a plan's band and size of
//! its worst residual; detection of steps that are done wrong, with and without a second
//! reading of the magnetometer; number of headings at sea until a verdict; and detection of
//! a ship that changed since the model.
//!
//! `make study-adjust`, or
//! `cargo run --release -p binnacle-adjustment --example adjust_study [SHIPS] [PART]`
//! with `plans`, `hidden`, `changed`, `steps`, `berths` or `sea` for one part alone.

#[allow(dead_code)]
#[path = "../../tests/adjusting/mod.rs"]
mod adjusting;

#[allow(dead_code)]
#[path = "../../tests/adjusting/hands.rs"]
mod hands;

#[allow(dead_code)]
#[path = "../../tests/adjusting/sea.rs"]
mod sea;

#[allow(dead_code)]
#[path = "../../tests/adjusting/tally.rs"]
mod tally;

use adjusting::knowledge::{FLUXGATE, Instruments, PHONE};
use adjusting::scene::{ALL_KNOWN, Hidden};
use hands::{Ending, Hands, Slip};
use sea::Sea;
use tally::Tally;

fn main() {
    let ships = std::env::args().nth(1);
    let ships: u64 = ships.map_or(500, |n| n.parse().expect("the number of ships"));
    let part = std::env::args().nth(2);
    let wanted = |name: &str| part.as_deref().is_none_or(|part| part == name);
    if wanted("plans") {
        for (name, instruments) in [("fluxgate", FLUXGATE), ("phone", PHONE)] {
            for (design, which) in [("class A", 0), ("small", 1)] {
                let tally = Tally::from_seeds(0..ships, which, instruments);
                println!("{name}, {design}: {tally}");
            }
        }
    }
    if wanted("hidden") {
        for (name, hidden) in hidden() {
            println!("{name}: {}", Tally::hidden(0..ships, 0, FLUXGATE, hidden));
        }
    }
    if wanted("berths") {
        for (name, hidden) in hidden() {
            for ending in [Ending::ByCompass, Ending::ReadAgain] {
                let hands = Hands::from_seeds(0..ships, Slip::Berth(hidden), ending);
                println!("{name}, {ending:?}: {hands}");
            }
        }
    }
    if wanted("changed") {
        changed(ships);
    }
    if wanted("steps") {
        for slip in [
            Slip::None,
            Slip::WrongEnd,
            Slip::Hole(1),
            Slip::Hole(-3),
            Slip::Moment(0.85),
            Slip::Moment(0.7),
        ] {
            for ending in [Ending::ByCompass, Ending::ReadAgain] {
                println!(
                    "{slip:?}, {ending:?}: {}",
                    Hands::from_seeds(0..ships, slip, ending)
                );
            }
        }
    }
    if wanted("sea") {
        let wrong_deg = [0.0, 1.0, 2.0, 3.0];
        for (wrong_deg, sea) in wrong_deg.iter().zip(Sea::from_seeds(0..ships, &wrong_deg)) {
            println!("wrong by {wrong_deg}: {sea}");
        }
    }
}

/// Class A: what the planner does not know.
fn hidden() -> [(&'static str, Hidden); 9] {
    [
        ("all known", ALL_KNOWN),
        (
            "model from elsewhere",
            Hidden {
                model_from_elsewhere: true,
                ..ALL_KNOWN
            },
        ),
        (
            "model from elsewhere that does not say so",
            Hidden {
                model_from_elsewhere: true,
                model_without_waters: true,
                ..ALL_KNOWN
            },
        ),
        (
            "wrong end in the inventory",
            Hidden {
                wrong_end: true,
                ..ALL_KNOWN
            },
        ),
        (
            "4 microtesla of steel",
            Hidden {
                steel_nt: 4_000.0,
                ..ALL_KNOWN
            },
        ),
        (
            "all known, second heading",
            Hidden {
                is_shifted: true,
                ..ALL_KNOWN
            },
        ),
        (
            "4 microtesla of steel, second heading",
            Hidden {
                steel_nt: 4_000.0,
                is_shifted: true,
                ..ALL_KNOWN
            },
        ),
        (
            "heading 4 degrees off",
            Hidden {
                heading_off_deg: 4.0,
                ..ALL_KNOWN
            },
        ),
        (
            "magnets 20 % weak",
            Hidden {
                lot_share: 0.8,
                ..ALL_KNOWN
            },
        ),
    ]
}

/// Class A: changes across the needle that turn the field by 5° to 10°, with a stated
/// heading error that is true or in fact half a degree; and changes along the needle.
fn changed(ships: u64) {
    let nil = 0.0..0.0;
    for given_deg in [1.0, 2.0, 3.0, 5.0] {
        let said = Instruments {
            heading_sd_deg: given_deg,
            ..FLUXGATE
        };
        for (name, is) in [("half a degree", FLUXGATE), ("as said", said)] {
            for across in [nil.clone(), 5.0..10.0] {
                let tally = Tally::changed(0..ships, [nil.clone(), across.clone()], is, said, None);
                println!("heading said {given_deg}, is {name}, across {across:?}: {tally}");
            }
        }
    }
    for (name, instruments) in [("fluxgate", FLUXGATE), ("phone", PHONE)] {
        for earlier_lambda_sd in [None, Some(0.012)] {
            for along in [nil.clone(), 5.0..10.0] {
                let changed = [along.clone(), nil.clone()];
                let tally = Tally::changed(
                    0..ships,
                    changed,
                    instruments,
                    instruments,
                    earlier_lambda_sd,
                );
                println!("{name}, earlier lambda {earlier_lambda_sd:?}, along {along:?}: {tally}");
            }
        }
    }
}
