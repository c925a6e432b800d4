//! Extra drift of bx and by: the decay of a step, which lasts for weeks, or a drift.

use crate::change::filter::Filter;
use crate::change::priors;
use crate::observation::Observation;

/// Extra drift after a change.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ExtraDrift {
    /// First row after the change.
    since: usize,
    /// Variance of the drift of bx and by in thirty days, population units.
    variance: f64,
    /// True if it is a drift rather than a decay.
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

    /// Makes the extra drift of a vessel that drifts since row `since`.
    pub(crate) fn from_drift(since: usize, variance: f64) -> ExtraDrift {
        ExtraDrift {
            since,
            variance,
            is_drift: true,
        }
    }

    /// Returns true if the vessel drifts at row `k`.
    pub(crate) fn is_drifting(&self, observations: &[Observation], k: usize) -> bool {
        self.is_drift && self.variance(observations, k) > 0.0
    }

    /// Returns the variance beyond the usual drift at row `k`.
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
