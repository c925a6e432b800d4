//! Selection of hypotheses: the lead, those that are dropped, and those that are merged.

use super::tracker::Tracker;
use crate::constants::{
    ALIKE, BETTER, DAY_ROWS, GIVEN_UP, HOUR_ROWS, IMPROBABLE, MOST_HYPOTHESES, OUTDATED_S, SAME_S,
    SETTLED_S, SIMPLER_GIVEN_UP, WEEK_ROWS,
};
use crate::hypotheses::hypothesis::{Hypothesis, Supposed};
use crate::hypotheses::kinds::{Ending, Kind};
use crate::state_space::filter::Filter;
use crate::state_space::states::STATES;
use binnacle_compass::time::Timestamp;
use std::sync::Arc;

impl Tracker {
    /// Drops events that are settled from every hypothesis: hypotheses that differ in nothing
    /// else become one.
    pub(super) fn settle(&mut self, now: Timestamp) {
        if !self.count.is_multiple_of(DAY_ROWS) {
            return;
        }
        for hypothesis in &mut self.bank {
            hypothesis.events.retain(|event| {
                let age_s = now.seconds_since(event.until.unwrap_or(event.from));
                let judged_s = match event.kind.row().ending {
                    _ if event.until.is_some() => SETTLED_S,
                    Ending::Never => SETTLED_S,
                    Ending::InPort { .. } => OUTDATED_S,
                    Ending::After(_) | Ending::AfterMiles(_) => f64::INFINITY,
                };
                age_s <= judged_s
            });
        }
    }

    /// Drops the least likely beyond the most that there may be, and keeps the lead.
    pub(super) fn limit(&mut self) {
        self.bank[1..].sort_by(|a, b| b.log_weight().total_cmp(&a.log_weight()));
        self.bank.truncate(MOST_HYPOTHESES);
    }

    /// Puts the best first, and drops those that are hopeless or the same as a better one.
    pub(super) fn prune(&mut self) {
        let lead_weight = self.bank[0].log_weight();
        if self.best() > lead_weight + BETTER {
            self.weigh_alternatives();
        }
        let best = self.best();
        let leader = if best > lead_weight + BETTER {
            self.bank
                .iter()
                .position(|h| h.log_weight() >= best)
                .unwrap_or(0)
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
        let merges = self.count > WEEK_ROWS;
        let mut kept: Vec<Hypothesis> = Vec::new();
        let mut bank = std::mem::take(&mut self.bank);
        let lead = bank.remove(0);
        bank.sort_by(|a, b| b.log_weight().total_cmp(&a.log_weight()));
        kept.push(lead);
        let mut has_simpler = false;
        for hypothesis in bank {
            let is_simpler = changes(&hypothesis) < changes(&kept[0]);
            let given_up = if is_simpler && !has_simpler {
                SIMPLER_GIVEN_UP
            } else {
                GIVEN_UP
            };
            if hypothesis.log_weight() < best - given_up || kept.len() >= MOST_HYPOTHESES {
                continue;
            }
            has_simpler |= is_simpler;
            let twin = kept
                .iter()
                .position(|other| is_same(other, &hypothesis, merges));
            match twin {
                Some(twin) if kept[twin].start != hypothesis.start => {
                    self.merge(&mut kept, twin, &hypothesis);
                }
                // Supposed again, or at another time about as likely: its weight counts once.
                Some(_) => {}
                None => kept.push(hypothesis),
            }
        }
        self.bank = kept;
        if self.count.is_multiple_of(6 * HOUR_ROWS) {
            self.merge_alike();
        }
    }

    /// Merges hypotheses whose filters no longer differ: what they suppose is past.
    fn merge_alike(&mut self) {
        let mut kept: Vec<Hypothesis> = Vec::new();
        for hypothesis in std::mem::take(&mut self.bank) {
            let alike = kept.iter().position(|other| is_alike(other, &hypothesis));
            match alike {
                Some(alike) => self.merge(&mut kept, alike, &hypothesis),
                None => kept.push(hypothesis),
            }
        }
        self.bank = kept;
    }

    /// Merges a hypothesis into one that is kept. What is learnt beside the lead follows it.
    fn merge(&mut self, kept: &mut [Hypothesis], into: usize, other: &Hypothesis) {
        let share = merge(&mut kept[into], other);
        if into == 0 {
            self.learning.mix_with(&other.filter, share);
        }
    }
}

/// Returns the number of changes of the ship that a hypothesis supposes.
fn changes(hypothesis: &Hypothesis) -> usize {
    likely(hypothesis)
        .filter(|event| !event.kind.passes_by())
        .count()
}

/// Returns the events that a hypothesis supposes, without those that it only may have.
fn likely(hypothesis: &Hypothesis) -> impl Iterator<Item = &Supposed> {
    hypothesis.events.iter().filter(|e| e.is_likely())
}

/// Returns true if two hypotheses suppose the same events: at the same times, or at about the same
/// where no later row can tell them apart.
fn is_same(a: &Hypothesis, b: &Hypothesis, merges_starts: bool) -> bool {
    let comparable = a.wild == b.wild
        && a.lively == b.lively
        && (merges_starts || a.start == b.start)
        && likely(a).count() == likely(b).count();
    if !comparable {
        return false;
    }
    let mut apart_s = 0.0_f64;
    for (a, b) in likely(a).zip(likely(b)) {
        let ends_apart_s = match (a.until, b.until) {
            (None, None) => 0.0,
            (Some(a), Some(b)) => a.seconds_since(b).abs(),
            _ => return false,
        };
        if a.kind != b.kind {
            return false;
        }
        let begins_apart_s = a.from.seconds_since(b.from).abs();
        apart_s = apart_s.max(begins_apart_s).max(ends_apart_s);
    }
    apart_s == 0.0 || (apart_s <= SAME_S && is_alike(a, b))
}

/// Returns true if two hypotheses have the same lasting events but old steps, and predict the
/// same.
fn is_alike(a: &Hypothesis, b: &Hypothesis) -> bool {
    let moving = |h: &Hypothesis| -> Vec<Kind> {
        h.lasting()
            .filter(|kind| !kind.row().jumps.is_empty() || !kind.changes_deviation())
            .filter(|kind| {
                !matches!(
                    kind,
                    Kind::Strike | Kind::Cargo | Kind::Alignment | Kind::GyroSettling
                )
            })
            .collect()
    };
    a.lively == b.lively
        && moving(a) == moving(b)
        && (0..STATES).all(|i| {
            let variance = a.filter.covariance[i][i].min(b.filter.covariance[i][i]);
            let apart = a.filter.mean[i] - b.filter.mean[i];
            apart * apart <= ALIKE * ALIKE * variance
                && a.filter.covariance[i][i].max(b.filter.covariance[i][i])
                    <= 1.5 * variance + 1e-12
        })
}

/// Merges a hypothesis into another by moments. Returns its share.
fn merge(into: &mut Hypothesis, other: &Hypothesis) -> f64 {
    let (a, b) = (into.log_weight(), other.log_weight());
    let share = 1.0 / (1.0 + (a - b).exp());
    mix_events(&mut into.events, &other.events, share);
    let filter: Filter = into.filter.mixed_with(&other.filter, share);
    let weight = a.max(b) + (-(a - b).abs()).exp().ln_1p();
    into.log_prior += weight - a;
    let log_likelihood = into.filter.log_likelihood;
    into.filter = Filter {
        log_likelihood,
        ..filter
    };
    share
}

/// Mixes another hypothesis's events into some, `share` being the other's: each event keeps its
/// probability over both.
fn mix_events(events: &mut Vec<Supposed>, others: &[Supposed], share: f64) {
    for event in events.iter_mut() {
        let other = others.iter().find(|other| is_one(event, other));
        event.probability *= 1.0 - share;
        event.probability += share * other.map_or(0.0, |other| other.probability);
    }
    for other in others {
        if !events.iter().any(|event| is_one(event, other)) {
            events.push(Supposed {
                event: Arc::clone(&other.event),
                probability: share * other.probability,
            });
        }
    }
    events.retain(|event| event.probability > IMPROBABLE);
}

/// Returns true if two hypotheses speak of one event: of the same times, or of what is under way
/// by both.
fn is_one(a: &Supposed, b: &Supposed) -> bool {
    let is_under_way = !a.kind.is_sudden() && a.until.is_none() && b.until.is_none();
    a.kind == b.kind && (is_under_way || a.from.seconds_since(b.from).abs() <= SAME_S)
}
