//! Study of the tracker on ships that are not as it supposes: sound ships with habits,
//! compasses whose zero is off, steps, faults, and the causes given for them.
//!
//! `make study-ships`, or `cargo run --release -p binnacle-tracking --example
//! real_ships_study -- --ships 6 --rows plain,retention_1`. Without `--rows` all rows are run,
//! in the order of `--list`; each prints one line as soon as it is complete. The same seeds
//! make the same voyages for every habit.

#![allow(clippy::unwrap_used)] // a study, run by hand

#[allow(dead_code)]
#[path = "../../../analysis/tests/voyages/mod.rs"]
mod voyages;

mod arguments;
mod band_check;
mod causes;
mod cold_start;
mod detector;
mod efficiency;
mod score;
mod sound_ships;
mod steps;
mod table;

use arguments::Arguments;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = match Arguments::parse(std::env::args().skip(1)) {
        Ok(arguments) => arguments,
        Err(problem) => {
            println!("{problem}\n{}", arguments::USAGE);
            return ExitCode::FAILURE;
        }
    };
    if arguments.list {
        for name in names() {
            println!("{name}");
        }
        return ExitCode::SUCCESS;
    }
    if let Some(unknown) = arguments.unknown(&names()) {
        println!("no row {unknown}: --list has the names");
        return ExitCode::FAILURE;
    }
    sound_ships::run(&arguments);
    cold_start::run(&arguments);
    steps::run(&arguments);
    causes::run(&arguments);
    efficiency::run(&arguments);
    ExitCode::SUCCESS
}

/// Returns the names of all rows, in their order.
fn names() -> Vec<&'static str> {
    let sound = sound_ships::ROWS.iter().map(|row| row.name);
    let starting = cold_start::ROWS.iter().map(|row| row.name);
    let steps = steps::ROWS.iter().map(|row| row.name);
    let causes = causes::ROWS.iter().map(|row| row.name);
    let efficiency = efficiency::ROWS.iter().map(|row| row.name);
    sound
        .chain(starting)
        .chain(steps)
        .chain(causes)
        .chain(efficiency)
        .collect()
}
