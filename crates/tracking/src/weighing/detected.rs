//! Events that have become certain, and what is detected of them.

use super::records::{Class, Detected};
use super::selection::SETTLED_S;
use super::tracker::Tracker;
use crate::hypotheses::hypothesis::{Event, Hypothesis, Supposed};
use crate::hypotheses::kinds::Kind;
use binnacle_compass::time::Timestamp;

/// Seconds within which two accounts speak of the same event.
const SAME_EVENT_S: f64 = 86_400.0;
const LEAST_WINDOW_S: f64 = 1200.0;
/// Posterior probability below which a detected event is withdrawn.
const WITHDRAWN: f64 = 0.3;

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
        let best = bank
            .iter()
            .map(Hypothesis::log_weight)
            .fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = bank.iter().map(|h| (h.log_weight() - best).exp()).collect();
        let total: f64 = weights.iter().sum();
        Marginals {
            bank,
            weights: weights.into_iter().map(|w| w / total).collect(),
        }
    }

    /// Returns the seconds within which accounts speak of the same event: half of those to the
    /// lead's next of its class, a day at most.
    fn window_s(&self, class: Class, from: Timestamp) -> f64 {
        // The nearest is the event itself.
        let mut nearest = [f64::INFINITY; 2];
        for event in self.bank[0].events.iter().filter(|e| e.probability > 0.5) {
            let apart = event.from.seconds_since(from).abs();
            if Class::of(event.kind) == class && apart < nearest[1] {
                nearest = [nearest[0].min(apart), nearest[0].max(apart)];
            }
        }
        (nearest[1] / 2.0).clamp(LEAST_WINDOW_S, SAME_EVENT_S)
    }

    /// Returns the lead's event of a class at about a time.
    fn leads(&self, class: Class, from: Timestamp) -> Option<&'a Event> {
        nearest(&self.bank[0], class, from, self.window_s(class, from))
    }

    /// Returns the marginal of an event of a class at about a time.
    fn event(&self, class: Class, from: Timestamp) -> Found {
        let mut found = Found {
            probability: 0.0,
            kinds: Vec::new(),
            earliest: from,
            latest: from,
        };
        let within_s = self.window_s(class, from);
        for (hypothesis, weight) in self.bank.iter().zip(&self.weights) {
            let mut sum = 0.0;
            for event in within(hypothesis, class, from, within_s) {
                let weight = weight * event.probability;
                sum += weight;
                match found.kinds.iter_mut().find(|(kind, _)| *kind == event.kind) {
                    Some((_, sum)) => *sum += weight,
                    None => found.kinds.push((event.kind, weight)),
                }
                if weight > 0.02 {
                    found.earliest = found.earliest.min(event.from);
                    found.latest = found.latest.max(event.from);
                }
            }
            found.probability += sum.min(*weight);
        }
        found.kinds.sort_by(|a, b| b.1.total_cmp(&a.1));
        found
    }
}

/// Returns a hypothesis's events of a class within some seconds of a time.
fn within(
    hypothesis: &Hypothesis,
    class: Class,
    from: Timestamp,
    within_s: f64,
) -> impl Iterator<Item = &Supposed> {
    hypothesis.events.iter().filter(move |event| {
        Class::of(event.kind) == class && event.from.seconds_since(from).abs() <= within_s
    })
}

/// Returns a hypothesis's event of a class nearest to a time, within some seconds.
fn nearest(
    hypothesis: &Hypothesis,
    class: Class,
    from: Timestamp,
    within_s: f64,
) -> Option<&Event> {
    let likely = within(hypothesis, class, from, within_s).filter(|e| e.probability > 0.5);
    let apart = |e: &Event| e.from.seconds_since(from).abs();
    let events = likely.map(|supposed| supposed.event.as_ref());
    events.min_by(|a: &&Event, b| apart(a).total_cmp(&apart(b)))
}

impl Tracker {
    /// Detects events that have become certain, and withdraws those that no longer are.
    pub(super) fn detect(&mut self, now: Timestamp) {
        let marginals = Marginals::new(&self.bank);
        for detected in &mut self.detected {
            let is_open = now.seconds_since(detected.event.from) < SETTLED_S;
            if detected.withdrawn.is_some() || !(is_open || detected.event.until.is_none()) {
                continue;
            }
            let found = marginals.event(detected.class, detected.event.from);
            if is_open && found.probability < WITHDRAWN {
                detected.withdrawn = Some(now);
            } else if found.probability > 0.5
                && let Some(event) = marginals.leads(detected.class, detected.event.from)
            {
                detected.event.until = event.until;
                detected.event.ship_at_end.clone_from(&event.ship_at_end);
                if is_open {
                    detected.event = event.clone();
                    detected.kinds = found.kinds;
                    detected.earliest = found.earliest;
                    detected.latest = found.latest;
                }
            }
        }
        let mut more = Vec::new();
        for event in self.bank[0].events.iter().filter(|e| e.probability > 0.5) {
            let class = Class::of(event.kind);
            let is_detected = |detected: &Detected| {
                detected.class == class
                    && detected.withdrawn.is_none()
                    && detected.event.from.seconds_since(event.from).abs()
                        <= marginals.window_s(class, event.from)
            };
            if self.detected.iter().any(is_detected) || now.seconds_since(event.from) > SETTLED_S {
                continue;
            }
            let found = marginals.event(class, event.from);
            if found.probability > class.threshold() {
                more.push(Detected {
                    class,
                    event: Event::clone(event),
                    at: now,
                    withdrawn: None,
                    kinds: found.kinds,
                    earliest: found.earliest,
                    latest: found.latest,
                });
            }
        }
        self.detected.extend(more);
    }
}
