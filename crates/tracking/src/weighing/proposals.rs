//! Proposals of events where innovations suggest them.

use super::records::Tried;
use super::tracker::Tracker;
use crate::constants::{BETTER, DAY_ROWS, ROW_S, STARTS, STOOD_DEG, TURNED_DEG, UNCERTAIN};
use crate::hypotheses::hypothesis::{Begin, Hypothesis};
use crate::hypotheses::kinds::{KINDS, Kind, KindRow};
use crate::state_space::row::Row;
use crate::state_space::transition::Transition;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::time::Timestamp;

/// Start of an event.
#[derive(Clone, Copy, Debug)]
struct Start {
    /// Place of the checkpoint before it.
    place: usize,
    /// Log prior of the event there, and its log posterior ratio.
    log_prior: f64,
    score: f64,
    /// True if the instrument that fails stands still.
    stands: bool,
}

/// Likeliest starts of a kind: between rows, the best first, and in a gap. The sums hardly tell
/// an event in a gap from one at the first turn after it.
#[derive(Clone, Copy, Debug, Default)]
struct Starts {
    between_rows: [Option<Start>; STARTS],
    in_gap: Option<Start>,
}

impl Starts {
    fn offer(&mut self, start: Start, is_in_gap: bool) {
        let mut next = Some(start);
        let places = if is_in_gap {
            std::slice::from_mut(&mut self.in_gap)
        } else {
            &mut self.between_rows
        };
        for place in places {
            let is_better = match (&next, &place) {
                (Some(next), Some(known)) => next.score > known.score,
                (next, _) => next.is_some(),
            };
            if is_better {
                std::mem::swap(place, &mut next);
            }
        }
    }

    fn iter(&self) -> impl Iterator<Item = Start> {
        self.between_rows
            .iter()
            .chain([&self.in_gap])
            .flatten()
            .copied()
    }
}

/// Event to be weighed.
#[derive(Clone, Copy, Debug)]
struct Proposal {
    kind: &'static KindRow,
    start: Start,
}

impl Tracker {
    /// Weighs every kind of event where it is likeliest, before another hypothesis takes the
    /// lead.
    pub(super) fn weigh_alternatives(&mut self) {
        let starts = self.likeliest_starts(f64::NEG_INFINITY);
        for (kind, starts) in KINDS.iter().zip(starts) {
            if self.is_under_way(kind) {
                continue;
            }
            for start in starts.iter() {
                self.weigh(kind, start);
            }
        }
    }

    /// Proposes events that the innovations suggest, and replays the rows under them.
    pub(super) fn suppose_events(&mut self) {
        let likeliest = self.likeliest_starts(-UNCERTAIN);
        let mut proposals: Vec<Proposal> = Vec::new();
        for (kind, starts) in KINDS.iter().zip(likeliest) {
            if self.is_under_way(kind) {
                continue;
            }
            let new = starts.iter().filter(|start| {
                let from = self.checkpoints[start.place].time;
                !self.was_tried(kind.kind, from, start.score)
            });
            proposals.extend(new.map(|start| Proposal { kind, start }));
        }
        if proposals.is_empty() {
            return;
        }
        // Disturbances are weighed against whatever else is supposed: where that began, and
        // where they are likeliest themselves.
        let places: Vec<usize> = proposals.iter().map(|p| p.start.place).collect();
        for kind in KINDS.iter().filter(|kind| kind.kind.passes_by()) {
            if self.is_under_way(kind) {
                continue;
            }
            let own = self.likeliest_starts(f64::NEG_INFINITY)[kind.kind as usize];
            let own = own.iter().map(|start| start.place);
            for place in places.iter().copied().chain(own) {
                let from = self.checkpoints[place].time;
                let same = |p: &Proposal| p.kind.kind == kind.kind && p.start.place == place;
                let Some(log_prior) = self.log_prior(place, kind) else {
                    continue;
                };
                if proposals.iter().any(same) || self.was_tried(kind.kind, from, -UNCERTAIN) {
                    continue;
                }
                let score = -UNCERTAIN;
                let start = Start {
                    place,
                    log_prior,
                    score,
                    stands: false,
                };
                proposals.push(Proposal { kind, start });
            }
        }
        for Proposal { kind, start } in &proposals {
            self.replay(kind.kind, *start);
        }
        let tried = proposals.iter().map(|p| self.tried_at(p.kind, p.start));
        self.tried.extend(tried.collect::<Vec<_>>());
    }

    /// Supposes that a drift begins: it shows in no row, and a filter follows it before it is
    /// large.
    pub(super) fn suppose_drift(&mut self, begin: &Begin) {
        let kind = Kind::ShipDrift.row();
        if !self.bank[0].has(kind.kind) {
            let probability = kind.probability(DAY_ROWS as f64 * ROW_S, false);
            let drifting = self.bank[0].with_event(kind.kind, begin, probability.ln());
            self.bank.push(drifting);
        }
    }

    /// Returns true if an event of the kind lasts by the lead, which a second one would not
    /// change.
    fn is_under_way(&self, kind: &KindRow) -> bool {
        !kind.kind.changes_deviation() && self.bank[0].has(kind.kind)
    }

    /// Weighs one more event, unless it was weighed before.
    fn weigh(&mut self, kind: &KindRow, start: Start) {
        let tried = self.tried_at(kind, start);
        if !self.was_tried(kind.kind, tried.from, start.score) {
            self.tried.push(tried);
            self.replay(kind.kind, start);
        }
    }

    fn tried_at(&self, kind: &KindRow, start: Start) -> Tried {
        Tried {
            kind: kind.kind,
            from: self.checkpoints[start.place].time,
            score: start.score,
        }
    }

    /// Returns true if an instrument stood since a row while the ship turned, by the two rows
    /// until then and the last two: one of each may be wild.
    fn seems_stuck(&self, kind: Kind, after: usize) -> bool {
        let count = self.rows.len();
        let first = after - self.first_kept;
        if first < 2 || count < first + 2 {
            return false;
        }
        let pairs = [first - 2, first - 1].map(|a| [count - 2, count - 1].map(|b| (a, b)));
        let turned = |of: fn(&Row) -> Option<f64>| {
            pairs.as_flattened().iter().map(move |(a, b)| {
                let both = of(&self.rows[*a]).zip(of(&self.rows[*b]));
                both.map_or(0.0, |(a, b)| wrap_180(b - a).abs())
            })
        };
        let stood = |of| turned(of).all(|deg| deg < STOOD_DEG);
        let moved = |of, least_deg: f64| turned(of).all(|deg| deg > least_deg);
        let compass = |row: &Row| Some(row.compass_deg);
        let gyro = |row: &Row| row.gyro_deg;
        let satellite = |row: &Row| row.satellite_deg;
        let course = |row: &Row| row.course.map(|course| course.deg);
        match kind {
            Kind::FailedCard => {
                stood(compass)
                    && (moved(gyro, TURNED_DEG)
                        || moved(satellite, TURNED_DEG)
                        || moved(course, 4.0 * TURNED_DEG))
            }
            Kind::FailedGyro => {
                stood(gyro) && (moved(compass, TURNED_DEG) || moved(satellite, TURNED_DEG))
            }
            _ => stood(satellite) && (moved(compass, TURNED_DEG) || moved(gyro, TURNED_DEG)),
        }
    }

    /// Returns the log prior of an event of a kind between a checkpoint and the next; none if it
    /// cannot happen there.
    fn log_prior(&self, place: usize, kind: &KindRow) -> Option<f64> {
        let checkpoint = &self.checkpoints[place];
        if !kind.kind.can_happen(&checkpoint.begin.row) {
            return None;
        }
        let next = self.checkpoints.get(place + 1);
        let next = next.map_or(self.rows.back()?.time, |next| next.time);
        let seconds = next.seconds_since(checkpoint.time).max(ROW_S);
        let probability = kind.probability(seconds, checkpoint.begin.in_port);
        (probability > 0.0).then(|| probability.ln())
    }

    /// Returns the likeliest starts of each kind of event, with a log posterior ratio above
    /// the least.
    fn likeliest_starts(&self, least: f64) -> [Starts; KINDS.len()] {
        let mut likeliest = [Starts::default(); KINDS.len()];
        for (place, checkpoint) in self.checkpoints.iter().enumerate() {
            let sums = self.sums.since(&checkpoint.sums);
            let greatest = sums.greatest();
            for (kind, starts) in KINDS.iter().zip(&mut likeliest) {
                let disturbed = 0.5 * sums.excess();
                let stands = kind.kind.is_failed() && self.seems_stuck(kind.kind, checkpoint.after);
                let factor = match kind.kind {
                    kind if kind.is_failed() && !stands => sums.log_factor_of_any_heading(kind),
                    Kind::Storm
                    | Kind::SevereStorm
                    | Kind::Anomaly
                    | Kind::FailedCard
                    | Kind::FailedGyro
                    | Kind::FailedSatellite => disturbed,
                    Kind::ShipDrift if greatest >= UNCERTAIN => {
                        sums.log_bayes_factor(Kind::Strike.row())
                    }
                    Kind::GyroRamp if greatest >= UNCERTAIN => {
                        sums.log_bayes_factor(Kind::GyroStep.row())
                    }
                    Kind::ShipDrift | Kind::GyroRamp => continue,
                    _ if greatest >= UNCERTAIN => sums.log_bayes_factor(kind),
                    _ => continue,
                };
                // Every prior is less than one.
                if factor <= least {
                    continue;
                }
                let Some(log_prior) = self.log_prior(place, kind) else {
                    continue;
                };
                let score = factor + log_prior;
                if score <= least {
                    continue;
                }
                let start = Start {
                    place,
                    log_prior,
                    score,
                    stands,
                };
                starts.offer(start, checkpoint.before_gap);
            }
        }
        likeliest
    }

    /// Returns true if such an event was weighed at about that time, when it was about as
    /// likely.
    fn was_tried(&self, kind: Kind, from: Timestamp, score: f64) -> bool {
        let now = self.rows.back().map_or(from, |row| row.time);
        let age_s = now.seconds_since(from).max(0.0);
        self.tried.iter().any(|tried| {
            tried.kind == kind
                && tried.from.seconds_since(from).abs() <= 300.0 + 0.1 * age_s
                && score < tried.score + BETTER
        })
    }

    /// Supposes an event after a checkpoint under each hypothesis that was plausible there, and
    /// reads the rows since.
    fn replay(&mut self, kind: Kind, start: Start) {
        let levels = *self.learning.levels();
        let checkpoint = &self.checkpoints[start.place];
        let shown_deg = checkpoint.begin.row.shown_deg(kind);
        let held_deg = shown_deg.filter(|_| start.stands);
        let supposing = |before: &Hypothesis| {
            let begin = &checkpoint.begin;
            let mut hypothesis = before.with_failure(kind, begin, held_deg, start.log_prior);
            for row in self.rows.iter().skip(checkpoint.after - self.first_kept) {
                let usual = Transition::to(row, &levels);
                hypothesis.read(row, &levels, &usual);
            }
            hypothesis
        };
        let more: Vec<Hypothesis> = checkpoint.plausible.iter().map(supposing).collect();
        self.bank.extend(more);
    }
}
