//! The tracker: weighs accounts of what happened as rows arrive.

use super::evidence_sums::EvidenceSums;
use super::filter::Filter;
use super::hypothesis::{Begin, Event, Hypothesis, Read};
use super::kinds::{KINDS, Kind, KindRow};
use super::learning::Learning;
use super::levels::Levels;
use super::row::{Placed, Row, RowMaker};
use super::ship_state::ShipState;
use super::starts::starts;
use super::transition::Transition;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::time::Timestamp;
use std::collections::VecDeque;

/// Rows that are kept, so that an event may be supposed among them: three days.
const KEPT_ROWS: usize = 432;
/// Rows between checkpoints.
const CHECKPOINT_ROWS: usize = 6;
/// Rows of late after each of which there is a checkpoint.
const RECENT_ROWS: usize = 12;
/// Rows between looks for events, and for ends of events.
const LOOK_ROWS: usize = 2;
const END_ROWS: usize = 6;
/// Log weight below the best's at which a hypothesis is given up.
const GIVEN_UP: f64 = 16.0;
/// Most hypotheses.
const MOST_HYPOTHESES: usize = 24;
/// Starts of an event that are weighed at a time.
const STARTS: usize = 2;
/// Log posterior ratio from which an event is supposed.
const SUPPOSED: f64 = -4.0;
/// Rise of it from which an event is weighed again.
const TRIED_AGAIN: f64 = 2.0;
/// Log weight by which another hypothesis takes the lead.
const TAKES_LEAD: f64 = 1.0;
/// Rows after which the starting guesses are one.
const STARTING_ROWS: usize = 1000;
/// Seconds within which two events of a kind are the same.
const SAME_S: f64 = 6.0 * 3600.0;
/// Rows between looks for hypotheses that have become alike, and the difference of means in
/// standard deviations up to which they are.
const ALIKE_ROWS: usize = 36;
const ALIKE: f64 = 0.4;
/// Posterior probability from which an event is told, and seconds within which two accounts
/// speak of the same event.
const TOLD: f64 = 0.98;
const TOLD_SAME_S: f64 = 86_400.0;
/// Posterior probability below which a told event is withdrawn, and time for which an event
/// is told anew as more is known.
const WITHDRAWN: f64 = 0.3;
const REFRESHED_S: f64 = 20.0 * 86_400.0;
/// Greatest turn of an instrument that stood, and least of a ship that turned, degrees.
const STOOD_DEG: f64 = 2.0;
const TURNED_DEG: f64 = 10.0;
/// Log weight below the best's from which a hypothesis is left out of the mixture.
const NEGLIGIBLE: f64 = 7.0;
/// Probability that a ship is as before once the logbook says that her cargo is ashore.
const DISCHARGED: f64 = 0.7;
const YEAR_S: f64 = 365.25 * 86_400.0;

/// Filter after some row, with the sums until then.
#[derive(Clone, Debug)]
struct Checkpoint {
    after: usize,
    time: Timestamp,
    lead: Hypothesis,
    sums: EvidenceSums,
    begin: Begin,
}

/// Accounts of what happened to a ship, by the rows so far.
pub(crate) struct Tracker {
    maker: RowMaker,
    reference_sd_deg: f64,
    pub(crate) learning: Learning,
    /// Hypotheses; the first leads.
    pub(crate) bank: Vec<Hypothesis>,
    rows: VecDeque<Row>,
    /// Number of the first row kept, and of all rows.
    first_kept: usize,
    pub(crate) count: usize,
    sums: EvidenceSums,
    checkpoints: VecDeque<Checkpoint>,
    /// Events that were supposed and weighed since the lead began.
    tried: Vec<Tried>,
    pub(crate) told: Vec<Told>,
    /// Number of replays, for studies.
    pub(crate) replays: usize,
}

/// Event that was supposed once, with its log posterior ratio then.
#[derive(Clone, Copy, Debug)]
struct Tried {
    kind: Kind,
    from: Timestamp,
    score: f64,
}

/// What is told about: the ship, a reference, what passes by, or the compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    Ship,
    Reference,
    Passing,
    Compass,
}

impl Class {
    fn of(kind: Kind) -> Class {
        match kind {
            Kind::Strike | Kind::Cargo | Kind::Alignment | Kind::ShipDrift => Class::Ship,
            Kind::Storm | Kind::Anomaly => Class::Passing,
            Kind::StuckCard => Class::Compass,
            _ => Class::Reference,
        }
    }
}

/// Event that was told.
#[derive(Clone, Debug)]
pub(crate) struct Told {
    pub(crate) class: Class,
    pub(crate) event: Event,
    /// Row that made it certain.
    pub(crate) at: Timestamp,
    pub(crate) withdrawn: Option<Timestamp>,
    /// Probability of each kind, the likeliest first.
    pub(crate) kinds: Vec<(Kind, f64)>,
    pub(crate) earliest: Timestamp,
    pub(crate) latest: Timestamp,
}

/// Row as the lead predicted and read it.
pub(crate) struct Tracked {
    pub(crate) read: Read,
}

impl Tracker {
    pub(crate) fn new(reference_sd_deg: f64) -> Tracker {
        Tracker {
            maker: RowMaker::new(),
            reference_sd_deg,
            learning: Learning::new(),
            bank: Vec::new(),
            rows: VecDeque::new(),
            first_kept: 0,
            count: 0,
            sums: EvidenceSums::default(),
            checkpoints: VecDeque::new(),
            tried: Vec::new(),
            told: Vec::new(),
            replays: 0,
        }
    }

    /// Reads the next sample.
    pub(crate) fn read(&mut self, placed: &Placed<'_>) -> Option<Tracked> {
        let row = self.maker.row(placed)?;
        if self.bank.is_empty() {
            self.bank = starts(&row, self.learning.levels(), self.reference_sd_deg);
            self.learning.restart(&self.bank[0]);
        }
        self.keep_checkpoint(&row);
        if row.after_port || self.count.is_multiple_of(END_ROWS) {
            self.suppose_endings(&row);
        }
        let tracked = self.read_all(&row);
        self.rows.push_back(row);
        self.count += 1;
        if self.rows.len() > KEPT_ROWS {
            self.rows.pop_front();
            self.first_kept += 1;
            let oldest = self.rows[0].time;
            self.tried.retain(|tried| tried.from >= oldest);
            while self.checkpoints.front().is_some_and(|c| c.after < self.first_kept) {
                self.checkpoints.pop_front();
            }
        }
        if self.count.is_multiple_of(LOOK_ROWS) {
            self.suppose_events();
        }
        self.prune();
        self.tell(placed.sample.time);
        Some(tracked)
    }

    /// Returns the circumstances of what begins between the last row and the next.
    fn begin(&self, row: &Row) -> Begin {
        let last = self.rows.back().unwrap_or(row);
        let recent = self.checkpoints.back().filter(|_| !row.after_port && !self.count.is_multiple_of(CHECKPOINT_ROWS));
        Begin {
            time: last.time,
            ship: recent.map_or_else(|| self.ship(last), |recent| recent.begin.ship.clone()),
            in_port: row.after_port,
        }
    }

    /// Returns the ship by all hypotheses.
    fn ship(&self, row: &Row) -> ShipState {
        let best = self.best();
        let plausible = self.bank.iter().filter(|h| h.log_weight() > best - NEGLIGIBLE);
        let weighed: Vec<(f64, ShipState)> = plausible
            .map(|h| ((h.log_weight() - best).exp(), ShipState::from_filter(&h.filter, row)))
            .collect();
        let (weights, states): (Vec<f64>, Vec<ShipState>) = weighed.into_iter().unzip();
        ShipState::mixed(&states, &weights)
    }

    /// Returns the ship after the last row, if there was one.
    pub(crate) fn current_ship(&self) -> Option<ShipState> {
        self.rows.back().map(|row| self.ship(row))
    }

    fn keep_checkpoint(&mut self, row: &Row) {
        let begin = self.begin(row);
        let time = begin.time;
        if let Some(old) = self.checkpoints.len().checked_sub(RECENT_ROWS)
            && let Some(checkpoint) = self.checkpoints.get(old)
            && !(checkpoint.begin.in_port || checkpoint.after.is_multiple_of(CHECKPOINT_ROWS))
        {
            self.checkpoints.remove(old);
        }
        self.checkpoints.push_back(Checkpoint {
            after: self.count,
            time,
            lead: self.bank[0].clone(),
            sums: self.sums,
            begin,
        });
    }

    fn read_all(&mut self, row: &Row) -> Tracked {
        let levels = *self.learning.levels();
        let usual = Transition::to(row, &levels);
        let mut leads = None;
        let best = self.best();
        let mut wild = Vec::new();
        for (i, hypothesis) in self.bank.iter_mut().enumerate() {
            let before = hypothesis.clone();
            let is_plausible = hypothesis.log_weight() > best - 5.0;
            let read = hypothesis.read(row, &levels, &usual);
            if is_plausible && read.teaches() && hypothesis.learns_the_ship() {
                wild.push(before.after_wild(self.count, row, &levels, &usual));
            }
            let before = before.filter.log_likelihood;
            if i == 0 {
                let gained = hypothesis.filter.log_likelihood - before;
                leads = Some((read, gained));
            }
        }
        self.bank.extend(wild);
        let (read, gained) = leads.expect("the bank is never empty");
        let learns = self.is_settled();
        let lead = &self.bank[0].filter;
        self.learning.read(row, lead, gained, learns);
        self.sums.add(row, &read);
        Tracked { read }
    }

    /// Returns true while the lead is alone in what it supposes.
    fn is_settled(&self) -> bool {
        let lead = &self.bank[0];
        let best = lead.log_weight();
        lead.lasting().all(|kind| kind.changes_deviation())
            && self.bank[1..]
                .iter()
                .all(|other| other.events.len() == lead.events.len() || other.log_weight() < best - 3.0)
    }

    fn suppose_endings(&mut self, row: &Row) {
        let begin = self.begin(row);
        let spacing_s = END_ROWS as f64 * row.seconds.clamp(60.0, 3600.0);
        let best = self.best();
        let mut ended: Vec<Hypothesis> = Vec::new();
        for hypothesis in &self.bank {
            if hypothesis.log_weight() > best - 6.0 {
                ended.extend(hypothesis.endings(&begin, spacing_s));
            }
        }
        self.bank.extend(ended);
    }

    fn best(&self) -> f64 {
        let weights = self.bank.iter().map(Hypothesis::log_weight);
        weights.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Weighs every kind of event where it is likeliest, before another hypothesis takes the
    /// lead: whatever rivals it must have been heard.
    fn hear_rivals(&mut self) {
        for kind in &KINDS {
            if self.bank[0].has(kind.kind) && !kind.kind.changes_deviation() {
                continue;
            }
            for (place, log_prior, score) in self.best_starts(kind) {
                let from = self.checkpoints[place].time;
                if self.was_tried(kind.kind, from, score) {
                    continue;
                }
                self.tried.push(Tried { kind: kind.kind, from, score });
                let hypothesis = self.replay(place, kind.kind, log_prior);
                self.bank.push(hypothesis);
            }
        }
    }

    /// Proposes events that the innovations suggest, and replays the rows under them.
    fn suppose_events(&mut self) {
        let lead = &self.bank[0];
        let mut proposals: Vec<(usize, &'static KindRow, f64)> = Vec::new();
        let mut tried = Vec::new();
        for kind in &KINDS {
            if lead.has(kind.kind) && !kind.kind.changes_deviation() {
                continue;
            }
            for (place, log_prior, score) in self.best_starts(kind) {
                let from = self.checkpoints[place].time;
                if score <= SUPPOSED || self.was_tried(kind.kind, from, score) {
                    continue;
                }
                proposals.push((place, kind, log_prior));
                tried.push(Tried { kind: kind.kind, from, score });
            }
        }
        // Disturbances rival whatever else is supposed: where that began, and where they are
        // likeliest themselves.
        for rival in [Kind::Storm.row(), Kind::Anomaly.row()] {
            if lead.has(rival.kind) || proposals.is_empty() {
                continue;
            }
            let own = self.best_starts(rival).into_iter().map(|(place, _, _)| place);
            let places: Vec<usize> =
                proposals.iter().map(|(place, _, _)| *place).chain(own).collect();
            for place in places {
                let from = self.checkpoints[place].time;
                let Some(log_prior) = self.log_prior(place, rival) else {
                    continue;
                };
                let same = |t: &Tried| t.kind == rival.kind && t.from == from;
                if tried.iter().any(same) || self.was_tried(rival.kind, from, f64::NEG_INFINITY) {
                    continue;
                }
                tried.push(Tried { kind: rival.kind, from, score: SUPPOSED });
                proposals.push((place, rival, log_prior));
            }
        }
        self.tried.extend(tried);
        for (place, kind, log_prior) in proposals {
            let hypothesis = self.replay(place, kind.kind, log_prior);
            self.bank.push(hypothesis);
        }
    }

    /// Returns true if an instrument stood since a row while the ship turned.
    fn seems_stuck(&self, kind: Kind, after: usize) -> bool {
        let first = &self.rows[(after - self.first_kept).min(self.rows.len() - 1)];
        let last = &self.rows[self.rows.len() - 1];
        let turned = |of: fn(&Row) -> Option<f64>| {
            of(first).zip(of(last)).map_or(0.0, |(a, b)| wrap_180(b - a).abs())
        };
        let compass = turned(|row| Some(row.compass_deg));
        let gyro = turned(|row| row.gyro_deg);
        let satellite = turned(|row| row.satellite_deg);
        let (own, others) = match kind {
            Kind::StuckCard => (compass, gyro.max(satellite)),
            Kind::StuckGyro => (gyro, compass),
            _ => (satellite, compass),
        };
        own < STOOD_DEG && others > TURNED_DEG
    }

    /// Returns the log prior of an event of a kind between a checkpoint and the next; none if it
    /// cannot happen there.
    fn log_prior(&self, place: usize, kind: &KindRow) -> Option<f64> {
        let checkpoint = &self.checkpoints[place];
        let next = self.checkpoints.get(place + 1);
        let next = next.map_or(self.rows.back()?.time, |next| next.time);
        let exposure_s = next.seconds_since(checkpoint.time).clamp(300.0, 7200.0);
        let probability = if checkpoint.begin.in_port {
            kind.a_call
        } else {
            kind.a_year * exposure_s / YEAR_S
        };
        (probability > 0.0).then(|| probability.ln())
    }

    /// Returns the checkpoint after which an event of a kind is likeliest: its place, the log
    /// prior of the event there, and its log posterior ratio.
    fn best_starts(&self, kind: &KindRow) -> Vec<(usize, f64, f64)> {
        let mut starts: Vec<(usize, f64, f64)> = Vec::new();
        for (place, checkpoint) in self.checkpoints.iter().enumerate() {
            let Some(log_prior) = self.log_prior(place, kind) else {
                continue;
            };
            let sums = self.sums.since(&checkpoint.sums);
            let factor = match kind.kind {
                Kind::Storm | Kind::Anomaly => 0.5 * sums.excess(),
                Kind::StuckCard | Kind::StuckGyro | Kind::StuckSatellite => {
                    if !self.seems_stuck(kind.kind, checkpoint.after) {
                        continue;
                    }
                    0.5 * sums.excess()
                }
                Kind::ShipDrift => {
                    if sums.greatest() < 4.0 {
                        continue;
                    }
                    sums.log_bayes_factor(Kind::Strike.row())
                }
                Kind::GyroRamp => {
                    if sums.greatest() < 4.0 {
                        continue;
                    }
                    sums.log_bayes_factor(Kind::GyroStep.row())
                }
                _ => {
                    if sums.greatest() < 3.0 {
                        continue;
                    }
                    sums.log_bayes_factor(kind)
                }
            };
            let score = factor + log_prior;
            starts.push((place, log_prior, score));
        }
        starts.sort_by(|a, b| b.2.total_cmp(&a.2));
        starts.truncate(STARTS);
        starts
    }

    /// Returns true if such an event was weighed at about that time, when it was about as
    /// likely.
    fn was_tried(&self, kind: Kind, from: Timestamp, score: f64) -> bool {
        let now = self.rows.back().map_or(from, |row| row.time);
        let age_s = now.seconds_since(from).max(0.0);
        self.tried.iter().any(|tried| {
            tried.kind == kind
                && tried.from.seconds_since(from).abs() <= 300.0 + 0.1 * age_s
                && score < tried.score + TRIED_AGAIN
        })
    }

    fn replay(&mut self, place: usize, kind: Kind, log_prior: f64) -> Hypothesis {
        self.replays += 1;
        let levels = *self.learning.levels();
        let checkpoint = &self.checkpoints[place];
        let from = checkpoint.time;
        let mut hypothesis = checkpoint.lead.with_event(kind, &checkpoint.begin, log_prior);
        for row in self.rows.iter().skip(checkpoint.after - self.first_kept) {
            let usual = Transition::to(row, &levels);
            hypothesis.read(row, &levels, &usual);
        }
        if std::env::var("AT").is_ok_and(|at| self.rows.back().is_some_and(|r| r.time.to_string().starts_with(&at))) {
            eprintln!("      REPLAY {kind:?} from {from} prior {log_prior:.1}: {:.1}", hypothesis.log_weight() - self.best());
        }
        hypothesis
    }

    /// Puts the best first, and drops those that are hopeless or the same as a better one.
    fn prune(&mut self) {
        let lead_weight = self.bank[0].log_weight();
        let lead_events = self.bank[0].events.len();
        if self.best() > lead_weight + TAKES_LEAD {
            self.hear_rivals();
        }
        let best = self.best();
        let leader = if best > lead_weight + TAKES_LEAD {
            self.bank.iter().position(|h| h.log_weight() >= best).unwrap_or(0)
        } else {
            0
        };
        if leader != 0 {
            self.bank.swap(0, leader);
            self.checkpoints.clear();
            self.tried.clear();
            self.sums = self.sums.restarted();
            self.learning.restart(&self.bank[0]);
        }
        let _ = lead_events;
        let merges = self.count > STARTING_ROWS;
        let mut kept: Vec<Hypothesis> = Vec::new();
        let mut bank = std::mem::take(&mut self.bank);
        let lead = bank.remove(0);
        bank.sort_by(|a, b| b.log_weight().total_cmp(&a.log_weight()));
        kept.push(lead);
        for hypothesis in bank {
            if hypothesis.log_weight() < best - GIVEN_UP || kept.len() >= MOST_HYPOTHESES {
                continue;
            }
            let twin = kept.iter().position(|other| is_same(other, &hypothesis, merges));
            match twin {
                Some(twin) if merges && kept[twin].start != hypothesis.start => {
                    merge(&mut kept[twin], &hypothesis);
                }
                Some(_) => {}
                None => kept.push(hypothesis),
            }
        }
        self.bank = kept;
        if self.count.is_multiple_of(ALIKE_ROWS) && merges {
            self.merge_alike();
        }
    }

    /// Merges hypotheses whose filters no longer differ: what they suppose is past.
    fn merge_alike(&mut self) {
        let mut kept: Vec<Hypothesis> = Vec::new();
        for hypothesis in std::mem::take(&mut self.bank) {
            let alike = kept.iter().position(|other| is_alike(other, &hypothesis));
            match alike {
                Some(alike) => merge(&mut kept[alike], &hypothesis),
                None => kept.push(hypothesis),
            }
        }
        self.bank = kept;
    }

    /// Tells events that have become certain, and withdraws those that no longer are.
    fn tell(&mut self, now: Timestamp) {
        let marginals = Marginals::new(&self.bank);
        for told in &mut self.told {
            let is_open = now.seconds_since(told.event.from) < REFRESHED_S;
            if told.withdrawn.is_some() || !(is_open || told.event.until.is_none()) {
                continue;
            }
            let found = marginals.event(told.class, told.event.from);
            if is_open && found.probability < WITHDRAWN {
                told.withdrawn = Some(now);
            } else if found.probability > 0.5 && let Some(event) = marginals.leads(told.class, told.event.from) {
                told.event.until = event.until;
                told.event.ship_at_end = event.ship_at_end.clone();
                if is_open {
                    told.event = event.clone();
                    told.kinds = found.kinds;
                    told.earliest = found.earliest;
                    told.latest = found.latest;
                }
            }
        }
        let mut more = Vec::new();
        for event in &self.bank[0].events {
            let class = Class::of(event.kind);
            let is_told = |told: &Told| {
                told.class == class
                    && told.withdrawn.is_none()
                    && told.event.from.seconds_since(event.from).abs() < TOLD_SAME_S
            };
            if self.told.iter().any(is_told) || now.seconds_since(event.from) > REFRESHED_S {
                continue;
            }
            let found = marginals.event(class, event.from);
            if found.probability > TOLD {
                more.push(Told {
                    class,
                    event: event.clone(),
                    at: now,
                    withdrawn: None,
                    kinds: found.kinds,
                    earliest: found.earliest,
                    latest: found.latest,
                });
            }
        }
        self.told.extend(more);
    }

    /// Takes note of logbook entries of the time since the last row, before `placed` is read.
    pub(crate) fn note(&mut self, kind: LogbookKind) {
        let Some(row) = self.rows.back().cloned() else {
            return;
        };
        let begin = Begin {
            time: row.time,
            ship: self.ship(&row),
            in_port: true,
        };
        if kind.ends_an_epoch() {
            for hypothesis in &mut self.bank {
                hypothesis.renew(kind);
            }
            self.checkpoints.clear();
            self.tried.clear();
            self.sums = self.sums.restarted();
        }
        let mut more = Vec::new();
        for row in &KINDS {
            let Some(probability) = row.kind.beside(kind) else {
                continue;
            };
            for hypothesis in &mut self.bank {
                more.push(hypothesis.with_event(row.kind, &begin, probability.ln()));
                hypothesis.log_prior += (1.0 - probability).ln();
            }
        }
        self.bank.extend(more);
        self.learning.restart(&self.bank[0]);
    }

    /// Takes note that a cargo was discharged by the logbook.
    pub(crate) fn note_discharge(&mut self) {
        let Some(row) = self.rows.back().cloned() else {
            return;
        };
        let begin = Begin {
            time: row.time,
            ship: self.ship(&row),
            in_port: true,
        };
        let mut more = Vec::new();
        for hypothesis in &self.bank {
            let lasting = hypothesis.events.iter().rposition(|e| e.kind == Kind::Cargo && e.until.is_none());
            more.extend(lasting.map(|event| hypothesis.with_end(event, &begin, DISCHARGED.ln())));
        }
        self.bank.extend(more);
    }

    /// Returns the levels learnt.
    pub(crate) fn levels(&self) -> &Levels {
        self.learning.levels()
    }
}

/// Marginals of the posterior over events.
struct Marginals<'a> {
    bank: &'a [Hypothesis],
    weights: Vec<f64>,
}

/// Marginal of one event.
struct Found {
    probability: f64,
    kinds: Vec<(Kind, f64)>,
    earliest: Timestamp,
    latest: Timestamp,
}

impl<'a> Marginals<'a> {
    fn new(bank: &'a [Hypothesis]) -> Marginals<'a> {
        let best = bank.iter().map(Hypothesis::log_weight).fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = bank.iter().map(|h| (h.log_weight() - best).exp()).collect();
        let total: f64 = weights.iter().sum();
        Marginals {
            bank,
            weights: weights.into_iter().map(|w| w / total).collect(),
        }
    }

    /// Returns the lead's event of a class at about a time.
    fn leads(&self, class: Class, from: Timestamp) -> Option<&'a Event> {
        nearest(&self.bank[0], class, from)
    }

    /// Returns the marginal of an event of a class at about a time.
    fn event(&self, class: Class, from: Timestamp) -> Found {
        let mut found = Found {
            probability: 0.0,
            kinds: Vec::new(),
            earliest: from,
            latest: from,
        };
        for (hypothesis, weight) in self.bank.iter().zip(&self.weights) {
            let Some(event) = nearest(hypothesis, class, from) else {
                continue;
            };
            found.probability += weight;
            match found.kinds.iter_mut().find(|(kind, _)| *kind == event.kind) {
                Some((_, sum)) => *sum += weight,
                None => found.kinds.push((event.kind, *weight)),
            }
            if *weight > 0.02 {
                found.earliest = found.earliest.min(event.from);
                found.latest = found.latest.max(event.from);
            }
        }
        found.kinds.sort_by(|a, b| b.1.total_cmp(&a.1));
        found
    }
}

/// Returns a hypothesis's event of a class nearest to a time, within a day.
fn nearest(hypothesis: &Hypothesis, class: Class, from: Timestamp) -> Option<&Event> {
    let events = hypothesis.events.iter().filter(|e| Class::of(e.kind) == class);
    let apart = |e: &Event| e.from.seconds_since(from).abs();
    let near = events.filter(|e| apart(e) < TOLD_SAME_S);
    near.min_by(|a, b| apart(a).total_cmp(&apart(b)))
}

/// Returns true if two hypotheses suppose the same events.
fn is_same(a: &Hypothesis, b: &Hypothesis, merges_starts: bool) -> bool {
    a.wild == b.wild &&
    (merges_starts || a.start == b.start)
        && a.events.len() == b.events.len()
        && a.events.iter().zip(&b.events).all(|(a, b)| {
            let same_end = match (a.until, b.until) {
                (None, None) => true,
                (Some(a), Some(b)) => a.seconds_since(b).abs() <= SAME_S,
                _ => false,
            };
            a.kind == b.kind && a.from.seconds_since(b.from).abs() <= SAME_S && same_end
        })
}

/// Returns true if two hypotheses have the same lasting events but old steps, and predict the
/// same.
fn is_alike(a: &Hypothesis, b: &Hypothesis) -> bool {
    let moving = |h: &Hypothesis| -> Vec<Kind> {
        h.lasting().filter(|kind| !kind.row().jumps.is_empty() || !kind.changes_deviation()).filter(|kind| !matches!(kind, Kind::Strike | Kind::Cargo | Kind::Alignment)).collect()
    };
    moving(a) == moving(b)
        && (0..super::states::STATES).all(|i| {
            let variance = a.filter.covariance[i][i].min(b.filter.covariance[i][i]);
            let apart = a.filter.mean[i] - b.filter.mean[i];
            apart * apart <= ALIKE * ALIKE * variance
                && a.filter.covariance[i][i].max(b.filter.covariance[i][i]) <= 1.5 * variance + 1e-12
        })
}

/// Merges a hypothesis into another by moments.
fn merge(into: &mut Hypothesis, other: &Hypothesis) {
    let (a, b) = (into.log_weight(), other.log_weight());
    let share = 1.0 / (1.0 + (a - b).exp());
    let filter: Filter = into.filter.mixed_with(&other.filter, share);
    let weight = a.max(b) + (-(a - b).abs()).exp().ln_1p();
    into.log_prior += weight - a;
    let log_likelihood = into.filter.log_likelihood;
    into.filter = Filter {
        log_likelihood,
        ..filter
    };
}
