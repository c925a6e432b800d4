//! Benchmarks of a whole analysis: sixty days, and a year and more, of ten-minute samples.

#![allow(missing_docs)] // divan's attribute makes public items
#![allow(clippy::unwrap_used)] // as the voyages that it sails

#[path = "../../analysis/tests/voyages/mod.rs"]
#[allow(dead_code)]
mod voyages;

use binnacle_analysis::fit::Observation;
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::angle::TrueHeading;
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::position::Position;
use binnacle_compass::result::Analysis;
use binnacle_compass::sample::Sample;
use binnacle_compass::segment::Segment;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use binnacle_tracking::{Input, Part, Voyage};
use divan::Bencher;
use voyages::{Faults, Variety, sail_on};

fn main() {
    divan::main();
}

/// The samples of one vessel as they arrive at the server, the latest first: sorting and
/// the earth's field are included.
#[divan::bench(args = [60, 423], sample_count = 10, sample_size = 1)]
fn analyse_gyro(bencher: Bencher<'_, '_>, days: u32) {
    bench_analysis(bencher, days, &Faults::USUAL);
}

/// With a satellite compass beside the gyro.
#[divan::bench(args = [60, 423], sample_count = 10, sample_size = 1)]
fn analyse_gyro_and_satellite(bencher: Bencher<'_, '_>, days: u32) {
    let faults = Faults {
        satellite: true,
        ..Faults::USUAL
    };
    bench_analysis(bencher, days, &faults);
}

/// A new batch of six hours on a voyage of some days whose last state is kept: read from its bytes.
#[divan::bench(args = [60, 423, 1100], sample_count = 10, sample_size = 1)]
fn new_batch_on_kept_voyage(bencher: Bencher<'_, '_>, days: u32) {
    let voyage = sail_on(igrf, 3, Variety::Medium, f64::from(days), &Faults::USUAL);
    let samples: Vec<Sample> = voyage.observations.iter().map(sample).collect();
    let segments: Vec<&[Sample]> = samples
        .chunk_by(|a, b| Segment::of(a.time) == Segment::of(b.time))
        .collect();
    let (last, closed) = segments.split_last().unwrap();
    let mut kept = Voyage::begin(
        &AnalysisSettings::default(),
        &ShipPrior::population(),
        ReferenceGrade::Heading,
    );
    for segment in closed {
        let end = Segment::of(segment[0].time).end();
        kept.advance(&Part::new(segment, &[], &[], end));
    }
    let bytes = postcard::to_allocvec(&kept).unwrap();
    bencher
        .counter(divan::counter::BytesCount::of_slice(&bytes))
        .bench_local(|| {
            let voyage: Voyage = postcard::from_bytes(&bytes).unwrap();
            voyage.report(&Part::new(last, &[], &[], None))
        });
}

fn bench_analysis(bencher: Bencher<'_, '_>, days: u32, faults: &Faults) {
    let voyage = sail_on(igrf, 3, Variety::Medium, f64::from(days), faults);
    let mut samples: Vec<Sample> = voyage.observations.iter().map(sample).collect();
    samples.reverse();
    let analysis = analyse(&samples);
    let model = analysis.current_epoch().and_then(|e| e.model.as_ref());
    // An analysis that refuses would be quick.
    assert!(model.is_some_and(|m| m.samples_used > m.samples_rejected));
    bencher.bench_local(|| analyse(&samples));
}

fn analyse(samples: &[Sample]) -> Analysis {
    binnacle_tracking::analyse(&Input {
        samples,
        logbook: &[],
        azimuths: &[],
        prior: &ShipPrior::population(),
        settings: AnalysisSettings::default(),
    })
}

fn igrf(lat_deg: f64, lon_deg: f64, time: Timestamp) -> (f64, f64, f64) {
    let position = Position::new(lat_deg, lon_deg).unwrap();
    let at = field(FieldModel::Igrf14, position, 0.0, time).unwrap();
    let ship_field = at.for_ship();
    (
        at.declination().degrees_east(),
        ship_field.h_nt,
        ship_field.z_nt,
    )
}

/// Returns the sample whose readings gave an observation.
fn sample(o: &Observation) -> Sample {
    let reference = ((o.compass + o.deviation) + o.variation).degrees();
    let apart = o.gyro_less_satellite_deg;
    let satellite = apart.map(|apart| reference - o.gyro_share * apart);
    let gyro = satellite
        .zip(apart)
        .map_or(reference, |(s, apart)| s + apart);
    Sample {
        gyro: TrueHeading::new(gyro),
        satellite: satellite.and_then(TrueHeading::new),
        sog_kn: o.sog_kn,
        rate_of_turn_deg_min: Some(0.0),
        spread_deg: Some(0.3),
        windows: o.windows,
        ..Sample::new(o.time.unwrap(), o.position.unwrap(), o.compass)
    }
}
