//! Error of the curve's shape over its Cramér–Rao bound, on plain ships with a gyro alone.
//!
//! The shape is the curve less its mean over the headings: no heading can separate the compass's
//! alignment from the gyro's constant, and the model states the alignment alone.

use crate::arguments::Arguments;
use crate::detector::analyse;
use crate::table::at_most;
use crate::voyages::bound::{HEADINGS, shape_bound};
use crate::voyages::{Faults, Truth, Variety, predicted, sail_on, true_deviation};
use binnacle_analysis::fit::Observation;
use binnacle_compass::angle::{TrueHeading, wrap_180};
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;

const SEEDS: u64 = 5_000_000;
const DAYS: f64 = 14.0;
/// Error over the bound.
const TARGET: f64 = 1.1;

pub(crate) struct Row {
    pub(crate) name: &'static str,
    variety: Variety,
}

pub(crate) const ROWS: [Row; 3] = [
    Row {
        name: "bound_rich",
        variety: Variety::Rich,
    },
    Row {
        name: "bound_medium",
        variety: Variety::Medium,
    },
    Row {
        name: "bound_poor",
        variety: Variety::Poor,
    },
];

/// Mean square error of the shape of a ship's curve, and its bound, square degrees.
struct Error {
    squares: f64,
    bound: f64,
}

pub(crate) fn run(arguments: &Arguments) {
    let rows: Vec<&Row> = ROWS.iter().filter(|row| arguments.has(row.name)).collect();
    if rows.is_empty() {
        return;
    }
    println!(
        "\n{:16} {:>5} {:>7} {:>12} {:>12}",
        "14 days, gyro", "ships", "models", "error, deg", "error/bound"
    );
    for row in rows {
        let errors = arguments.each(SEEDS, |seed| Some((seed, error(row, seed)?)));
        let errors: Vec<(u64, Error)> = errors.into_iter().flatten().collect();
        if arguments.words {
            for (seed, error) in &errors {
                let [error_deg, bound_deg] = [error.squares, error.bound].map(f64::sqrt);
                println!("  seed {seed} error {error_deg:.2}°, bound {bound_deg:.2}°");
            }
        }
        let sum = |of: fn(&Error) -> f64| errors.iter().map(|(_, e)| of(e)).sum::<f64>();
        let (squares, bounds) = (sum(|e| e.squares), sum(|e| e.bound));
        println!(
            "{:16} {:5} {:7} {:12.3} {:>12}",
            row.name,
            arguments.ships,
            errors.len(),
            (squares / errors.len() as f64).sqrt(),
            at_most((squares / bounds).sqrt(), TARGET, 2),
        );
    }
}

fn error(row: &Row, seed: u64) -> Option<Error> {
    // The bound knows of no storms.
    let faults = Faults {
        storms_per_month: 0.0,
        ..Faults::USUAL
    };
    let voyage = sail_on(igrf, seed, row.variety, DAYS, &faults);
    let samples: Vec<Sample> = voyage.observations.iter().map(sample).collect();
    let analysis = analyse(&samples, &[]);
    let model = analysis.current_epoch()?.model.clone()?;
    let Truth { h_nt, z_nt, .. } = voyage.truth;
    let errors: Vec<f64> = (0..HEADINGS)
        .map(|k| {
            let compass_deg = 10.0 * k as f64;
            let (predicted_deg, _) = predicted(&model, compass_deg, h_nt, z_nt);
            wrap_180(predicted_deg - true_deviation(&voyage.truth, compass_deg, h_nt, z_nt))
        })
        .collect();
    let mean = errors.iter().sum::<f64>() / HEADINGS as f64;
    let squares = errors.iter().map(|error| (error - mean).powi(2));
    Some(Error {
        squares: squares.sum::<f64>() / HEADINGS as f64,
        bound: shape_bound(&voyage, h_nt, z_nt),
    })
}

fn igrf(lat_deg: f64, lon_deg: f64, time: Timestamp) -> (f64, f64, f64) {
    let position = Position::new(lat_deg, lon_deg).unwrap();
    let here = field(FieldModel::Igrf14, position, 0.0, time).unwrap();
    let ship = here.for_ship();
    (here.declination().degrees_east(), ship.h_nt, ship.z_nt)
}

/// Returns the sample whose readings gave an observation by gyro alone.
fn sample(o: &Observation) -> Sample {
    let gyro = ((o.compass + o.deviation) + o.variation).degrees();
    Sample {
        gyro: TrueHeading::new(gyro),
        sog_kn: o.sog_kn,
        rate_of_turn_deg_min: Some(0.0),
        spread_deg: Some(0.3),
        windows: o.windows,
        ..Sample::new(o.time.unwrap(), o.position.unwrap(), o.compass)
    }
}
