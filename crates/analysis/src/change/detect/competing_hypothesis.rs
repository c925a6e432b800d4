//! What else the last change may have been: the zero of the compass that moved, or a
//! drift that goes on.
//!
//! What always holds: on one heading either looks like a step, so that a step is told
//! first; what explains the rows since far better takes its place, once, and it stays
//! one change.

use super::dating::DatedChange;
use super::state::CompetingHypothesis;
use super::state::{Detector, ExtraDrift, Leads};
use crate::change::event::{Event, EventKind, remove_events, snapshot};
use crate::change::filter::{CONSTANT_STATE, Filter, Measurement};
use crate::change::hypotheses::Fork;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::jump_models::apply_alignment_step;
use crate::change::port_call_returns::{Baseline, StepOrigin};
use crate::change::priors;
use crate::change::thresholds::{
    ALIGNMENT_SECTOR_ROWS, ALIGNMENT_SECTORS, ALIGNMENT_SECTORS_BETWEEN,
    COMPETING_DEFICIT_LOG_LIKELIHOOD_RATIO, COMPETING_DROPPED_LOG_LIKELIHOOD_RATIO,
    COMPETING_LOG_LIKELIHOOD_RATIO, COMPETING_MAX_ROWS,
    COMPETING_WITH_SEVERAL_LOG_LIKELIHOOD_RATIO, DRIFT_BEFORE_CARGO_ROWS,
    DRIFT_WITH_CARGO_EXTRA_LOG_LIKELIHOOD_RATIO, STEP_KEPT_LOG_LIKELIHOOD_RATIO,
};

/// Standard deviation of the zero's step, degrees, unless the first reading after it is
/// further off.
const LINEARISATION_ROUNDS: usize = 3;

impl Detector<'_> {
    /// The rivals of a step that was dated just now.
    pub(crate) fn rivals_of(&self, k: usize, dated: &DatedChange) -> Vec<CompetingHypothesis> {
        let creeping = priors::DRIFT_VARIANCES
            .iter()
            .filter_map(|drift| self.creeping(k, dated, *drift));
        let apply_alignment_step = self
            .has_both(k)
            .then(|| self.apply_alignment_step(k, dated));
        creeping.chain(apply_alignment_step).collect()
    }

    /// The zero moved when the step is dated.
    fn apply_alignment_step(&self, k: usize, dated: &DatedChange) -> CompetingHypothesis {
        CompetingHypothesis {
            what: EventKind::Alignment,
            event: self.events.len() - 1,
            drift: 0.0,
            first: dated.first,
            between: dated.between,
            filter: self.zero_moved(k, &dated.before, dated.first),
            before: dated.before.clone(),
        }
    }

    /// The filter with the zero having moved before row `first`, having read all rows until `k`.
    fn zero_moved(&self, k: usize, before: &Filter, first: usize) -> Filter {
        let mut filter = before.clone();
        // So often, for the rows are to be linearised at where it ends.
        for _ in 0..LINEARISATION_ROUNDS {
            let at = filter.unknowns();
            let moved_deg = filter.mean[CONSTANT_STATE] - before.mean[CONSTANT_STATE];
            let next = self.measure(first, &at);
            let size_deg = before
                .innovation_deg(&next)
                .max(priors::ALIGNMENT_STEP_SD_DEG);
            let moved = apply_alignment_step(before, moved_deg, size_deg);
            filter = self.run(moved, first..k + 1, &at);
        }
        filter
    }

    /// The ship has drifted since the likeliest of the times that the bank keeps.
    fn creeping(&self, k: usize, dated: &DatedChange, drift: f64) -> Option<CompetingHypothesis> {
        let spawns = &self.bank.spawns;
        let oldest = spawns.first()?.at;
        let at = dated.filter.unknowns();
        let rows = oldest..k + 1;
        let measured: Vec<Measurement> = rows
            .map(|row| self.measure_drifting(row, &at, drift))
            .collect();
        let run = |(place, spawn): (usize, &Fork)| {
            let mut filter = spawn.origin().clone();
            for m in &measured[spawn.at - oldest..] {
                filter.take(m, &self.noise, None);
            }
            (place, filter)
        };
        let runs = spawns.iter().enumerate().map(run);
        let (place, filter) =
            runs.max_by(|a, b| a.1.log_likelihood.total_cmp(&b.1.log_likelihood))?;
        let row = |place: usize| spawns[place].at;
        let first = row(place).max(1);
        Some(CompetingHypothesis {
            what: EventKind::Drift,
            event: self.events.len() - 1,
            drift,
            first,
            between: (
                row(place.saturating_sub(1)).clamp(1, first),
                row((place + 1).min(spawns.len() - 1)).max(first),
            ),
            filter,
            before: spawns[place].origin().clone(),
        })
    }

    /// They read the row that the filter has read.
    pub(crate) fn take_in_rivals(&mut self, k: usize) {
        let mut rivals = std::mem::take(&mut self.rivals);
        for rival in &mut rivals {
            let at = rival.filter.unknowns();
            let m = self.measure_drifting(k, &at, rival.drift);
            rival.filter.take(&m, &self.noise, None);
        }
        let hopeless = self.null.log_likelihood - COMPETING_DROPPED_LOG_LIKELIHOOD_RATIO;
        rivals.retain(|r| r.filter.log_likelihood > hopeless && k < r.first + COMPETING_MAX_ROWS);
        self.rivals = rivals;
    }

    /// Puts the likeliest rival in the place of the last step, if it explains the rows
    /// far better and no less well than another step would.
    pub(crate) fn settle_rivals(&mut self, k: usize, leads: &Leads) -> bool {
        let of_kind = |kind: HypothesisKind| leads[kind as usize].map_or(0.0, |lead| lead.nats);
        let (step, burst) = (
            of_kind(HypothesisKind::Step),
            of_kind(HypothesisKind::Transient),
        );
        // What drifts may well have come back: that she did is simpler.
        let back = self.candidate(leads).map_or(0.0, |back| back.nats);
        let back = back.max(of_kind(HypothesisKind::Return));
        let lead =
            |rival: &CompetingHypothesis| rival.filter.log_likelihood - self.null.log_likelihood;
        let later = |rival: &CompetingHypothesis| {
            let later = rival.event + 1..self.events.len();
            later.filter(|event| self.is_standing_step(*event)).count()
        };
        let worth = |place: usize| {
            let rival = &self.rivals[place];
            lead(rival) + priors::SPARED_STEP_LOG_ODDS * later(rival) as f64
        };
        let likeliest = (0..self.rivals.len()).max_by(|&a, &b| worth(a).total_cmp(&worth(b)));
        let Some(place) = likeliest else {
            return false;
        };
        let (nats, of) = (lead(&self.rivals[place]), self.rivals[place].event);
        let mut steps = (of..self.events.len()).filter(|&e| self.is_standing_step(e));
        let is_drift = self.rivals[place].what == EventKind::Drift;
        let in_port = is_drift && steps.all(|event| self.is_cargo_likely(event));
        let mut enough = if later(&self.rivals[place]) > 0 {
            COMPETING_WITH_SEVERAL_LOG_LIKELIHOOD_RATIO
        } else {
            COMPETING_LOG_LIKELIHOOD_RATIO
        };
        if in_port {
            // Cargo comes on board at once: nothing went before it.
            if self.rivals[place].first + DRIFT_BEFORE_CARGO_ROWS > self.events[of].between.0 {
                return false;
            }
            enough += DRIFT_WITH_CARGO_EXTRA_LOG_LIKELIHOOD_RATIO;
        }
        if nats < enough
            || nats < step - COMPETING_DEFICIT_LOG_LIKELIHOOD_RATIO
            || nats < burst
            || nats < back
        {
            return false;
        }
        // Another step upon the first is the rarer by far.
        let is_needless = step > COMPETING_LOG_LIKELIHOOD_RATIO;
        if self.rivals[place].what == EventKind::Alignment
            && !is_needless
            && !self.tells_from_step(place, k)
        {
            return false;
        }
        if self.rivals[place].what == EventKind::Alignment {
            let rival = &self.rivals[place];
            let mut step = self.step_anew(k, &rival.before, rival.first);
            let zero = self.zero_moved(k, &rival.before, rival.first);
            let trails = zero.log_likelihood - step.log_likelihood;
            if trails < STEP_KEPT_LOG_LIKELIHOOD_RATIO {
                // What was gained meanwhile by being told of a burst, it has gained, too.
                step.log_likelihood = rival.filter.log_likelihood - trails;
                self.step_is(k, of, step);
                return true;
            }
        }
        let rival = self.rivals.swap_remove(place);
        self.rivals.clear();
        self.calls.forget(of);
        self.forget_later_steps(of);
        let event = &mut self.events[of];
        let was = CompetingHypothesis {
            what: event.what,
            event: of,
            drift: 0.0,
            first: event.first,
            between: event.between,
            filter: self.null.clone(),
            before: rival.before.clone(),
        };
        event.what = rival.what;
        event.over_step_log_likelihood_ratio = if rival.what == EventKind::Step {
            0.0
        } else {
            nats
        };
        event.before = snapshot(&rival.before);
        event.after = snapshot(&rival.filter);
        (event.first, event.between) = (rival.first, rival.between);
        self.unsettled = match rival.what {
            EventKind::Drift => ExtraDrift::creeping(k, rival.drift),
            _ => ExtraDrift::default(),
        };
        self.apply_alignment_step = None;
        // Two courses may tell of either what the next one does not.
        let mut rivals = Vec::new();
        match rival.what {
            EventKind::Alignment => {
                rivals.push(was);
                self.apply_alignment_step = Some((of, rival.before));
            }
            EventKind::Step => self.step_after_all(&rival),
            _ => {}
        }
        self.take_over(k, rival.filter, rival.first);
        self.rivals = rivals;
        true
    }

    /// What had been taken for a zero that moved was a step.
    fn step_after_all(&mut self, step: &CompetingHypothesis) {
        let at_port = self.began_in_port(step.event);
        if !at_port {
            self.unsettled = ExtraDrift::after(step.first, &step.before, &step.filter);
        }
        self.calls.step(Baseline {
            event: step.event,
            filter: step.before.clone(),
            began: if at_port {
                StepOrigin::AtPort
            } else {
                StepOrigin::AtSea
            },
            latest: self.observations[step.between.1].time,
            calls: 0,
        });
    }

    /// By how much it is likelier that the zero moved than that the ship did, for each step of
    /// which that is open.
    pub(crate) fn note_zeros(&mut self) {
        for rival in self
            .rivals
            .iter()
            .filter(|r| r.what == EventKind::Alignment)
        {
            let nats = rival.filter.log_likelihood - self.null.log_likelihood;
            if let Some(event) = self.events.get_mut(rival.event) {
                event.alignment_over_step_log_likelihood_ratio = Some(nats);
            }
        }
    }

    /// Whether she has sailed on headings since that tell a zero that moved from a step: on
    /// one, and on two that lie close, a step does the same.
    fn tells_from_step(&self, place: usize, k: usize) -> bool {
        let mut rows = [0; ALIGNMENT_SECTORS];
        for o in &self.observations[self.rivals[place].first..=k] {
            rows[(o.compass.degrees() / 360.0 * ALIGNMENT_SECTORS as f64) as usize
                % ALIGNMENT_SECTORS] += 1;
        }
        let sailed = |sector: usize| rows[sector % ALIGNMENT_SECTORS] >= ALIGNMENT_SECTOR_ROWS;
        let apart = ALIGNMENT_SECTORS_BETWEEN + 1..ALIGNMENT_SECTORS - ALIGNMENT_SECTORS_BETWEEN;
        (0..ALIGNMENT_SECTORS).any(|one| sailed(one) && apart.clone().any(|far| sailed(one + far)))
    }

    /// What had been taken for further steps was the same.
    pub(crate) fn forget_later_steps(&mut self, of: usize) {
        let is_gone = |place: usize, event: &Event| match event.what {
            EventKind::Step => place > of,
            EventKind::Return(step) => step >= of && self.events[step].what == EventKind::Step,
            _ => false,
        };
        let gone: Vec<bool> = self
            .events
            .iter()
            .enumerate()
            .map(|(p, e)| is_gone(p, e))
            .collect();
        let moved = remove_events(&mut self.events, gone);
        self.burst = self.burst.map(&moved);
        if let Some((place, _)) = &mut self.misled {
            *place = moved(*place);
        }
    }

    fn is_cargo_likely(&self, event: usize) -> bool {
        self.began_in_port(event) || self.is_said_on_board(self.events[event].first)
    }

    fn began_in_port(&self, event: usize) -> bool {
        let (earliest, latest) = self.events[event].between;
        (earliest..=latest).any(|row| self.is_call(row))
    }

    /// What the filter gained by being told of a burst, its rivals would have gained, too.
    pub(crate) fn credit_rivals(&mut self, kind: HypothesisKind) {
        let gained = self.bank.lead(kind, &self.null).map_or(0.0, |l| l.nats);
        let rivals = self.rivals.iter_mut().map(|rival| &mut rival.filter);
        let doubts = self.doubt.iter_mut().flat_map(|doubt| &mut doubt.without);
        for filter in rivals.chain(doubts) {
            filter.log_likelihood += gained;
        }
    }
}
