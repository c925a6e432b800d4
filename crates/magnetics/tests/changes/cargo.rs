//! Magnetic cargo: the base model is back when it is discharged, and not before.

use crate::voyages::fleet::{Event, Happened, Name, sail_log};
use crate::{HOUR_S, calm, entry, is_sound, of_the_ship, run};
use binnacle_magnetics::analyse::{AnalysisSettings, LogbookEntry, LogbookKind, analyse};
use binnacle_magnetics::change::Cause;
use binnacle_magnetics::time::Timestamp;

#[test]
fn after_discharge_the_base_model_is_resumed() {
    let mut plan = calm(Event::Cargo);
    plan.days = 90.0;
    let log = sail_log(40, &plan);
    let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
    let analysis = run(&log.samples);
    is_sound(&analysis);
    let found = of_the_ship(&analysis);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].cause, Cause::MagneticCargo);
    let ended = found[0].ended.unwrap();
    let off_days = ended.seconds_since(cargo.to.unwrap()).abs() / 86_400.0;
    assert!(off_days < 1.5, "{off_days} days");
    assert_eq!(analysis.epochs.len(), 3);
    assert_eq!(analysis.epochs[2].resumes, Some(0));
    let used = |i: usize| analysis.epochs[i].model.as_ref().unwrap().samples_used;
    assert!(used(2) > used(0), "the base's samples count again");
}

/// The officer's report of the cargo, written down hours later.
fn reported(cargo: &Happened) -> LogbookEntry {
    let late = |time: Timestamp| time.plus_seconds(5.0 * HOUR_S);
    entry(
        LogbookKind::MagneticCargo,
        late(cargo.from),
        cargo.to.map(late),
    )
}

#[test]
fn a_discharge_that_was_reported_has_the_base_model_back_with_the_first_sample() {
    for seed in [40, 41, 44] {
        let mut plan = calm(Event::Cargo);
        plan.days = 90.0;
        let log = sail_log(seed, &plan);
        let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
        let discharged = cargo.to.unwrap();
        let sailed = log.samples.partition_point(|s| s.time <= discharged);
        let logbook = [reported(cargo)];
        let settings = AnalysisSettings::default();
        let analysis = analyse(&log.samples[..=sailed], &logbook, &settings);
        is_sound(&analysis);
        let epoch = analysis.current_epoch().unwrap();
        let is_base = epoch.resumes == Some(0) || epoch.begun_by_change.is_none();
        assert!(is_base, "seed {seed}: {:?}", analysis.changes);
        assert!(epoch.model.is_some());
    }
}

#[test]
fn cargo_that_stays_on_board_by_the_logbook_is_not_over_at_a_call() {
    let mut plan = calm(Event::Cargo);
    plan.days = 90.0;
    let log = sail_log(40, &plan);
    let cargo = log.happened.iter().find(|h| h.what == Name::Cargo).unwrap();
    let discharged = cargo.to.unwrap();
    let sailed = log.samples.partition_point(|s| s.time <= discharged);
    let stays = LogbookEntry {
        to: Some(discharged.plus_seconds(20.0 * 86_400.0)),
        ..reported(cargo)
    };
    let settings = AnalysisSettings::default();
    let analysis = analyse(&log.samples[..=sailed], &[stays], &settings);
    is_sound(&analysis);
    assert_eq!(analysis.current_epoch().unwrap().resumes, None);
    // Whatever was written, a day's samples without it are believed in the end.
    let stays = [LogbookEntry {
        to: Some(discharged.plus_seconds(20.0 * 86_400.0)),
        ..reported(cargo)
    }];
    let analysis = analyse(&log.samples, &stays, &settings);
    assert_eq!(analysis.current_epoch().unwrap().resumes, Some(0));
}
