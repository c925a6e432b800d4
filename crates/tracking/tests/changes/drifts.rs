//! Drifts of the vessel's magnetism over weeks.

use crate::voyages::fleet::{Event, Log, sail_log};
use crate::{analyse_with, calm, entry, is_sound, of_the_ship, run};
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::result::{Cause, Change};
use binnacle_compass::settings::AnalysisSettings;

const DAY_S: f64 = 86_400.0;
/// Seeds, each with the growth of bx from day 25 to day 55, nT.
const DRIFTS: [(u64, f64); 4] = [(81, 3000.0), (82, 3000.0), (83, -3000.0), (84, 2500.0)];

/// Returns a calm voyage of seventy days whose bx grows over thirty, from day 25 on.
fn drifting(seed: u64, nt: f64) -> Log {
    let mut plan = calm(Event::Nothing);
    plan.days = 70.0;
    let mut log = sail_log(seed, &plan);
    let start = log.start;
    for sample in &mut log.samples {
        let day = sample.time.seconds_since(start) / DAY_S;
        let part = ((day - 25.0) / 30.0).clamp(0.0, 1.0);
        let earth = field(FieldModel::Igrf14, sample.position, 0.0, sample.time).unwrap();
        let bearing = sample.compass.degrees().to_radians();
        let off = (nt * part * bearing.sin() / earth.h_nt()).to_degrees();
        sample.compass = CompassHeading::new(sample.compass.degrees() - off).unwrap();
    }
    log
}

#[test]
fn slow_growth_is_one_drift_from_early_on() {
    let (mut drifts, mut reported) = (0, 0);
    for (seed, nt) in DRIFTS {
        let log = drifting(seed, nt);
        let analysis = run(&log.samples);
        is_sound(&analysis);
        let found = of_the_ship(&analysis);
        assert!(!found.is_empty(), "seed {seed}");
        reported += found.len();
        let in_time = |c: &&&Change| c.detected_at.seconds_since(log.start) < 42.0 * DAY_S;
        let early = found.iter().filter(in_time);
        drifts += usize::from(early.filter(|c| c.cause == Cause::Drift).count() == 1);
    }
    assert!(drifts >= 3, "{drifts}");
    assert!(reported <= 5, "{reported} changes of 4 drifts");
}

#[test]
fn an_open_cargo_entry_of_weeks_ago_hides_no_drift() {
    let mut drifts = 0;
    for (seed, nt) in DRIFTS {
        let log = drifting(seed, nt);
        let loaded = log.start.plus_seconds(DAY_S);
        let open = [entry(LogbookKind::MagneticCargo, loaded, None)];
        let analysis = analyse_with(&log.samples, &open, &AnalysisSettings::default());
        is_sound(&analysis);
        let found = of_the_ship(&analysis);
        drifts += usize::from(found.iter().any(|c| c.cause == Cause::Drift));
        let struck = |c: &&&Change| c.cause == Cause::LightningOrShock;
        assert_eq!(found.iter().find(struck), None, "seed {seed}");
    }
    assert!(drifts >= 3, "{drifts}");
}
