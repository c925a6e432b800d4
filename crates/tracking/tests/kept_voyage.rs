//! A voyage that is put away and read again.

#![allow(clippy::unwrap_used)] // all of this is tests

#[allow(dead_code)]
#[path = "../../analysis/tests/voyages/mod.rs"]
mod voyages;

use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_tracking::{Input, Voyage};
use voyages::Variety;
use voyages::fleet::{Event, Plan, sail_log};

fn begin() -> Voyage {
    Voyage::begin(&AnalysisSettings::default(), &ShipPrior::population())
}

fn sail_on(voyage: &mut Voyage, samples: &[Sample], logbook: &[LogbookEntry]) {
    voyage.sail_on(&Input {
        samples,
        logbook,
        azimuths: &[],
        prior: &ShipPrior::population(),
        settings: AnalysisSettings::default(),
    });
}

fn kept(voyage: &Voyage) -> Vec<u8> {
    postcard::to_allocvec(voyage).unwrap()
}

#[test]
fn a_voyage_put_away_each_week_is_the_same_as_one_read_at_once() {
    let mut plan = Plan::new(Event::Step(3000.0), Variety::Poor);
    plan.days = 40.0;
    plan.event_day = 20.0;
    let log = sail_log(5, &plan);
    let mut whole = begin();
    sail_on(&mut whole, &log.samples, &log.logbook);

    let mut bytes = kept(&begin());
    for (nth, week) in log.samples.chunks(7 * 144).enumerate() {
        let mut voyage: Voyage = postcard::from_bytes(&bytes).unwrap();
        // Entries later than the week's last sample wait for their time.
        let logbook: &[LogbookEntry] = if nth == 0 { &log.logbook } else { &[] };
        sail_on(&mut voyage, week, logbook);
        bytes = kept(&voyage);
    }
    assert!(bytes == kept(&whole));
}

#[test]
fn a_damaged_voyage_is_refused() {
    let mut plan = Plan::new(Event::Nothing, Variety::Poor);
    plan.days = 2.0;
    let log = sail_log(5, &plan);
    let mut voyage = begin();
    sail_on(&mut voyage, &log.samples, &log.logbook);
    let bytes = kept(&voyage);
    assert!(postcard::from_bytes::<Voyage>(&bytes[..bytes.len() / 2]).is_err());
}
