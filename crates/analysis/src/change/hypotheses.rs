//! What else may have happened, and since when: copies of the filter that began
//! from it at different times, each with one thing upset.
//!
//! Copies with a step run all the time. Those with anything else, its rivals, are
//! of use only once a step leads, or one row after another surprises: then they are
//! made of what the steps began from, and of the last measurements, and given up again
//! when nothing leads.
//!
//! What always holds: at most [`CAPACITY`] times are kept, their ages spaced
//! about geometrically; the time of the likeliest copy of every kind is among them.

use super::filter::{Filter, Measurement, NoiseVariances};
use super::hypothesis_kind::{
    ALL_KINDS, HypothesisKind, OTHER_KINDS, REFERENCE_STEPS, STEPS, TRANSIENTS,
};
use super::jump_models::{
    EarlierState, USUAL_TRANSIENT, apply_jump, misled, reset_variation, transient_noise,
};
use crate::change::priors;
use crate::change::thresholds::{
    AWAKE_MIN_ROWS, ROW_FORGOTTEN_EXCESS_LOSS, ROW_MAX_EXCESS_LOSS, SEVERE_TRANSIENT_DEG,
    SLEEP_LOG_LIKELIHOOD_RATIO, STEP_DROPPED_LOG_LIKELIHOOD_RATIO, STEP_DROPPED_MIN_ROWS,
    TRANSIENT_END_FORK_LOG_LIKELIHOOD_RATIO, TRANSIENT_MAX_S, WAKE_EXCESS_LOSS,
    WAKE_LOG_LIKELIHOOD_RATIO,
};
use std::collections::VecDeque;

/// Times that are kept.
const CAPACITY: usize = 16;
/// A copy older than this is given up, rows.
const MAX_AGE_ROWS: usize = 4320;
/// Rivals are awake from when a step leads by this until nothing leads by that, nats;
/// they know of so many measurements at most.
const REMEMBERED_ROWS: usize = 432;

/// A time at which something may have happened.
#[derive(Clone, Debug)]
pub(crate) struct Fork {
    /// The first row after it.
    pub(crate) at: usize,
    /// The filter then; boxed, as spawns move up whenever one is given up.
    origin: Box<Filter>,
    /// The first row of the burst that may be over.
    pub(crate) astray_from: Option<usize>,
    /// Boxed, as most are none.
    copies: [Option<Box<Filter>>; ALL_KINDS.len()],
    age_s: f64,
    /// How far the compass was astray since, degrees where H is 24 µT.
    disturbance_deg: f64,
    /// Whether the reference's copy is to be upset by the next reading.
    is_fresh: bool,
    /// By how much its step is likelier beforehand than one at sea.
    beforehand_nats: f64,
}

impl Fork {
    /// Makes the copies that rival a step.
    fn wake(&mut self, earlier: Option<EarlierState<'_>>) {
        let now = &self.origin;
        for kind in REFERENCE_STEPS {
            self.copies[kind as usize] = Some(now.clone());
        }
        self.copies[HypothesisKind::Transient as usize] =
            Some(Box::new(apply_jump(now, HypothesisKind::Transient)));
        self.copies[HypothesisKind::Return as usize] =
            earlier.map(|earlier| Box::new(earlier.again(now)));
        self.is_fresh = true;
    }

    /// All but a large step, which reads rows of its own.
    fn take(&mut self, m: &Measurement, noise: &NoiseVariances, kinds: &[HypothesisKind]) {
        let goes_on = self.age_s < TRANSIENT_MAX_S;
        self.age_s += m.seconds;
        if let Some(burst) = &self.copies[HypothesisKind::Transient as usize] {
            self.disturbance_deg = self
                .disturbance_deg
                .max(self.origin.variation_innovation_deg(m));
            if self.disturbance_deg > SEVERE_TRANSIENT_DEG
                && self.copies[HypothesisKind::SevereTransient as usize].is_none()
            {
                self.copies[HypothesisKind::SevereTransient as usize] = Some(burst.clone());
            }
        }
        let burst = |kind: HypothesisKind| match kind {
            HypothesisKind::Transient if goes_on => Some(USUAL_TRANSIENT),
            HypothesisKind::SevereTransient if goes_on => {
                Some(transient_noise(self.disturbance_deg))
            }
            _ => None,
        };
        if kinds.contains(&HypothesisKind::ReferenceStep) && std::mem::take(&mut self.is_fresh) {
            if m.difference.is_none() {
                // Of one reference there is nothing that tells which it is.
                self.copies[HypothesisKind::SatelliteStep as usize] = None;
            }
            for kind in REFERENCE_STEPS {
                if let Some(copy) = &mut self.copies[kind as usize] {
                    **copy = misled(copy, m, kind);
                }
            }
        }
        for &kind in kinds
            .iter()
            .filter(|kind| **kind != HypothesisKind::LargeStep)
        {
            let burst = burst(kind);
            if let Some(copy) = &mut self.copies[kind as usize] {
                copy.take(m, noise, burst.as_ref());
            }
        }
    }

    pub(crate) fn origin(&self) -> &Filter {
        &self.origin
    }

    pub(crate) fn copy(&self, kind: HypothesisKind) -> Option<&Filter> {
        self.copies[kind as usize].as_deref()
    }

    pub(crate) fn copy_mut(&mut self, kind: HypothesisKind) -> Option<&mut Filter> {
        self.copies[kind as usize].as_deref_mut()
    }

    pub(crate) fn set(&mut self, kind: HypothesisKind, copy: Filter) {
        self.copies[kind as usize] = Some(Box::new(copy));
    }

    pub(crate) fn disturbance_deg(&self) -> f64 {
        self.disturbance_deg
    }
}

/// By how much a copy is likelier than the filter that knows of nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lead {
    pub(crate) nats: f64,
    pub(crate) kind: HypothesisKind,
    /// The copy's place in the bank.
    pub(crate) spawn: usize,
}

#[derive(Default)]
pub(crate) struct HypothesisBank {
    /// From the oldest to the latest.
    pub(crate) spawns: Vec<Fork>,
    /// The last measurements, the latest last, and its row.
    memory: VecDeque<Measurement>,
    latest: usize,
    are_rivals_awake: bool,
    /// At least until this row.
    awake_until: usize,
    /// What surprises have added up to since they last woke the rivals, nats.
    surprise: f64,
}

impl HypothesisBank {
    /// Forgets all that may have happened for good.
    pub(crate) fn forget_lasting(&mut self) {
        let lasting = [
            HypothesisKind::Step,
            HypothesisKind::LargeStep,
            HypothesisKind::ReferenceStep,
            HypothesisKind::SatelliteStep,
        ];
        for spawn in &mut self.spawns {
            for kind in lasting {
                spawn.copies[kind as usize] = None;
            }
        }
    }

    /// Forgets all that may have happened.
    pub(crate) fn clear(&mut self) {
        self.spawns.clear();
        self.are_rivals_awake = false;
    }

    /// New copies of `now`, which are to begin with row `at`.
    pub(crate) fn spawn(
        &mut self,
        at: usize,
        now: &Filter,
        noise: &NoiseVariances,
        (earlier, in_port): (Option<EarlierState<'_>>, bool),
    ) {
        self.thin(at, now);
        self.rest(at, now);
        let mut spawn = Fork {
            at,
            astray_from: None,
            origin: Box::new(now.clone()),
            copies: [const { None }; ALL_KINDS.len()],
            age_s: 0.0,
            disturbance_deg: 0.0,
            is_fresh: false,
            beforehand_nats: if in_port {
                priors::STEP_AT_PORT_CALL_LOG_ODDS
            } else {
                0.0
            },
        };
        let mut step = apply_jump(now, HypothesisKind::Step);
        step.log_likelihood += spawn.beforehand_nats;
        spawn.copies[HypothesisKind::Step as usize] = Some(Box::new(step));
        if self.are_rivals_awake {
            spawn.wake(earlier);
            let astray = self.likeliest(&TRANSIENTS, now);
            if let Some(lead) =
                astray.filter(|lead| lead.nats > TRANSIENT_END_FORK_LOG_LIKELIHOOD_RATIO)
            {
                let astray = &self.spawns[lead.spawn];
                spawn.astray_from = Some(astray.at);
                let over = astray.copy(lead.kind).map(|copy| match lead.kind {
                    HypothesisKind::SevereTransient => reset_variation(copy, noise),
                    _ => copy.clone(),
                });
                spawn.copies[HypothesisKind::TransientEnd as usize] = over.map(Box::new);
            }
        }
        self.spawns.push(spawn);
    }

    /// Takes in the measurement of row `at`; `null` has taken it in before, and it
    /// surprised by so much.
    pub(crate) fn take(
        &mut self,
        at: usize,
        m: Measurement,
        noise: &NoiseVariances,
        (null, surprise): (&Filter, f64),
        earlier: Option<EarlierState<'_>>,
    ) {
        for spawn in &mut self.spawns {
            spawn.take(&m, noise, &ALL_KINDS);
        }
        if self.memory.len() == REMEMBERED_ROWS {
            self.memory.pop_front();
        }
        self.memory.push_back(m);
        self.latest = at;
        let counted = surprise.min(ROW_MAX_EXCESS_LOSS) - ROW_FORGOTTEN_EXCESS_LOSS;
        self.surprise = (self.surprise + counted).max(0.0);
        let step = self
            .lead(HypothesisKind::Step, null)
            .map_or(0.0, |lead| lead.nats);
        let is_surprised = self.surprise > WAKE_EXCESS_LOSS;
        if is_surprised {
            self.surprise = 0.0;
            self.awake_until = at + AWAKE_MIN_ROWS;
        }
        if (is_surprised || step > WAKE_LOG_LIKELIHOOD_RATIO) && !self.are_rivals_awake {
            self.wake(noise, earlier);
        }
    }

    /// Makes the rivals, as if they had run all along.
    fn wake(&mut self, noise: &NoiseVariances, earlier: Option<EarlierState<'_>>) {
        self.are_rivals_awake = true;
        let known_from = self.latest + 1 - self.memory.len();
        for spawn in self.spawns.iter_mut().filter(|s| s.at >= known_from) {
            spawn.wake(earlier);
            spawn.age_s = 0.0;
            spawn.disturbance_deg = 0.0;
            for m in self.memory.iter().skip(spawn.at - known_from) {
                spawn.take(m, noise, &OTHER_KINDS);
            }
        }
    }

    /// Gives up rivals when nothing leads, and steps that trail for good.
    fn rest(&mut self, at: usize, null: &Filter) {
        let leads = ALL_KINDS.map(|kind| self.lead(kind, null).map_or(0.0, |lead| lead.nats));
        if at >= self.awake_until && leads.iter().all(|nats| *nats < SLEEP_LOG_LIKELIHOOD_RATIO) {
            self.are_rivals_awake = false;
            for spawn in &mut self.spawns {
                for kind in ALL_KINDS
                    .into_iter()
                    .filter(|kind| *kind != HypothesisKind::Step)
                {
                    spawn.copies[kind as usize] = None;
                }
            }
        }
        let hopeless = null.log_likelihood - STEP_DROPPED_LOG_LIKELIHOOD_RATIO;
        for spawn in self
            .spawns
            .iter_mut()
            .filter(|s| at - s.at > STEP_DROPPED_MIN_ROWS)
        {
            let step = &mut spawn.copies[HypothesisKind::Step as usize];
            if step.as_ref().is_some_and(|s| s.log_likelihood <= hopeless) {
                *step = None;
            }
        }
    }

    /// The likeliest copy of a kind.
    pub(crate) fn lead(&self, kind: HypothesisKind, null: &Filter) -> Option<Lead> {
        // Asleep there are none.
        if kind != HypothesisKind::Step && !self.are_rivals_awake {
            return None;
        }
        let copies = self.spawns.iter().enumerate();
        copies
            .filter_map(|(spawn, s)| {
                let nats = s.copy(kind)?.log_likelihood - null.log_likelihood;
                Some(Lead { nats, kind, spawn })
            })
            .max_by(|a, b| a.nats.total_cmp(&b.nats))
    }

    /// By how much what leads was likelier beforehand than the same at another time.
    pub(crate) fn beforehand_nats(&self, lead: Lead) -> f64 {
        match lead.kind {
            HypothesisKind::Step => self.spawns[lead.spawn].beforehand_nats,
            _ => 0.0,
        }
    }

    pub(crate) fn are_rivals_awake(&self) -> bool {
        self.are_rivals_awake
    }

    /// The likeliest copy of those in which the ship changed for good.
    pub(crate) fn step(&self, null: &Filter) -> Option<Lead> {
        self.likeliest(&STEPS, null)
    }

    /// The likeliest copy of those in which the field goes or went astray.
    pub(crate) fn passing(&self, null: &Filter) -> Option<Lead> {
        self.likeliest(
            &[
                HypothesisKind::Transient,
                HypothesisKind::SevereTransient,
                HypothesisKind::TransientEnd,
            ],
            null,
        )
    }

    /// The likeliest copy of those in which a reference changed.
    pub(crate) fn reference(&self, null: &Filter) -> Option<Lead> {
        self.likeliest(&REFERENCE_STEPS, null)
    }

    fn likeliest(&self, kinds: &[HypothesisKind], null: &Filter) -> Option<Lead> {
        let leads = kinds.iter().filter_map(|kind| self.lead(*kind, null));
        leads.max_by(|a, b| a.nats.total_cmp(&b.nats))
    }

    /// Makes room for one more.
    fn thin(&mut self, at: usize, null: &Filter) {
        self.spawns.retain(|s| at - s.at <= MAX_AGE_ROWS);
        if self.spawns.len() < CAPACITY {
            return;
        }
        let leaders = ALL_KINDS.map(|kind| self.lead(kind, null).map(|lead| lead.spawn));
        let age = |i: usize| (at - self.spawns[i].at) as f64;
        let closest = (1..self.spawns.len() - 1)
            .filter(|&i| !leaders.contains(&Some(i)))
            .min_by(|&i, &j| {
                let gap = |i: usize| age(i - 1) / age(i + 1);
                gap(i).total_cmp(&gap(j))
            });
        if let Some(closest) = closest {
            self.spawns.remove(closest);
        }
    }
}
