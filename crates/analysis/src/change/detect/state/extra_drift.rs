//! What lightning leaves in a ship fades for weeks.

use crate::change::filter::Filter;
use crate::change::priors;
use crate::observation::Observation;

/// A step that fades.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ExtraDrift {
    /// The first row after it.
    since: usize,
    /// Variance of bx's and by's drift in thirty days, population units.
    variance: f64,
    /// Whether it is a drift rather than what fades.
    is_drift: bool,
}

impl ExtraDrift {
    pub(crate) fn from_step(since: usize, before: &Filter, after: &Filter) -> ExtraDrift {
        let moved = |state: usize| after.mean[state] - before.mean[state];
        let size = moved(0).hypot(moved(2));
        ExtraDrift {
            since,
            variance: (priors::STEP_DECAY_SHARE * size).powi(2),
            is_drift: false,
        }
    }

    /// A ship that drifts on from row `since`.
    pub(crate) fn from_drift(since: usize, variance: f64) -> ExtraDrift {
        ExtraDrift {
            since,
            variance,
            is_drift: true,
        }
    }

    /// Whether the ship drifts when row `k` is read.
    pub(crate) fn is_drifting(&self, observations: &[Observation], k: usize) -> bool {
        self.is_drift && self.variance(observations, k) > 0.0
    }

    /// Beside the usual drift, when row `k` is read.
    pub(crate) fn variance(&self, observations: &[Observation], k: usize) -> f64 {
        if self.variance == 0.0 || k < self.since {
            return 0.0;
        }
        let since = observations[self.since].time;
        let age_s = observations[k].time.zip(since);
        let fades = age_s.is_some_and(|(now, then)| now.seconds_since(then) < priors::STEP_DECAY_S);
        if fades { self.variance } else { 0.0 }
    }
}
