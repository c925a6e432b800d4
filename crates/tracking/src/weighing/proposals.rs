//! Proposals of events where innovations suggest them.

use super::records::Tried;
use super::tracker::Tracker;
use crate::hypotheses::hypothesis::Hypothesis;
use crate::hypotheses::kinds::{KINDS, Kind, KindRow};
use crate::state_space::row::Row;
use crate::state_space::transition::Transition;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::time::Timestamp;

/// Starts of an event that are weighed at a time.
const STARTS: usize = 2;
/// Log posterior ratio from which an event is supposed.
const SUPPOSED: f64 = -4.0;
/// Rise of it from which an event is weighed again.
const TRIED_AGAIN: f64 = 2.0;
/// Greatest turn of an instrument that stood, and least of a ship that turned, degrees.
const STOOD_DEG: f64 = 2.0;
const TURNED_DEG: f64 = 10.0;
const YEAR_S: f64 = 365.25 * 86_400.0;

/// Log likelihood ratio from which a jump is worth a look, and a slow growth.
const JUMP_SEEN: f64 = 3.0;
const GROWTH_SEEN: f64 = 4.0;

/// Start of an event.
#[derive(Clone, Copy, Debug)]
struct Start {
    /// Place of the checkpoint before it.
    place: usize,
    /// Log prior of the event there, and its log posterior ratio.
    log_prior: f64,
    score: f64,
}

/// Event to be weighed.
#[derive(Clone, Copy, Debug)]
struct Proposal {
    kind: &'static KindRow,
    place: usize,
    log_prior: f64,
}

impl Tracker {
    /// Weighs every kind of event where it is likeliest, before another hypothesis takes the
    /// lead.
    pub(super) fn weigh_alternatives(&mut self) {
        for kind in &KINDS {
            if self.bank[0].has(kind.kind) && !kind.kind.changes_deviation() {
                continue;
            }
            for Start {
                place,
                log_prior,
                score,
            } in self.best_starts(kind)
            {
                let from = self.checkpoints[place].time;
                if self.was_tried(kind.kind, from, score) {
                    continue;
                }
                self.tried.push(Tried {
                    kind: kind.kind,
                    from,
                    score,
                });
                let hypothesis = self.replay(place, kind.kind, log_prior);
                self.bank.push(hypothesis);
            }
        }
    }

    /// Proposes events that the innovations suggest, and replays the rows under them.
    pub(super) fn suppose_events(&mut self) {
        let lead = &self.bank[0];
        let mut proposals: Vec<Proposal> = Vec::new();
        let mut tried = Vec::new();
        for kind in &KINDS {
            if lead.has(kind.kind) && !kind.kind.changes_deviation() {
                continue;
            }
            for Start {
                place,
                log_prior,
                score,
            } in self.best_starts(kind)
            {
                let from = self.checkpoints[place].time;
                if score <= SUPPOSED || self.was_tried(kind.kind, from, score) {
                    continue;
                }
                proposals.push(Proposal {
                    kind,
                    place,
                    log_prior,
                });
                tried.push(Tried {
                    kind: kind.kind,
                    from,
                    score,
                });
            }
        }
        // Disturbances are weighed against whatever else is supposed: where that began, and
        // where they are likeliest themselves.
        for alternative in [Kind::Storm.row(), Kind::Anomaly.row()] {
            if lead.has(alternative.kind) || proposals.is_empty() {
                continue;
            }
            let own = self
                .best_starts(alternative)
                .into_iter()
                .map(|start| start.place);
            let places: Vec<usize> = proposals
                .iter()
                .map(|proposal| proposal.place)
                .chain(own)
                .collect();
            for place in places {
                let from = self.checkpoints[place].time;
                let Some(log_prior) = self.log_prior(place, alternative) else {
                    continue;
                };
                let same = |t: &Tried| t.kind == alternative.kind && t.from == from;
                if tried.iter().any(same)
                    || self.was_tried(alternative.kind, from, f64::NEG_INFINITY)
                {
                    continue;
                }
                tried.push(Tried {
                    kind: alternative.kind,
                    from,
                    score: SUPPOSED,
                });
                proposals.push(Proposal {
                    kind: alternative,
                    place,
                    log_prior,
                });
            }
        }
        self.tried.extend(tried);
        for proposal in proposals {
            let Proposal {
                kind,
                place,
                log_prior,
            } = proposal;
            let hypothesis = self.replay(place, kind.kind, log_prior);
            self.bank.push(hypothesis);
        }
    }

    /// Returns true if an instrument stood since a row while the ship turned.
    fn seems_stuck(&self, kind: Kind, after: usize) -> bool {
        let first = &self.rows[(after - self.first_kept).min(self.rows.len() - 1)];
        let last = &self.rows[self.rows.len() - 1];
        let turned = |of: fn(&Row) -> Option<f64>| {
            of(first)
                .zip(of(last))
                .map_or(0.0, |(a, b)| wrap_180(b - a).abs())
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

    /// Returns the likeliest starts of an event of a kind, the best first.
    fn best_starts(&self, kind: &KindRow) -> Vec<Start> {
        let mut starts: Vec<Start> = Vec::new();
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
                    if sums.greatest() < GROWTH_SEEN {
                        continue;
                    }
                    sums.log_bayes_factor(Kind::Strike.row())
                }
                Kind::GyroRamp => {
                    if sums.greatest() < GROWTH_SEEN {
                        continue;
                    }
                    sums.log_bayes_factor(Kind::GyroStep.row())
                }
                _ => {
                    if sums.greatest() < JUMP_SEEN {
                        continue;
                    }
                    sums.log_bayes_factor(kind)
                }
            };
            let score = factor + log_prior;
            starts.push(Start {
                place,
                log_prior,
                score,
            });
        }
        starts.sort_by(|a, b| b.score.total_cmp(&a.score));
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

    pub(super) fn replay(&mut self, place: usize, kind: Kind, log_prior: f64) -> Hypothesis {
        let levels = *self.learning.levels();
        let checkpoint = &self.checkpoints[place];
        let mut hypothesis = checkpoint
            .lead
            .with_event(kind, &checkpoint.begin, log_prior);
        for row in self.rows.iter().skip(checkpoint.after - self.first_kept) {
            let usual = Transition::to(row, &levels);
            hypothesis.read(row, &levels, &usual);
        }
        hypothesis
    }
}
