//! The search: one filter runs forward over the rows, a bank of what else may have
//! happened beside it, and what proves likelier by far takes its place.
//!
//! What always holds: a row is read once in order of time and nothing later than it
//! decides what it tells; every event lies between two rows; the search ends.

mod adopt;
mod anew;
mod borne_out;
mod burst;
mod date;
mod event;
mod faint;
mod judge;
mod learn;
mod logged;
mod open;
mod port;
mod rival;
mod unnoticed;
mod unsettled;

pub(crate) use event::{Event, Given, Perhaps, Snapshot, Told, What};
pub(crate) use logged::{Loaded, SAILED_SINCE, rows_since};
pub(crate) use port::at_port;
pub(crate) use unnoticed::Unnoticed;

use super::bank::{Bank, Kind, Lead};
use super::calls::Calls;
use super::filter::{Filter, Measurement, Noise, measurement};
use super::large::{fusion, relinearised};
use super::upset::Earlier;
use crate::estimate::{Point, Prior, Station, Unknowns, are_times_believed, row, stations};
use crate::observation::Observation;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::time::Timestamp;
use borne_out::Doubt;
use faint::Faint;
use learn::{Learnt, Lesson};
use rival::Rival;
use unnoticed::Ports;
use unsettled::Unsettled;

/// Rows between times that are tried: about an hour of sailing.
const EVERY: usize = 6;
/// A row that is astray by more than this is a time to be tried, if the last is so
/// many rows before it: by the covariance of the row before, to which the step between
/// has added nothing yet, so that one row in eight is.
const ASTRAY_SD: f64 = 3.0;
const ASTRAY_ROWS: usize = 2;
/// After a gap of this the next row is a time to be tried, whatever the count.
const GAP_S: f64 = 2.0 * 3600.0;
/// What drifts does so on the way: of a longer gap so much counts for what a supposed drift
/// may have done in it, seconds, or any change in a gap would pass for one.
const DRIFTS_UNSEEN_S: f64 = 12.0 * 3600.0;
/// Before so many rows no change is told from learning; so many where the sizes of noise
/// are known from before.
const YOUNG: usize = 300;
const YOUNG_KNOWN: usize = 72;
/// A change that is dated among the first rows of all is none.
const FIRST: usize = 100;
const FIRST_KNOWN: usize = 36;
/// But what passes may begin with this row: it comes and goes faster than learning does.
const FIRST_PASSING: usize = 12;
/// Something is up when a lead is beyond this, though not yet what.
const SUSPECTED_NATS: f64 = 8.0;

/// Searches rows, which are in order of time and all have one; where most share theirs
/// nothing can be dated.
pub(crate) fn detect(observations: &[Observation], given: &Given<'_>) -> Told {
    if !are_times_believed(observations) {
        return Told::default();
    }
    let Some(learnt) = Learnt::first(observations, given.prior, given.levels) else {
        return Told::default();
    };
    let mut search = Search::new(observations, given, learnt);
    for k in 0..observations.len() {
        search.step(k);
    }
    search.finish()
}

struct Search<'a> {
    observations: &'a [Observation],
    stations: Vec<Station>,
    reported: &'a [Timestamp],
    cargo: &'a [Loaded],
    prior: &'a Prior,
    /// Whether the sizes of noise were known before the rows.
    is_known: bool,
    levels: NoiseLevels,
    noise: Noise,
    /// What rows are linearised at until the filter itself knows.
    start: Unknowns,
    start_until: usize,
    /// Where the present stretch of learning began, and which comes next.
    learn_from: usize,
    lesson: Lesson,
    /// Days that the levels were learnt from.
    learnt_days: f64,
    null: Filter,
    bank: Bank,
    spawned: usize,
    /// What the ship was before steps, and where she may have become it again.
    calls: Calls,
    ports: Ports,
    /// A reference's fault that goes on, if one does: its place in the list of
    /// events, and the filter before.
    misled: Option<(usize, Filter)>,
    /// The same of a compass's zero that moved, if nothing else has changed since.
    misaligned: Option<(usize, Filter)>,
    unsettled: Unsettled,
    /// What else the last step may have been.
    rivals: Vec<Rival>,
    /// That it may be none.
    doubt: Option<Doubt>,
    /// The burst that goes on, if one does.
    burst: Option<usize>,
    /// The filter before the last burst that was told, and its first row, as long as nothing
    /// that lasts was.
    passed: Option<(usize, Filter)>,
    /// A disturbance that leads by too little to be told.
    faint: Option<Faint>,
    events: Vec<Event>,
}

impl<'a> Search<'a> {
    fn new(observations: &'a [Observation], given: &Given<'a>, learnt: Learnt) -> Search<'a> {
        Search {
            observations,
            stations: stations(observations),
            reported: given.reported,
            cargo: given.cargo,
            prior: given.prior,
            is_known: given.levels.is_some(),
            null: Filter::new(given.prior, &learnt.noise),
            levels: learnt.levels,
            noise: learnt.noise,
            start: learnt.unknowns,
            start_until: learnt.until,
            learn_from: 0,
            lesson: Lesson::next(observations, 0, learnt.until, 0.0),
            learnt_days: 0.0,
            bank: Bank::default(),
            spawned: 0,
            calls: Calls::default(),
            ports: Ports::default(),
            misled: None,
            misaligned: None,
            unsettled: Unsettled::default(),
            rivals: Vec::new(),
            doubt: None,
            burst: None,
            passed: None,
            faint: None,
            events: Vec::new(),
        }
    }

    fn step(&mut self, k: usize) {
        if k >= self.lesson.at {
            self.learn(k);
        }
        if k == self.first() {
            self.bank.forget_lasting();
        }
        let is_due = k >= FIRST_PASSING && self.is_due(k);
        if is_due {
            self.settle_burst(k);
        }
        let m = self.next(k);
        if is_due || (k >= FIRST_PASSING && self.is_astray(k, &m)) {
            let earlier = earlier(self.misled.as_ref(), self.misaligned.as_ref(), &self.calls);
            let known = (earlier, self.is_call(k));
            self.bank.spawn(k, &self.null, &self.noise, known);
            self.spawned = k;
        }
        if self.is_call(k) || self.is_said_discharged(k) {
            let said = self.said_at(k);
            self.calls.call(k, &self.null, usize::MAX, said);
        }
        if self.is_call(k) {
            self.ports.call(k, &self.null);
        }
        let surprise = self.null.take(&m, &self.noise, None);
        let mut calls = std::mem::take(&mut self.calls);
        calls.take(|at| self.measure(k, at), &self.noise, &self.null);
        self.calls = calls;
        self.take_in_rivals(k);
        self.take_in_doubt(k);
        let earlier = earlier(self.misled.as_ref(), self.misaligned.as_ref(), &self.calls);
        let null = (&self.null, surprise);
        self.bank.take(k, m, &self.noise, null, earlier);
        let mut bank = std::mem::take(&mut self.bank);
        bank.take_large(k, &self.noise, |row, at| self.measure(row, at));
        self.bank = bank;
        if k >= FIRST_PASSING {
            self.judge(k);
            self.settle_faint(k, false);
        }
    }

    fn first(&self) -> usize {
        if self.is_known { FIRST_KNOWN } else { FIRST }
    }

    fn young(&self) -> usize {
        if self.is_known { YOUNG_KNOWN } else { YOUNG }
    }

    /// Steps', references', bursts' (those that are over, too) and returns' best.
    fn leads(&self) -> Leads {
        [
            self.bank.step(&self.null),
            self.bank.reference(&self.null),
            self.bank.passing(&self.null),
            self.bank.lead(Kind::Return, &self.null),
        ]
    }

    /// Row `k` as the filter is to read it.
    fn next(&self, k: usize) -> Measurement {
        if k < self.start_until {
            return self.measure(k, &self.start);
        }
        relinearised(&self.null, &self.noise, |at| self.measure(k, at))
    }

    /// Where row `k` is linearised.
    fn point(&self, k: usize) -> Unknowns {
        if k < self.start_until {
            self.start
        } else {
            self.null.unknowns()
        }
    }

    fn measure(&self, k: usize, at: &Unknowns) -> Measurement {
        self.measure_drifting(k, at, 0.0)
    }

    /// The same for a ship that drifts by so much more in thirty days, variance in
    /// population units.
    fn measure_drifting(&self, k: usize, at: &Unknowns, drift: f64) -> Measurement {
        let unsettled = self.unsettled.variance(self.observations, k);
        let seen = (DRIFTS_UNSEEN_S / self.seconds(k)).min(1.0);
        self.measured(k, at, unsettled.max(seen * drift))
    }

    /// The same for a ship that drifts as ships do.
    fn measure_settled(&self, k: usize, at: &Unknowns) -> Measurement {
        self.measured(k, at, 0.0)
    }

    fn measured(&self, k: usize, at: &Unknowns, unsettled: f64) -> Measurement {
        let (o, station) = (&self.observations[k], &self.stations[k]);
        let row = row(o, station, &Point::at(at, fusion(at)));
        measurement(station, &row, at, self.seconds(k), &self.noise, unsettled)
    }

    /// Since the row before.
    fn seconds(&self, k: usize) -> f64 {
        let earlier = k.checked_sub(1).and_then(|j| self.observations[j].time);
        match (earlier, self.observations[k].time) {
            (Some(earlier), Some(time)) => time.seconds_since(earlier).max(0.0),
            _ => 0.0,
        }
    }

    fn is_due(&self, k: usize) -> bool {
        let reported = || {
            let Some((before, now)) = k
                .checked_sub(1)
                .and_then(|j| self.observations[j].time)
                .zip(self.observations[k].time)
            else {
                return false;
            };
            self.reported.iter().any(|t| before < *t && *t <= now)
        };
        k >= self.spawned + EVERY || (k > 0 && self.seconds(k) > GAP_S) || reported()
    }

    /// Whether something may have happened just before this row.
    fn is_astray(&self, k: usize, m: &Measurement) -> bool {
        k >= self.spawned + ASTRAY_ROWS && self.null.z_squared(m) > ASTRAY_SD * ASTRAY_SD
    }

    /// The sizes of noise again, from the longer stretch there is now.
    fn learn(&mut self, k: usize) {
        let rows = self.learn_from..k;
        if let Some(learnt) = Learnt::of(self.observations, rows, self.prior, Some(&self.levels)) {
            self.levels = learnt.levels;
            self.noise = learnt.noise;
        }
        self.learnt_days = self.lesson.days;
        self.lesson = Lesson::next(self.observations, self.learn_from, k, 0.0);
    }

    fn is_call(&self, k: usize) -> bool {
        at_port(self.observations, k) == Some(true)
    }

    /// A filter over some rows, all linearised at one point.
    fn run(&self, mut filter: Filter, rows: std::ops::Range<usize>, at: &Unknowns) -> Filter {
        for k in self.calm(rows) {
            filter.take(&self.measure(k, at), &self.noise, None);
        }
        filter
    }

    /// Those rows in which nothing was astray that passed.
    fn calm(&self, rows: std::ops::Range<usize>) -> impl Iterator<Item = usize> {
        let passed = self.events.iter().filter(|event| event.what == What::Burst);
        let passed = passed.filter_map(|burst| Some(burst.first..=burst.last?));
        let passed: Vec<_> = passed.filter(|p| *p.end() >= rows.start).collect();
        rows.filter(move |row| !passed.iter().any(|passed| passed.contains(row)))
    }

    /// What is suspected when the rows end.
    fn finish(mut self) -> Told {
        let leads = self.leads();
        let perhaps = self.candidate(&leads).map(|candidate| Perhaps {
            of: candidate.event,
            first: candidate.at,
            probability: candidate.any,
        });
        let returned = perhaps.map_or(0.0, |perhaps| perhaps.probability);
        let unnoticed = self.unnoticed(&leads, returned);
        let open_nt2 = self.open_nt2(&leads);
        self.note_zeros();
        self.suspect();
        self.settle_faint(self.observations.len().saturating_sub(1), true);
        Told {
            events: self.events,
            perhaps,
            unnoticed,
            open_nt2,
            is_watched: true,
        }
    }

    fn suspect(&mut self) {
        let Some(k) = self.observations.len().checked_sub(1) else {
            return;
        };
        if let Some(event) = self.burst {
            let last = self.last_astray(self.events[event].first, k + 1);
            self.events[event].last = (last + EVERY < k).then_some(last);
            return;
        }
        let leads = self.leads();
        let nats = |kind: Kind| leads[kind as usize].map_or(0.0, |lead| lead.nats);
        let likeliest = [Kind::Step, Kind::Reference, Kind::Burst]
            .into_iter()
            .max_by(|a, b| nats(*a).total_cmp(&nats(*b)))
            .filter(|kind| nats(*kind) > SUSPECTED_NATS);
        // A burst that has had its time keeps its lead.
        let is_news = |lead: Lead| self.has_time_left(self.bank.spawns[lead.spawn].at, k);
        let Some((kind, lead)) = likeliest.and_then(|kind| Some((kind, leads[kind as usize]?)))
        else {
            return;
        };
        if k < self.young() || (kind == Kind::Burst && !is_news(lead)) {
            return;
        }
        let what = match kind {
            Kind::Reference => What::Reference,
            Kind::Burst => What::Burst,
            _ => What::Step,
        };
        let spawn = &self.bank.spawns[lead.spawn];
        let first = spawn.at;
        let filters = spawn
            .copy(lead.kind)
            .map(|f| (spawn.origin().clone(), f.clone()));
        let change = filters.as_ref().map(|(before, after)| (before, after));
        self.push(k, what, first, (first, first), leads, change);
        if let Some(event) = self.events.last_mut() {
            event.confirmed = false;
        }
    }
}

/// What may be again what it was: a reference first, which is soon mended; then what
/// changed last.
fn earlier<'a>(
    misled: Option<&'a (usize, Filter)>,
    misaligned: Option<&'a (usize, Filter)>,
    calls: &'a Calls,
) -> Option<Earlier<'a>> {
    let reference = misled.map(|(_, before)| Earlier::Reference(before));
    let zero = || misaligned.map(|(_, before)| Earlier::Zero(before));
    let ship = || calls.bases.last().map(|base| Earlier::Ship(base.unladen()));
    reference.or_else(zero).or_else(ship)
}

/// The likeliest copies by kind, in the order of [`Kind`].
type Leads = [Option<Lead>; 4];
