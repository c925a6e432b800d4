//! The table of BENCHMARKS.md on adjusting at the berth: how often the band of a plan
//! holds the true residual, and how large the worst one is.
//!
//! `make study-adjust`, or
//! `cargo run --release -p binnacle-magnetics --example adjust_study [SHIPS]`.

#[allow(dead_code)]
#[path = "../../tests/adjusting/mod.rs"]
mod adjusting;

#[path = "../../tests/adjusting/tally.rs"]
mod tally;

use adjusting::knowledge::{FLUXGATE, PHONE};
use tally::Tally;

fn main() {
    let ships = std::env::args().nth(1);
    let ships: u64 = ships.map_or(500, |n| n.parse().expect("the number of ships"));
    for (name, instruments) in [("fluxgate", FLUXGATE), ("phone", PHONE)] {
        for (design, which) in [("class A", 0), ("small", 1)] {
            let tally = Tally::of(0..ships, which, instruments);
            println!("{name}, {design}: {tally}");
        }
    }
}
