//! State of the detector, and measurement of rows.

use super::alternatives::{CompetingHypothesis, NoStepHypotheses, WeakTransient};
use super::extra_drift::ExtraDrift;
use super::leads::Leads;
use super::noise_learning::{LearningSchedule, LearntNoise};
use super::port_departures::PortDepartures;
use crate::change::detection::{CargoPeriod, DetectionInput};
use crate::change::event::{Event, EventKind};
use crate::change::filter::{Filter, Measurement, NoiseVariances, measurement};
use crate::change::hypotheses::HypothesisBank;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::jump_models::EarlierState;
use crate::change::large_step::{reference_share, relinearise};
use crate::change::port_call_returns::PortCallReturns;
use crate::change::port_calls::follows_port_call;
use crate::change::priors;
use crate::change::thresholds::{
    FIRST_CHANGE_ROW, FIRST_CHANGE_ROW_KNOWN_NOISE, WARM_UP_ROWS, WARM_UP_ROWS_KNOWN_NOISE,
};
use crate::estimate::{LinearisationPoint, Prior, RowFrame, Unknowns, frames, row};
use crate::observation::Observation;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::time::Timestamp;

pub(crate) struct Detector<'a> {
    pub(crate) observations: &'a [Observation],
    pub(crate) frames: Vec<RowFrame>,
    pub(crate) reported: &'a [Timestamp],
    pub(crate) cargo: &'a [CargoPeriod],
    pub(crate) prior: &'a Prior,
    /// True if the noise levels were known before the rows.
    pub(crate) is_noise_known: bool,
    pub(crate) levels: NoiseLevels,
    pub(crate) noise: NoiseVariances,
    /// State at which rows are linearised until the filter has learnt.
    pub(crate) start_unknowns: Unknowns,
    pub(crate) start_until: usize,
    /// First row of the present noise learning, and the next time of learning.
    pub(crate) learn_from: usize,
    pub(crate) next_learning: LearningSchedule,
    /// Days from which the levels were learnt.
    pub(crate) learnt_days: f64,
    pub(crate) null: Filter,
    pub(crate) bank: HypothesisBank,
    pub(crate) last_fork: usize,
    /// Earlier states of the vessel, and possible returns at port calls.
    pub(crate) returns: PortCallReturns,
    pub(crate) departures: PortDepartures,
    /// Current fault of a reference.
    pub(crate) reference_fault: Option<FilterBefore>,
    /// Last alignment change, if nothing else changed since.
    pub(crate) alignment_change: Option<FilterBefore>,
    pub(crate) extra_drift: ExtraDrift,
    /// Competing explanations of the last step.
    pub(crate) competing: Vec<CompetingHypothesis>,
    /// Hypotheses without the last step.
    pub(crate) no_step: Option<NoStepHypotheses>,
    /// Place of the current transient's event.
    pub(crate) transient: Option<usize>,
    /// First row of the last reported transient, and the filter before, until a lasting
    /// change is reported.
    pub(crate) before_transient: Option<(usize, Filter)>,
    /// A transient below the threshold.
    pub(crate) weak_transient: Option<WeakTransient>,
    pub(crate) events: Vec<Event>,
}

impl<'a> Detector<'a> {
    pub(crate) fn new(
        observations: &'a [Observation],
        input: &DetectionInput<'a>,
        learnt: &LearntNoise,
    ) -> Detector<'a> {
        Detector {
            observations,
            frames: frames(observations),
            reported: input.reported,
            cargo: input.cargo,
            prior: input.prior,
            is_noise_known: input.levels.is_some(),
            null: Filter::new(input.prior, &learnt.noise),
            levels: learnt.levels,
            noise: learnt.noise,
            start_unknowns: learnt.unknowns,
            start_until: learnt.until,
            learn_from: 0,
            next_learning: LearningSchedule::next(observations, 0, learnt.until, 0.0),
            learnt_days: 0.0,
            bank: HypothesisBank::default(),
            last_fork: 0,
            returns: PortCallReturns::default(),
            departures: PortDepartures::default(),
            reference_fault: None,
            alignment_change: None,
            extra_drift: ExtraDrift::default(),
            competing: Vec::new(),
            no_step: None,
            transient: None,
            before_transient: None,
            weak_transient: None,
            events: Vec::new(),
        }
    }

    pub(crate) fn first_change_row(&self) -> usize {
        if self.is_noise_known {
            FIRST_CHANGE_ROW_KNOWN_NOISE
        } else {
            FIRST_CHANGE_ROW
        }
    }

    pub(crate) fn warm_up_rows(&self) -> usize {
        if self.is_noise_known {
            WARM_UP_ROWS_KNOWN_NOISE
        } else {
            WARM_UP_ROWS
        }
    }

    /// Returns the leading step, reference's step, transient (ended or not) and return.
    pub(crate) fn leads(&self) -> Leads {
        [
            self.bank.step(&self.null),
            self.bank.reference_step(&self.null),
            self.bank.transient_lead(&self.null),
            self.bank.lead(HypothesisKind::Return, &self.null),
        ]
    }

    /// Returns the linearised measurement of row `k` for the null filter.
    pub(crate) fn measure_next(&self, k: usize) -> Measurement {
        if k < self.start_until {
            return self.measure(k, &self.start_unknowns);
        }
        relinearise(&self.null, &self.noise, |at| self.measure(k, at))
    }

    /// Returns the state at which row `k` is linearised.
    pub(crate) fn linearisation_point(&self, k: usize) -> Unknowns {
        if k < self.start_until {
            self.start_unknowns
        } else {
            self.null.unknowns()
        }
    }

    pub(crate) fn measure(&self, k: usize, at: &Unknowns) -> Measurement {
        self.measure_drifting(k, at, 0.0)
    }

    /// Returns the measurement of row `k` with an extra drift in thirty days, variance in
    /// population units.
    pub(crate) fn measure_drifting(&self, k: usize, at: &Unknowns, drift: f64) -> Measurement {
        let extra_drift = self.extra_drift.variance(self.observations, k);
        let seen = (priors::DRIFT_IN_GAP_MAX_S / self.seconds_since_previous(k)).min(1.0);
        self.measure_with_drift(k, at, extra_drift.max(seen * drift))
    }

    /// Returns the measurement of row `k` with the usual drift.
    pub(crate) fn measure_settled(&self, k: usize, at: &Unknowns) -> Measurement {
        self.measure_with_drift(k, at, 0.0)
    }

    pub(crate) fn measure_with_drift(
        &self,
        k: usize,
        at: &Unknowns,
        extra_drift: f64,
    ) -> Measurement {
        let (o, frame) = (&self.observations[k], &self.frames[k]);
        let row = row(o, frame, &LinearisationPoint::at(at, reference_share(at)));
        measurement(
            frame,
            &row,
            at,
            self.seconds_since_previous(k),
            &self.noise,
            extra_drift,
        )
    }

    /// Returns the time since the previous row.
    pub(crate) fn seconds_since_previous(&self, k: usize) -> f64 {
        let previous = k.checked_sub(1).and_then(|j| self.observations[j].time);
        match (previous, self.observations[k].time) {
            (Some(previous), Some(time)) => time.seconds_since(previous).max(0.0),
            _ => 0.0,
        }
    }

    pub(crate) fn is_port_call(&self, k: usize) -> bool {
        follows_port_call(self.observations, k) == Some(true)
    }

    /// Runs a filter over some rows, all linearised at one state.
    pub(crate) fn run_filter(
        &self,
        mut filter: Filter,
        rows: std::ops::Range<usize>,
        at: &Unknowns,
    ) -> Filter {
        for k in self.undisturbed_rows(rows) {
            filter.observe(&self.measure(k, at), &self.noise, None);
        }
        filter
    }

    /// Returns the rows without past transients.
    pub(crate) fn undisturbed_rows(
        &self,
        rows: std::ops::Range<usize>,
    ) -> impl Iterator<Item = usize> {
        let passed = self
            .events
            .iter()
            .filter(|event| event.kind == EventKind::Transient);
        let passed = passed.filter_map(|transient| Some(transient.first..=transient.last?));
        let passed: Vec<_> = passed.filter(|p| *p.end() >= rows.start).collect();
        rows.filter(move |row| !passed.iter().any(|passed| passed.contains(row)))
    }
}

/// Event that may be undone, and the filter before it.
pub(crate) struct FilterBefore {
    /// Place of the event in the list.
    pub(crate) event: usize,
    pub(crate) before: Filter,
}

/// Returns the state that may be restored: that of a reference first, which is soon
/// repaired, otherwise that before the last change.
pub(crate) fn earlier_state<'a>(
    reference_fault: Option<&'a FilterBefore>,
    alignment_change: Option<&'a FilterBefore>,
    calls: &'a PortCallReturns,
) -> Option<EarlierState<'a>> {
    let reference_step = reference_fault.map(|fault| EarlierState::Reference(&fault.before));
    let zero = || alignment_change.map(|change| EarlierState::Alignment(&change.before));
    let vessel = || {
        calls
            .baselines
            .last()
            .map(|base| EarlierState::Vessel(base.without_cargo()))
    };
    reference_step.or_else(zero).or_else(vessel)
}
