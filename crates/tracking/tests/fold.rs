//! The analysis as a fold over parts of a voyage, whose state is put away between two of them.

#![allow(clippy::unwrap_used)] // all of this is tests

#[allow(dead_code)]
#[path = "../../analysis/tests/voyages/mod.rs"]
mod voyages;

use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::angle::TrueHeading;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{Analysis, FitError, SampleDiagnostic};
use binnacle_compass::sample::Sample;
use binnacle_compass::segment::Segment;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use binnacle_tracking::{Input, Part, Voyage, analyse};
use voyages::Variety;
use voyages::fleet::{Event, Log, Plan, sail_log};

const DAY_S: f64 = 86_400.0;

fn sail(seed: u64, event: Event, days: f64) -> Log {
    let mut plan = Plan::new(event, Variety::Poor);
    plan.days = days;
    plan.event_day = days / 3.0;
    sail_log(seed, &plan)
}

fn whole(samples: &[Sample], logbook: &[LogbookEntry]) -> Analysis {
    analyse(&Input {
        samples,
        logbook,
        azimuths: &[],
        prior: &ShipPrior::population(),
        settings: AnalysisSettings::default(),
    })
}

fn begin(samples: &[Sample]) -> Voyage {
    Voyage::begin(
        &AnalysisSettings::default(),
        &ShipPrior::population(),
        ReferenceGrade::of(samples),
    )
}

fn kept(voyage: &Voyage) -> Vec<u8> {
    postcard::to_allocvec(voyage).unwrap()
}

fn segments(samples: &[Sample]) -> Vec<&[Sample]> {
    let same = |a: &Sample, b: &Sample| Segment::of(a.time) == Segment::of(b.time);
    samples.chunk_by(same).collect()
}

/// States of a voyage at the end of each segment but the last, and what was settled there.
fn states(samples: &[Sample], logbook: &[LogbookEntry]) -> Vec<(Vec<u8>, Vec<SampleDiagnostic>)> {
    let mut bytes = kept(&begin(samples));
    let segments = segments(samples);
    let (_, closed) = segments.split_last().unwrap();
    let mut states = Vec::new();
    for segment in closed {
        let mut voyage: Voyage = postcard::from_bytes(&bytes).unwrap();
        let end = Segment::of(segment[0].time).end();
        let settled = voyage.advance(&Part::new(segment, logbook, &[], end));
        bytes = kept(&voyage);
        states.push((bytes.clone(), settled));
    }
    states
}

/// Analysis by a voyage that was put away at the end of each segment.
fn fold(samples: &[Sample], logbook: &[LogbookEntry]) -> Analysis {
    let states = states(samples, logbook);
    let last = *segments(samples).last().unwrap();
    let (bytes, _) = states.last().unwrap();
    let voyage: Voyage = postcard::from_bytes(bytes).unwrap();
    let analysis = voyage.report(&Part::new(last, logbook, &[], None));
    let settled = states.into_iter().flat_map(|(_, settled)| settled);
    Analysis {
        samples: settled.chain(analysis.samples).collect(),
        ..analysis
    }
}

fn assert_same(a: &Analysis, b: &Analysis) {
    let text = |analysis: &Analysis| serde_json::to_string(analysis).unwrap();
    assert!(text(a) == text(b));
}

fn entry(kind: LogbookKind, from: Timestamp, to: Option<Timestamp>) -> LogbookEntry {
    LogbookEntry {
        from,
        to,
        kind,
        cargo: None,
        note: String::new(),
    }
}

#[test]
fn a_voyage_put_away_each_month_gives_the_same_bytes_as_one_analysed_at_once() {
    for (seed, event) in [
        (5, Event::Step(3000.0)),
        (6, Event::Cargo),
        (7, Event::GyroFault(4.0)),
        (8, Event::Nothing),
    ] {
        let log = sail(seed, event, 130.0);
        let at_once = whole(&log.samples, &log.logbook);
        assert_same(&fold(&log.samples, &log.logbook), &at_once);
        let model = at_once.current_epoch().unwrap().model.as_ref().unwrap();
        assert!(model.samples_used > model.samples_rejected, "{seed}");
        assert_eq!(at_once.samples.len(), log.samples.len());
    }
}

#[test]
fn late_repeated_and_reordered_samples_and_entries_leave_no_trace() {
    let log = sail(9, Event::Step(2000.0), 100.0);
    let first = log.samples[0].time;
    let at = |day: f64| first.plus_seconds(day * DAY_S);
    let logbook = [
        entry(LogbookKind::MagneticCargo, at(20.0), Some(at(50.0))),
        entry(LogbookKind::Welding, at(62.0), None),
        entry(LogbookKind::Berth, at(34.0), Some(at(36.0))),
    ];
    let mut samples = log.samples.clone();
    samples.extend(log.samples[500..900].to_vec());
    samples.reverse();
    let mut entries = logbook.to_vec();
    entries.reverse();
    assert_same(&whole(&samples, &entries), &fold(&log.samples, &logbook));
}

#[test]
fn a_late_sample_or_entry_changes_no_state_before_its_segment() {
    let log = sail(10, Event::Nothing, 110.0);
    let late = log.samples.iter().rposition(|sample| {
        Segment::of(sample.time).number() + 2
            == Segment::of(log.samples.last().unwrap().time).number()
    });
    let late = late.unwrap() - 50;
    let mut without = log.samples.clone();
    let missing = without.remove(late);
    let logbook = [entry(LogbookKind::Repair, missing.time, None)];
    let before = segments(&log.samples)
        .iter()
        .position(|segment| Segment::of(segment[0].time) == Segment::of(missing.time))
        .unwrap();
    assert!(before > 0);
    let with = states(&log.samples, &[]);
    for other in [states(&without, &[]), states(&log.samples, &logbook)] {
        let same = with.iter().zip(&other).take_while(|(a, b)| a == b).count();
        assert_eq!(same, before);
    }
}

#[test]
fn a_state_does_not_grow_with_the_samples() {
    let log = sail(8, Event::Nothing, 220.0);
    let sizes: Vec<usize> = states(&log.samples, &log.logbook)
        .iter()
        .map(|(bytes, _)| bytes.len())
        .collect();
    let [.., middle, _, _, last] = sizes[..] else {
        panic!("{sizes:?}");
    };
    assert!(last < 2 * middle, "{sizes:?}");
}

#[test]
fn a_stay_alongside_across_the_end_of_a_segment_is_one() {
    let mut log = sail(11, Event::Nothing, 60.0);
    let end = Segment::of(log.samples[0].time.plus_seconds(20.0 * DAY_S))
        .end()
        .unwrap();
    let [from, until] = [-12.0, 12.0].map(|hours: f64| end.plus_seconds(hours * 3600.0));
    let berth = log
        .samples
        .iter()
        .find(|s| s.time >= from)
        .copied()
        .unwrap();
    log.samples.retain(|s| s.time < from || s.time > until);
    // Steel beside the compass moves it by twenty degrees.
    let compass = binnacle_compass::angle::CompassHeading::new(berth.compass.degrees() + 20.0);
    log.samples.extend((0..144).map(|nth| Sample {
        time: from.plus_seconds(600.0 * f64::from(nth)),
        compass: compass.unwrap(),
        sog_kn: Some(0.0),
        ..berth
    }));
    log.samples.sort_by_key(|sample| sample.time);
    let analysis = whole(&log.samples, &[]);
    let stays = analysis.changes.iter().filter(|change| {
        change.cause == binnacle_compass::result::Cause::BerthSteel
            && change.from >= from.plus_seconds(-1.0)
            && change.from <= until
    });
    let stays: Vec<_> = stays.collect();
    assert_eq!(stays.len(), 1, "{stays:#?}");
    assert!(stays[0].ended.unwrap() > end);
}

/// Gives a voyage another gyro from a day on, by the variation of each sample.
fn with_gyro(log: &mut Log, from_day: f64, gyro_deg: fn(&SampleDiagnostic) -> f64) {
    let diagnoses = whole(&log.samples, &[]).samples;
    let from = log.samples[0].time.plus_seconds(from_day * DAY_S);
    for (sample, found) in log.samples.iter_mut().zip(&diagnoses) {
        if sample.time >= from {
            sample.gyro = TrueHeading::new(gyro_deg(found));
            sample.satellite = None;
        }
    }
}

#[test]
fn a_gyro_that_is_the_compass_is_refused_in_every_part() {
    let mut log = sail(12, Event::Nothing, 100.0);
    with_gyro(&mut log, 0.0, |found| {
        found.sample.compass.degrees() + found.variation_deg.unwrap()
    });
    let analysis = whole(&log.samples, &[]);
    assert_same(&fold(&log.samples, &[]), &analysis);
    let refusal = &analysis.current_epoch().unwrap().refusal;
    let is_named = matches!(refusal, Some(FitError::ReferenceIsCompass { .. }));
    assert!(is_named, "{refusal:?}");
    assert_eq!(analysis.changes, []);
    assert!(analysis.samples.iter().all(|found| !found.used));
}

#[test]
fn a_gyro_that_becomes_the_compass_is_refused_and_what_was_read_before_stays() {
    let mut log = sail(12, Event::Nothing, 130.0);
    with_gyro(&mut log, 40.0, |found| {
        found.sample.compass.degrees() + found.variation_deg.unwrap()
    });
    let analysis = whole(&log.samples, &[]);
    assert_same(&fold(&log.samples, &[]), &analysis);
    let refusal = &analysis.current_epoch().unwrap().refusal;
    assert!(refusal.is_some(), "{:?}", analysis.epochs);
    let mut used = analysis.samples.iter().rev().filter(|found| found.used);
    let last = used.next().unwrap().sample.time;
    assert!(last < log.samples[0].time.plus_seconds(45.0 * DAY_S));
}

#[test]
fn a_damaged_voyage_is_refused() {
    let log = sail(5, Event::Nothing, 40.0);
    let (bytes, _) = &states(&log.samples, &[])[0];
    assert!(postcard::from_bytes::<Voyage>(&bytes[..bytes.len() / 2]).is_err());
}
