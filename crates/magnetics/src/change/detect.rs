//! The search: one filter runs forward over the rows, a bank of what else may have
//! happened beside it, and what proves likelier by far takes its place.
//!
//! What always holds: a row is read once in order of time and nothing later than it
//! decides what it tells; every event lies between two rows; the search ends.

use super::bank::{BURST_S, Bank, Earlier, Kind, Lead, misled, upset};
use super::calls::{Base, Calls, Candidate};
use super::filter::{Filter, Measurement, Noise, VARIATION, measurement};
use crate::angle::wrap_180;
use crate::estimate::{
    NoiseLevels, POPULATION_SD, Prior, Station, USUAL_FUSION, Unknowns, row, stations,
};
use crate::fit::{Observation, learn};
use crate::model::{Covariance, Parameters};
use crate::ship::PARAMETERS;
use crate::time::Timestamp;

/// Rows between times that are tried: about an hour of sailing.
const EVERY: usize = 6;
/// After a gap of this the next row is a time to be tried, whatever the count.
const GAP_S: f64 = 2.0 * 3600.0;
/// Days of data from which the sizes of noise are learnt, again and again.
const LEARN_DAYS: [f64; 4] = [10.0, 20.0, 40.0, 80.0];
const DAY_S: f64 = 86_400.0;
/// Before so many rows no change is told from learning.
const YOUNG: usize = 300;
/// A change that is dated among the first rows of all is none.
const FIRST: usize = 100;
/// A step must be likelier by this than a burst, nats; or by that, when its lead
/// over nothing is large.
const STEP_NATS: f64 = 10.0;
const STEP_AT_LEAST: f64 = 3.0;
const LARGE_NATS: f64 = 40.0;
/// And it must have lasted for so many rows: the flank of an anomaly is as steep.
const STEP_ROWS: usize = 6;
/// While one of two references is out of use for more than this share of the rows,
/// it must be likelier by that: the one that is left may be the one that fails.
const ONE_REFERENCE_SHARE: f64 = 0.3;
const ONE_REFERENCE_NATS: f64 = 30.0;
/// A reference's step must be likelier by this than a burst.
const REFERENCE_NATS: f64 = 12.0;
/// So must a return to what was before, away from port.
const RETURN_AT_SEA_NATS: f64 = 14.0;
/// A return at a port call is believed when it is as likely as this, and unlikelier
/// than a step to something else by no more than that, nats.
const RETURNED: f64 = 0.9;
const RETURN_BELOW_STEP: f64 = 6.0;
/// A burst is unlikelier beforehand than a return at a port call by about this, nats.
const BURST_BELOW_RETURN: f64 = 3.0;
/// With one reference a step of the ship and one of the reference must differ by
/// this; with both there were two readings among so many rows.
const CLEAR_NATS: f64 = 4.0;
const LATELY: usize = 36;
/// A reference that is itself again must be likelier by this than a burst, and no
/// less likely by this than another change.
const MENDED_NATS: f64 = 8.0;
const MENDED_BELOW: f64 = 3.0;
/// A burst must be likelier by this than nothing, and by this than a change.
const BURST_NATS: f64 = 9.0;
const BURST_OVER_STEP: f64 = 3.0;
/// And by this than a change for the filter to be that of the burst.
const BURST_FOR_CERTAIN: f64 = 6.0;
/// A burst has been over for this long when its filter takes over.
const SETTLED_S: f64 = 6.0 * 3600.0;
/// Something is up when a lead is beyond this, though not yet what.
const SUSPECTED_NATS: f64 = 8.0;
/// The variation is astray while it is off by more than this, degrees at 24 µT.
const ASTRAY_DEG: f64 = 0.7;
/// Times tried for the date of a change, in each of two rounds.
const DATES: usize = 40;
/// Those less likely than the best by this or more are no date of it, nats.
const DATE_NATS: f64 = 1.92;

/// A step is dated at one of the last port calls, back to so many spawned times
/// before its own, if that is less likely than the likeliest row by no more, nats.
const CALLS: usize = 3;
const CALL_SPAWNS: usize = 3;
const CALL_NATS: f64 = 4.0;

/// What the search is told beside the rows.
pub(crate) struct Given<'a> {
    pub(crate) prior: &'a Prior,
    /// Times at which people say that something happened.
    pub(crate) reported: &'a [Timestamp],
}

/// The ship's seven parameters as a filter had them.
#[derive(Clone, Debug)]
pub(crate) struct Snapshot {
    pub(crate) parameters: Parameters,
    /// Of the parameters and the constant.
    pub(crate) covariance: Covariance,
}

/// What an event is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum What {
    Step,
    Reference,
    Burst,
    /// The ship is again as she was before the event of this place in the list.
    Return(usize),
}

/// Something that happened, found among the rows.
#[derive(Clone, Debug)]
pub(crate) struct Event {
    pub(crate) what: What,
    /// The first row after it, and the first and last that may be.
    pub(crate) first: usize,
    pub(crate) between: (usize, usize),
    /// The row that told.
    pub(crate) told: usize,
    /// Leads over nothing having happened, nats, by kind.
    pub(crate) leads: [f64; 4],
    /// Before and when it was told.
    pub(crate) before: Snapshot,
    pub(crate) after: Snapshot,
    /// The last row of a burst, once it is over.
    pub(crate) last: Option<usize>,
    /// Whether it is certain.
    pub(crate) confirmed: bool,
}

/// What the rows tell.
#[derive(Clone, Debug, Default)]
pub(crate) struct Told {
    pub(crate) events: Vec<Event>,
    /// A return that may have been, and is not among the events.
    pub(crate) perhaps: Option<Perhaps>,
}

/// Something that is as yet neither likely enough to be believed nor unlikely
/// enough to be forgotten.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Perhaps {
    /// The event that would have ended.
    pub(crate) of: usize,
    /// The first row after its end.
    pub(crate) first: usize,
    pub(crate) probability: f64,
}

/// Searches rows, which are in order of time and all have one.
pub(crate) fn detect(observations: &[Observation], given: &Given<'_>) -> Told {
    let Some(learnt) = Learnt::first(observations, given.prior) else {
        return Told::default();
    };
    let mut search = Search::new(observations, given, learnt);
    for k in 0..observations.len() {
        search.step(k);
    }
    search.finish()
}

/// What a stretch of rows told.
#[derive(Clone, Copy)]
struct Learnt {
    levels: NoiseLevels,
    noise: Noise,
    unknowns: Unknowns,
    /// Rows that it was of.
    until: usize,
}

impl Learnt {
    /// From the first days that suffice.
    fn first(observations: &[Observation], prior: &Prior) -> Option<Learnt> {
        LEARN_DAYS.iter().find_map(|days| {
            let until = rows_within(observations, 0, *days);
            Learnt::of(observations, 0..until, prior, None)
        })
    }

    /// From `rows`, beginning with the levels learnt before.
    fn of(
        observations: &[Observation],
        rows: std::ops::Range<usize>,
        prior: &Prior,
        before: Option<&NoiseLevels>,
    ) -> Option<Learnt> {
        let until = rows.end;
        let rough = learn(&observations[rows], prior, before)?;
        let noise = Noise::new(&NoiseLevels {
            drift_nt: rough.levels.drift_nt.max(NoiseLevels::TYPICAL.drift_nt),
            ..rough.levels
        });
        let mut mean = [rough.constant_deg; PARAMETERS + 1];
        mean[..PARAMETERS].copy_from_slice(&rough.parameters.to_array());
        let known = Prior {
            mean,
            covariance: prior.covariance,
        };
        Some(Learnt {
            levels: rough.levels,
            noise,
            unknowns: Filter::new(&known, &noise).unknowns(),
            until,
        })
    }
}

/// The row at which levels are learnt again that were learnt at row `k`, of those
/// from row `from` on.
fn next_lesson(observations: &[Observation], from: usize, k: usize) -> usize {
    let lessons = LEARN_DAYS.iter();
    let mut lessons = lessons.map(|days| rows_within(observations, from, *days));
    lessons.find(|&row| row > k).unwrap_or(usize::MAX)
}

/// The row after the last within `days` of row `from`.
fn rows_within(observations: &[Observation], from: usize, days: f64) -> usize {
    let start = observations.get(from).and_then(|o| o.time);
    from + observations[from..].partition_point(|o| match (o.time, start) {
        (Some(time), Some(start)) => time.seconds_since(start) <= days * DAY_S,
        _ => true,
    })
}

/// A port call is a gap of at least this without going further than that.
const PORT_S: f64 = 3.0 * 3600.0;
const PORT_NM: f64 = 40.0;

/// Whether the ship lay somewhere just before the row.
pub(crate) fn at_port(observations: &[Observation], row: usize) -> Option<bool> {
    let (a, b) = (&observations[row.checked_sub(1)?], &observations[row]);
    let gap_s = b.time?.seconds_since(a.time?);
    let (a, b) = (a.position?, b.position?);
    let north = a.lat_deg() - b.lat_deg();
    let east = wrap_180(a.lon_deg() - b.lon_deg()) * a.lat_deg().to_radians().cos();
    Some(gap_s > PORT_S && 60.0 * north.hypot(east) < PORT_NM)
}

struct Search<'a> {
    observations: &'a [Observation],
    stations: Vec<Station>,
    reported: &'a [Timestamp],
    prior: &'a Prior,
    levels: NoiseLevels,
    noise: Noise,
    /// What rows are linearised at until the filter itself knows.
    start: Unknowns,
    start_until: usize,
    /// Where the present stretch of learning began, and which comes next.
    learn_from: usize,
    learn_next: usize,
    null: Filter,
    bank: Bank,
    spawned: usize,
    /// What the ship was before steps, and where she may have become it again.
    calls: Calls,
    /// A reference's fault that goes on, if one does: its place in the list of
    /// events, and the filter before.
    misled: Option<(usize, Filter)>,
    /// The burst that goes on, if one does.
    burst: Option<usize>,
    events: Vec<Event>,
}

impl<'a> Search<'a> {
    fn new(observations: &'a [Observation], given: &Given<'a>, learnt: Learnt) -> Search<'a> {
        Search {
            observations,
            stations: stations(observations),
            reported: given.reported,
            prior: given.prior,
            null: Filter::new(given.prior, &learnt.noise),
            levels: learnt.levels,
            noise: learnt.noise,
            start: learnt.unknowns,
            start_until: learnt.until,
            learn_from: 0,
            learn_next: next_lesson(observations, 0, learnt.until),
            bank: Bank::default(),
            spawned: 0,
            calls: Calls::default(),
            misled: None,
            burst: None,
            events: Vec::new(),
        }
    }

    fn step(&mut self, k: usize) {
        if k >= self.learn_next {
            self.learn(k);
        }
        if k >= FIRST && self.is_due(k) {
            self.settle_burst(k);
            let earlier = earlier(self.misled.as_ref(), &self.calls);
            self.bank.spawn(k, &self.null, earlier);
            self.spawned = k;
        }
        if self.is_call(k) {
            self.calls.call(k, &self.null, usize::MAX);
        }
        let at = self.point(k);
        let m = self.measure(k, &at);
        self.null.take(&m, &self.noise, None);
        self.calls.take(&m, &self.noise, &self.null);
        let earlier = earlier(self.misled.as_ref(), &self.calls);
        self.bank.take(k, m, &self.noise, (&self.null, earlier));
        if k >= YOUNG {
            self.judge(k);
        }
    }

    /// Steps', references', bursts' (those that are over, too) and returns' best.
    fn leads(&self) -> Leads {
        [
            self.bank.lead(Kind::Step, &self.null),
            self.bank.lead(Kind::Reference, &self.null),
            self.bank.passing(&self.null),
            self.bank.lead(Kind::Return, &self.null),
        ]
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
        let (o, station) = (&self.observations[k], &self.stations[k]);
        let row = row(o, station, at, USUAL_FUSION);
        measurement(station, &row, at, self.seconds(k), &self.noise)
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

    /// The sizes of noise again, from the longer stretch there is now.
    fn learn(&mut self, k: usize) {
        let rows = self.learn_from..k;
        if let Some(learnt) = Learnt::of(self.observations, rows, self.prior, Some(&self.levels)) {
            self.levels = learnt.levels;
            self.noise = learnt.noise;
        }
        self.learn_next = next_lesson(self.observations, self.learn_from, k);
    }

    fn judge(&mut self, k: usize) {
        let leads = self.leads();
        let nats = |kind: Kind| leads[kind as usize].map_or(0.0, |lead| lead.nats);
        let burst = nats(Kind::Burst).max(0.0);
        let back = nats(Kind::Return);
        if let Some(candidate) = self.candidate(&leads)
            && candidate.probability > RETURNED
        {
            return self.adopt_call(k, candidate, leads);
        }
        let rival = nats(Kind::Step).max(nats(Kind::Reference));
        if self.misled.is_some() && back - burst > MENDED_NATS && back > rival - MENDED_BELOW {
            return self.adopt_mended(k, leads);
        }
        if self.misled.is_none() && back - burst > RETURN_AT_SEA_NATS && back > nats(Kind::Step) {
            return self.adopt_return(k, leads);
        }
        let (kind, lasting, other) = if nats(Kind::Step) >= nats(Kind::Reference) {
            (Kind::Step, nats(Kind::Step), nats(Kind::Reference))
        } else {
            (Kind::Reference, nats(Kind::Reference), nats(Kind::Step))
        };
        let over_burst = lasting - burst;
        // One reference on one heading cannot tell a fault of its own from a change
        // of the ship.
        let is_clear = lasting - other.max(0.0) > CLEAR_NATS || self.has_both(k);
        let is_told = is_clear
            && match kind {
                Kind::Reference => over_burst > REFERENCE_NATS,
                _ => self.has_lasted(k, &leads) && self.is_step(k, lasting, over_burst, &leads),
            };
        if is_told {
            return self.adopt(k, kind, leads);
        }
        if self.burst.is_none() && burst > BURST_NATS && burst - lasting > BURST_OVER_STEP {
            let Some(lead) = leads[Kind::Burst as usize] else {
                return;
            };
            let spawn = &self.bank.spawns[lead.spawn];
            let first = spawn
                .astray_from
                .filter(|_| self.is_over(lead))
                .unwrap_or(spawn.at);
            // One that has had its time keeps its lead, but is told once.
            let same = |event: &Event| event.what == What::Burst && event.first + EVERY >= first;
            if self.events.last().is_some_and(same) {
                return;
            }
            self.burst = Some(self.events.len());
            self.push(k, What::Burst, first, (first, first), leads, None);
        }
    }

    fn has_lasted(&self, k: usize, leads: &Leads) -> bool {
        leads[Kind::Step as usize]
            .is_some_and(|lead| k + 1 >= self.bank.spawns[lead.spawn].at + STEP_ROWS)
    }

    fn is_step(&self, k: usize, lead: f64, over_burst: f64, leads: &Leads) -> bool {
        if over_burst <= STEP_AT_LEAST || (over_burst <= STEP_NATS && lead <= LARGE_NATS) {
            return false;
        }
        let since = leads[Kind::Step as usize].map_or(k, |lead| self.bank.spawns[lead.spawn].at);
        let with_one = |rows: &[Observation]| {
            let one = rows.iter().filter(|o| o.gyro_less_satellite_deg.is_none());
            one.count() as f64 > ONE_REFERENCE_SHARE * rows.len() as f64
        };
        let usually = &self.observations[..since.max(1)];
        let is_half_blind = with_one(&self.observations[since..=k]) && !with_one(usually);
        over_burst > ONE_REFERENCE_NATS || !is_half_blind
    }

    /// The likeliest return at a port call, if a step to something else is not
    /// likelier by far.
    fn candidate(&self, leads: &Leads) -> Option<Candidate> {
        let nats = |kind: Kind| leads[kind as usize].map_or(0.0, |lead| lead.nats);
        let rival = (nats(Kind::Burst) - BURST_BELOW_RETURN).max(0.0);
        let likeliest = self.calls.likeliest(&self.null, rival)?;
        (likeliest.nats > nats(Kind::Step) - RETURN_BELOW_STEP).then_some(likeliest)
    }

    /// Whether both references were read lately.
    fn has_both(&self, k: usize) -> bool {
        let lately = &self.observations[k.saturating_sub(LATELY)..=k];
        lately.iter().any(|o| o.gyro_less_satellite_deg.is_some())
    }

    fn is_call(&self, k: usize) -> bool {
        at_port(self.observations, k) == Some(true)
    }

    /// Whether a passing disturbance's lead is that of one that is over.
    fn is_over(&self, lead: Lead) -> bool {
        let over = self.bank.lead(Kind::Over, &self.null);
        over.is_some_and(|over| over.spawn == lead.spawn && over.nats >= lead.nats)
    }

    /// The ship's magnetism or a reference changed: the copy that knew takes over.
    fn adopt(&mut self, k: usize, kind: Kind, leads: Leads) {
        let Some(lead) = leads[kind as usize] else {
            return;
        };
        let dated = self.date(lead.spawn, kind, k);
        let before = self.bank.spawns[dated.from].origin.clone();
        let before = self.run(
            before,
            dated.at_spawn..dated.first,
            &dated.filter.unknowns(),
        );
        self.supersede_burst(dated.first);
        let what = match kind {
            Kind::Step => What::Step,
            _ => self
                .misled
                .take_if(|(_, before)| dated.filter.has_constant_of(before))
                .map_or(What::Reference, |(event, _)| What::Return(event)),
        };
        self.push(
            k,
            what,
            dated.first,
            dated.between,
            leads,
            Some((&before, &dated.filter)),
        );
        if kind == Kind::Step {
            self.retrace(k, &dated, &before);
        } else if what == What::Reference && self.misled.is_none() {
            self.misled = Some((self.events.len() - 1, before));
        }
        self.take_over(k, dated.filter, dated.first);
    }

    /// The port calls since a step, and the one at which it happened, as the filter
    /// that knows of the step would have met them.
    fn retrace(&mut self, k: usize, dated: &Dated, before: &Filter) {
        let event = self.events.len() - 1;
        let (earliest, latest) = dated.between;
        let base = Base {
            event,
            filter: before.clone(),
            at_port: (earliest..=latest).any(|row| self.is_call(row)),
        };
        self.calls.step(base);
        let at = dated.filter.unknowns();
        if self.is_call(dated.first) {
            self.calls.call(dated.first, before, event);
        }
        let mut since = upset(before, Kind::Step);
        for row in dated.first..=k {
            if row > dated.first && self.is_call(row) {
                self.calls.call(row, &since, usize::MAX);
            }
            let m = self.measure(row, &at);
            since.take(&m, &self.noise, None);
            self.calls.take_since(dated.first, &m, &self.noise);
        }
    }

    /// A burst that went on until now ended where a change is dated; if it began
    /// there too, it was the change's first sign and nothing else.
    fn supersede_burst(&mut self, first: usize) {
        let Some(event) = self.burst.take() else {
            return;
        };
        if self.events[event].first + 2 * EVERY >= first {
            self.events.remove(event);
        } else {
            self.events[event].last = Some(first - 1);
        }
    }

    fn adopt_return(&mut self, k: usize, leads: Leads) {
        let Some((lead, base)) = leads[Kind::Return as usize].zip(self.calls.bases.last()) else {
            return;
        };
        let event = base.event;
        let dated = self.date(lead.spawn, Kind::Return, k);
        let before = self.bank.spawns[lead.spawn].origin.clone();
        self.supersede_burst(dated.first);
        self.push(
            k,
            What::Return(event),
            dated.first,
            dated.between,
            leads,
            Some((&before, &dated.filter)),
        );
        self.calls.returned(event);
        self.take_over(k, dated.filter, dated.first);
    }

    /// The reference is itself again.
    fn adopt_mended(&mut self, k: usize, leads: Leads) {
        let Some(lead) = leads[Kind::Return as usize] else {
            return;
        };
        let dated = self.date(lead.spawn, Kind::Return, k);
        let before = self.bank.spawns[lead.spawn].origin.clone();
        self.supersede_burst(dated.first);
        let Some((event, _)) = self.misled.take() else {
            return;
        };
        self.push(
            k,
            What::Return(event),
            dated.first,
            dated.between,
            leads,
            Some((&before, &dated.filter)),
        );
        self.take_over(k, dated.filter, dated.first);
    }

    /// The ship has been herself again since a port call.
    fn adopt_call(&mut self, k: usize, back: Candidate, leads: Leads) {
        self.supersede_burst(back.at);
        // What was taken for a step to something else was this.
        let mut places = 0..;
        self.events.retain(|event| {
            let is_later = places.next().is_some_and(|place| place > back.event);
            let is_past = matches!(event.what, What::Burst | What::Reference);
            !is_later || is_past || event.between.1 < back.at
        });
        let before = self.null.clone();
        self.push(
            k,
            What::Return(back.event),
            back.at,
            (back.at, back.at),
            leads,
            Some((&before, &back.filter)),
        );
        self.calls.returned(back.event);
        self.take_over(k, back.filter, back.at);
    }

    fn take_over(&mut self, k: usize, filter: Filter, first: usize) {
        self.null = filter;
        self.bank.clear();
        self.spawned = k;
        self.learn_from = first;
        self.learn_next = rows_within(self.observations, first, LEARN_DAYS[0]);
    }

    fn push(
        &mut self,
        k: usize,
        what: What,
        first: usize,
        between: (usize, usize),
        leads: Leads,
        change: Option<(&Filter, &Filter)>,
    ) {
        let (before, after) = change.unwrap_or((&self.null, &self.null));
        let event = Event {
            what,
            first,
            between,
            told: k.max(self.start_until.saturating_sub(1)),
            leads: leads.map(|lead| lead.map_or(0.0, |lead| lead.nats)),
            before: snapshot(before),
            after: snapshot(after),
            last: None,
            confirmed: true,
        };
        self.events.push(event);
    }

    /// Once a burst has had its time, the filter that knew of it takes over if it is
    /// still the likelier, so that the burst does not pass for the ship's.
    fn settle_burst(&mut self, k: usize) {
        let age_s = |row: usize| match (self.observations[row].time, self.observations[k].time) {
            (Some(then), Some(now)) => now.seconds_since(then),
            _ => 0.0,
        };
        let leads = self.leads();
        let nats = |kind: Kind| leads[kind as usize].map_or(0.0, |lead| lead.nats);
        let others = [Kind::Step, Kind::Reference, Kind::Return].map(nats);
        let others = others.into_iter().fold(0.0, f64::max);
        let knew = self.bank.lead(Kind::Over, &self.null).filter(|lead| {
            age_s(self.bank.spawns[lead.spawn].at) >= SETTLED_S
                && lead.nats > others + BURST_FOR_CERTAIN
        });
        let knew = knew.map(|lead| &self.bank.spawns[lead.spawn]);
        let knew = knew.and_then(|spawn| Some((spawn.at, spawn.copy(Kind::Over)?.clone())));
        let is_over = self
            .burst
            .is_some_and(|event| age_s(self.events[event].first) >= 1.2 * BURST_S);
        if knew.is_none() && !is_over {
            return;
        }
        if let Some(event) = self.burst.take() {
            let first = self.events[event].first;
            let until = knew.as_ref().map_or(k, |(until, _)| *until);
            self.events[event].last = Some(self.last_astray(first, until));
        }
        if let Some((_, filter)) = knew {
            self.null = filter;
            self.bank.clear();
            self.spawned = k;
        }
    }

    /// The last row from `first` to `k` at which a filter that expects a burst found
    /// the variation astray.
    fn last_astray(&self, first: usize, k: usize) -> usize {
        let Some(spawn) = self.bank.spawns.iter().rfind(|s| s.at <= first) else {
            return first;
        };
        let mut filter = upset(&spawn.origin, Kind::Burst);
        let at = self.null.unknowns();
        let mut last = first;
        for row in spawn.at..k {
            let m = self.measure(row, &at);
            filter.take(&m, &self.noise, Some(&super::bank::BURST));
            if row >= first && filter.mean[VARIATION].abs() > ASTRAY_DEG {
                last = row;
            }
        }
        last
    }

    /// A filter over some rows, all linearised at one point.
    fn run(&self, mut filter: Filter, rows: std::ops::Range<usize>, at: &Unknowns) -> Filter {
        for k in rows {
            filter.take(&self.measure(k, at), &self.noise, None);
        }
        filter
    }

    /// When it happened, to the row.
    fn date(&self, winner: usize, kind: Kind, k: usize) -> Dated {
        let spawns = &self.bank.spawns;
        let from = winner.saturating_sub(1);
        let origin = &spawns[from];
        let until = spawns.get(winner + 1).map_or(k, |s| s.at);
        let earlier = earlier(self.misled.as_ref(), &self.calls);
        let began = |filter: &Filter, row: usize, at: &Unknowns| match (kind, earlier) {
            (Kind::Return, Some(earlier)) => earlier.again(filter),
            (Kind::Reference, _) => misled(filter, &self.measure(row, at)),
            _ => upset(filter, kind),
        };
        // Twice, for the rows are to be linearised at where the ship is now.
        let mut at = self.point(k);
        let mut best = (origin.at, began(&origin.origin, origin.at, &at));
        let mut likely = Vec::new();
        for round in 0..2 {
            let (low, high) = if round == 0 {
                (origin.at, until)
            } else {
                let stride = (until - origin.at) / DATES + 1;
                let low = best.0.saturating_sub(stride).max(origin.at);
                (low, (best.0 + stride).min(until))
            };
            let stride = (high - low) / DATES + 1;
            let mut before = self.run(origin.origin.clone(), origin.at..low, &at);
            let mut tried: Vec<(usize, Filter)> = Vec::new();
            let mut row = low;
            while row <= high.min(k) {
                let filter = self.run(began(&before, row, &at), row..k + 1, &at);
                tried.push((row, filter));
                let next = row + stride;
                before = self.run(before, row..next.min(k + 1), &at);
                row = next;
            }
            likely.extend(tried.iter().map(|(row, f)| (round, *row, f.log_likelihood)));
            if let Some(found) = tried
                .into_iter()
                .max_by(|a, b| a.1.log_likelihood.total_cmp(&b.1.log_likelihood))
            {
                best = found;
            }
            at = best.1.unknowns();
        }
        let (first, filter) = best;
        if kind == Kind::Step
            && let Some(dated) = self.date_at_call(winner, &filter, first, k)
        {
            return dated;
        }
        let near = |round: usize| {
            let of_round = likely.iter().filter(move |(r, _, _)| *r == round);
            let most = of_round
                .clone()
                .map(|x| x.2)
                .fold(f64::NEG_INFINITY, f64::max);
            of_round
                .filter(move |x| x.2 > most - DATE_NATS)
                .map(|x| x.1)
                .collect::<Vec<_>>()
        };
        let rows: Vec<usize> = near(0).into_iter().chain(near(1)).chain([first]).collect();
        let earliest = rows.iter().copied().min().unwrap_or(first);
        let latest = rows.iter().copied().max().unwrap_or(first);
        Dated {
            first,
            between: (earliest, latest),
            filter,
            from,
            at_spawn: origin.at,
        }
    }

    /// Whether it rather happened at a port call: many more steps do than at any one
    /// time at sea. `filter` is of the likeliest row.
    fn date_at_call(&self, winner: usize, filter: &Filter, row: usize, k: usize) -> Option<Dated> {
        let spawns = &self.bank.spawns;
        let from = winner.saturating_sub(CALL_SPAWNS);
        let origin = &spawns[from];
        let until = spawns.get(winner + 1).map_or(k, |s| s.at);
        let calls = (origin.at.max(1)..=until.min(k)).rev();
        let calls = calls.filter(|&row| self.is_call(row)).take(CALLS);
        let at = filter.unknowns();
        let tried = calls.map(|call| {
            let before = self.run(origin.origin.clone(), origin.at..call, &at);
            (call, self.run(upset(&before, Kind::Step), call..k + 1, &at))
        });
        let (call, filter) = tried
            .filter(|(_, at_call)| at_call.log_likelihood > filter.log_likelihood - CALL_NATS)
            .max_by(|a, b| a.1.log_likelihood.total_cmp(&b.1.log_likelihood))?;
        Some(Dated {
            first: call,
            between: (call.min(row), call.max(row)),
            filter,
            from,
            at_spawn: origin.at,
        })
    }

    /// What is suspected when the rows end.
    fn finish(mut self) -> Told {
        let leads = self.leads();
        let perhaps = self.candidate(&leads).map(|candidate| Perhaps {
            of: candidate.event,
            first: candidate.at,
            probability: candidate.any,
        });
        self.suspect();
        Told {
            events: self.events,
            perhaps,
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
        let Some((kind, lead)) = likeliest.and_then(|kind| Some((kind, leads[kind as usize]?)))
        else {
            return;
        };
        if k < YOUNG {
            return;
        }
        let what = match kind {
            Kind::Reference => What::Reference,
            Kind::Burst => What::Burst,
            Kind::Step | Kind::Return | Kind::Over => What::Step,
        };
        let spawn = &self.bank.spawns[lead.spawn];
        let first = spawn.at;
        let filters = spawn.copy(kind).map(|f| (spawn.origin.clone(), f.clone()));
        let change = filters.as_ref().map(|(before, after)| (before, after));
        self.push(k, what, first, (first, first), leads, change);
        if let Some(event) = self.events.last_mut() {
            event.confirmed = false;
        }
    }
}

/// What may be again what it was: a reference first, which is soon mended.
fn earlier<'a>(misled: Option<&'a (usize, Filter)>, calls: &'a Calls) -> Option<Earlier<'a>> {
    let reference = misled.map(|(_, before)| Earlier::Reference(before));
    let ship = || calls.bases.last().map(|base| Earlier::Ship(&base.filter));
    reference.or_else(ship)
}

/// The likeliest copies by kind, in the order of [`Kind`].
type Leads = [Option<Lead>; 4];

/// A change with its date.
struct Dated {
    first: usize,
    between: (usize, usize),
    /// The filter that knew of it, now.
    filter: Filter,
    /// The spawn that it was dated from, and that one's row.
    from: usize,
    at_spawn: usize,
}

fn snapshot(filter: &Filter) -> Snapshot {
    let mut scale = [1.0; PARAMETERS + 1];
    scale[..PARAMETERS].copy_from_slice(&POPULATION_SD);
    let mut parameters = [0.0; PARAMETERS];
    let mut covariance = [[0.0; PARAMETERS + 1]; PARAMETERS + 1];
    for i in 0..=PARAMETERS {
        if i < PARAMETERS {
            parameters[i] = filter.mean[i] * scale[i];
        }
        for j in 0..=PARAMETERS {
            covariance[i][j] = filter.covariance[i][j] * scale[i] * scale[j];
        }
    }
    Snapshot {
        parameters: Parameters::from_array(parameters),
        covariance,
    }
}
