//! Cost of an evaluation of the earth's field:
//! `cargo bench -p binnacle-compass --bench field`.

use binnacle_compass::field::{FieldAt, FieldModel, field};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

const MODELS: [FieldModel; 2] = [FieldModel::Igrf14, FieldModel::Wmm2025];

fn off_ushant() -> (Position, Timestamp) {
    let position = Position::new(48.5, -5.5).expect("a place at sea");
    let time = Timestamp::parse("2026-11-21T07:00:00Z").expect("a time");
    (position, time)
}

/// Place and time both new: coefficients are interpolated for each evaluation.
#[divan::bench(args = MODELS, sample_size = 100)]
fn field_evaluation(bencher: Bencher<'_, '_>, model: FieldModel) {
    let (position, time) = off_ushant();
    bencher.bench(|| field(model, black_box(position), black_box(0.0), black_box(time)));
}

/// Many places at one time: coefficients are interpolated beforehand.
#[divan::bench(args = MODELS, sample_size = 100)]
fn field_evaluation_at_one_time(bencher: Bencher<'_, '_>, model: FieldModel) {
    let (position, time) = off_ushant();
    let model = FieldAt::from_time(model, time).expect("a date that both models know");
    bencher.bench(|| model.at(black_box(position), black_box(0.0)));
}
