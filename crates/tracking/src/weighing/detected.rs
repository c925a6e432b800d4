//! Events that have become certain, and what is detected of them.

use super::records::{Class, Detected, EventPosterior};
use super::tracker::Tracker;
use crate::constants::{IMPROBABLE, ROW_S, SETTLED_S, WITHDRAWN};
use crate::hypotheses::hypothesis::{Event, Hypothesis, Supposed};
use crate::hypotheses::kinds::Kind;
use binnacle_compass::time::Timestamp;

/// Marginals of the posterior over events.
struct Marginals<'a> {
    bank: &'a [Hypothesis],
    weights: Vec<f64>,
}

/// Event of the lead with its posterior.
struct Judged<'a> {
    event: &'a Event,
    posterior: EventPosterior,
}

impl Judged<'_> {
    /// Returns the posterior probability from which the event is detected.
    fn threshold(&self) -> f64 {
        Class::of(self.event.kind).threshold()
    }

    fn detected(self, at: Timestamp) -> Detected {
        Detected {
            class: Class::of(self.event.kind),
            event: self.event.clone(),
            at,
            withdrawn: None,
            posterior: self.posterior,
        }
    }
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
    /// lead's next of its class, and no more than its kind is dated within.
    fn window_s(&self, kind: Kind, from: Timestamp) -> f64 {
        let class = Class::of(kind);
        // The nearest is the event itself.
        let mut nearest = [f64::INFINITY; 2];
        for event in self.bank[0].events.iter().filter(|e| e.is_likely()) {
            let apart = event.from.seconds_since(from).abs();
            if Class::of(event.kind) == class && apart < nearest[1] {
                nearest = [nearest[0].min(apart), nearest[0].max(apart)];
            }
        }
        (nearest[1] / 2.0).clamp(2.0 * ROW_S, kind.dated_within_s())
    }

    /// Returns the lead's events that are not among those detected.
    fn undetected(
        &'a self,
        detected: &'a [Detected],
        now: Timestamp,
    ) -> impl Iterator<Item = Judged<'a>> {
        let is_known = move |event: &Event, class: Class| {
            let window_s = self.window_s(event.kind, event.from);
            detected.iter().any(|detected| {
                detected.class == class
                    && detected.withdrawn.is_none()
                    && detected.event.from.seconds_since(event.from).abs() <= window_s
            })
        };
        let likely = self.bank[0].events.iter().filter(|e| e.is_likely());
        let events = likely.map(|supposed| supposed.event.as_ref());
        let judged = events.filter(move |event| now.seconds_since(event.from) <= SETTLED_S);
        judged.filter_map(move |event| {
            let class = Class::of(event.kind);
            (!is_known(event, class)).then(|| Judged {
                event,
                posterior: self.event(event.kind, event.from),
            })
        })
    }

    /// Returns the lead's event of a kind's class at about a time.
    fn leads(&self, kind: Kind, from: Timestamp) -> Option<&'a Event> {
        let is_meant = |other| other == Class::of(kind);
        nearest(&self.bank[0], is_meant, from, self.window_s(kind, from))
    }

    /// Returns the posterior of an event of a kind's class at about a time.
    fn event(&self, kind: Kind, from: Timestamp) -> EventPosterior {
        let class = Class::of(kind);
        let mut found = EventPosterior {
            probability: 0.0,
            kinds: Vec::new(),
            instead: Vec::new(),
            in_port: 0.0,
            is_over: 0.0,
            end: None,
            earliest: from,
            latest: from,
        };
        let within_s = self.window_s(kind, from);
        let mut likeliest_end = 0.0;
        for (hypothesis, weight) in self.bank.iter().zip(&self.weights) {
            let mut sum = 0.0;
            for event in within(hypothesis, |other| other == class, from, within_s) {
                let weight = weight * event.probability;
                sum += weight;
                add(&mut found.kinds, event.kind, weight);
                found.in_port += weight * f64::from(u8::from(event.in_port));
                if let Some(end) = event.until {
                    found.is_over += weight;
                    if weight > likeliest_end {
                        (likeliest_end, found.end) = (weight, Some(end));
                    }
                }
                if weight > IMPROBABLE {
                    found.earliest = found.earliest.min(event.from);
                    found.latest = found.latest.max(event.from);
                }
            }
            let other = nearest(hypothesis, |other| other != class, from, within_s);
            if let Some(other) = other.filter(|_| sum < *weight) {
                add(&mut found.instead, other.kind, weight - sum);
            }
            found.probability += sum.min(*weight);
        }
        for kinds in [&mut found.kinds, &mut found.instead] {
            kinds.sort_by(|a, b| b.1.total_cmp(&a.1));
        }
        found
    }
}

/// Adds to the probability of a kind.
fn add(kinds: &mut Vec<(Kind, f64)>, kind: Kind, probability: f64) {
    match kinds.iter_mut().find(|(known, _)| *known == kind) {
        Some((_, sum)) => *sum += probability,
        None => kinds.push((kind, probability)),
    }
}

/// Returns a hypothesis's events of some classes within some seconds of a time.
fn within(
    hypothesis: &Hypothesis,
    is_meant: impl Fn(Class) -> bool,
    from: Timestamp,
    within_s: f64,
) -> impl Iterator<Item = &Supposed> {
    hypothesis.events.iter().filter(move |event| {
        is_meant(Class::of(event.kind)) && event.from.seconds_since(from).abs() <= within_s
    })
}

/// Returns a hypothesis's likely event of some classes nearest to a time, within some seconds.
fn nearest(
    hypothesis: &Hypothesis,
    is_meant: impl Fn(Class) -> bool,
    from: Timestamp,
    within_s: f64,
) -> Option<&Event> {
    let likely = within(hypothesis, is_meant, from, within_s).filter(|e| e.is_likely());
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
            let found = marginals.event(detected.event.kind, detected.event.from);
            if is_open && found.probability < WITHDRAWN {
                detected.withdrawn = Some(now);
            } else if found.probability > 0.5
                && let Some(event) = marginals.leads(detected.event.kind, detected.event.from)
            {
                detected.event.until = event.until;
                detected.event.ship_at_end.clone_from(&event.ship_at_end);
                if is_open {
                    detected.event = event.clone();
                    detected.posterior = found;
                } else {
                    (detected.posterior.is_over, detected.posterior.end) =
                        (found.is_over, found.end);
                }
            }
        }
        let more: Vec<Detected> = marginals
            .undetected(&self.detected, now)
            .filter(|judged| judged.posterior.probability > judged.threshold())
            .map(|judged| judged.detected(now))
            .collect();
        self.detected.extend(more);
    }

    /// Returns the events that are likelier than not but not certain, after the last row.
    pub(crate) fn suspected(&self) -> Vec<Detected> {
        let Some(last) = self.rows.back() else {
            return Vec::new();
        };
        Marginals::new(&self.bank)
            .undetected(&self.detected, last.time)
            .filter(|judged| judged.posterior.probability > 0.5)
            .map(|judged| judged.detected(last.time))
            .collect()
    }
}
