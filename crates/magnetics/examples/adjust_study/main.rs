//! The tables of BENCHMARKS.md on adjusting at the berth: how often the band of a plan
//! holds the true residual and how large the worst one is; what becomes of steps that are
//! done wrong, with and without a second reading of the magnetometer; and how soon headings at sea tell right from wrong.
//!
//! `make study-adjust`, or
//! `cargo run --release -p binnacle-magnetics --example adjust_study [SHIPS] [PART]`
//! with `plans`, `steps` or `sea` for one part alone.

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

use adjusting::knowledge::{FLUXGATE, PHONE};
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
                let tally = Tally::of(0..ships, which, instruments);
                println!("{name}, {design}: {tally}");
            }
        }
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
                    Hands::of(0..ships, slip, ending)
                );
            }
        }
    }
    if wanted("sea") {
        let wrong_deg = [0.0, 1.0, 2.0, 3.0];
        for (wrong_deg, sea) in wrong_deg.iter().zip(Sea::of(0..ships, &wrong_deg)) {
            println!("wrong by {wrong_deg}: {sea}");
        }
    }
}
