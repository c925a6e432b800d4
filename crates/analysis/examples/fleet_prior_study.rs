//! The table of docs/science.md, §13: the fleet's prior for new ships like and unlike their
//! class, by the class's spread and the number of sisters.
//!
//! `cargo run --release -p binnacle-analysis --example fleet_prior_study [FLEETS]`

#[allow(dead_code)]
#[path = "../tests/fleet_prior/trial.rs"]
mod trial;
#[allow(dead_code)]
#[path = "../tests/fleet_prior/world.rs"]
mod world;

use trial::{Tally, Trial, trial};

fn main() {
    let fleets = std::env::args().nth(1);
    let fleets = fleets.map_or(400, |n| n.parse().expect("the number of fleets"));
    println!("Coverage in %: of the class's 95 % region, of the whole prior's, and after a short");
    println!("voyage of the band at the own place and far away (without the fleet); half-width");
    println!("of the far band, degrees, without and with the fleet.");
    println!("spread sisters | ship like the class | ship unlike it");
    for induced in [0.1, 0.3, 0.5, 1.0] {
        for sisters in [2, 3, 5, 10, 20] {
            let Trial { like, unlike } = trial(fleets, sisters, induced);
            println!(
                "{induced:6.1} {sisters:7} | {} | {}",
                row(&like),
                row(&unlike)
            );
        }
    }
}

fn row(t: &Tally) -> String {
    let percent = |x: f64| format!("{:5.1}", 100.0 * x);
    format!(
        "{} {} {} {} ({}) {:.2} {:.2}",
        percent(t.class_region),
        percent(t.region),
        percent(t.near),
        percent(t.far),
        percent(t.far_alone),
        t.far_width_alone,
        t.far_width
    )
}
