//! What may have happened and is not certain: the model in force allows for it.
//!
//! What always holds: only the last epoch's model is made wider, and nothing is told by it.

use super::Course;
use crate::analyse::changes::{Begun, Ended, Misled};
use crate::analyse::either::either;
use crate::analyse::epoch::{Reference, empty_epoch};
use crate::analyse::reading::Reading;
use binnacle_compass::result::{Cause, Change, Epoch};
use binnacle_compass::ship::PARAMETERS;

impl Course {
    /// Widens the last epoch's model where the ship may be again as she was in the
    /// epoch `base`.
    pub(super) fn allow_for_end(
        &mut self,
        ended: &Ended,
        base: Option<usize>,
        readings: &[Reading],
        reference: &Reference,
    ) {
        let resumed = Epoch {
            resumes: base,
            ..empty_epoch(Some(ended.at), None)
        };
        let from = readings.partition_point(|r| r.sample().time < ended.at);
        let mut stretch = self.stretch(&resumed, 0..0, reference);
        // As earlier ones: what does not fit the ship with cargo may fit her without.
        stretch.earlier.push(from..readings.len());
        let base = base.and_then(|_| stretch.model(readings));
        let laden = self.epochs.last().and_then(|epoch| epoch.model.as_ref());
        let open = base
            .zip(laden)
            .and_then(|(base, laden)| either(laden, &base, ended.probability));
        if let Some(last) = self.epochs.last_mut().filter(|_| open.is_some()) {
            last.model = open;
        }
    }

    /// Widens the last epoch's model where the ship may be another since a port call.
    pub(super) fn allow_for_change(
        &mut self,
        begun: &Begun,
        readings: &[Reading],
        reference: &Reference,
    ) {
        let changed = Epoch {
            begun_by_change: Some(Cause::Unknown),
            ..empty_epoch(Some(begun.at), None)
        };
        let from = readings.partition_point(|r| r.sample().time < begun.at);
        let stretch = self.stretch(&changed, from..readings.len(), reference);
        let now = self.epochs.last().and_then(|epoch| epoch.model.as_ref());
        let open = stretch
            .model(readings)
            .zip(now)
            .and_then(|(changed, now)| either(now, &changed, begun.probability));
        if let Some(last) = self.epochs.last_mut().filter(|_| open.is_some()) {
            last.model = open;
        }
    }

    /// Widens the last epoch's model where what began it may have been that the compass's
    /// zero moved.
    pub(super) fn allow_for_zero(
        &mut self,
        probability: f64,
        readings: &[Reading],
        reference: &Reference,
    ) {
        let Some((mut last, own)) = self.epochs.pop().zip(self.ranges.pop()) else {
            return;
        };
        let moved = Epoch {
            begun_by_change: Some(Cause::Alignment),
            ..empty_epoch(last.from, None)
        };
        let moved = self.stretch(&moved, own.clone(), reference).model(readings);
        let open = last
            .model
            .as_ref()
            .zip(moved)
            .and_then(|(now, moved)| either(now, &moved, probability));
        last.model = open.or(last.model);
        self.push(last, own);
    }

    /// Widens the last epoch's model where it may have been the compass's zero that moved, and
    /// not the only reference's.
    pub(super) fn allow_for_misled(&mut self, misled: &Misled) {
        let Some(model) = self.epochs.last_mut().and_then(|last| last.model.as_mut()) else {
            return;
        };
        let mut moved = model.clone();
        moved.parameters_over_lambda = moved
            .parameters_over_lambda
            .with_compass_turned(-misled.moved_deg.to_radians());
        moved.constant_deg += misled.moved_deg;
        if let Some(covariance) = &mut moved.covariance {
            covariance[PARAMETERS][PARAMETERS] += misled.variance;
        }
        if let Some(open) = either(model, &moved, misled.probability) {
            *model = open;
        }
    }

    /// Widens the last epoch's model where the ship may have been struck hard just now.
    pub(super) fn allow_for_step(&mut self, variance_nt2: f64) {
        let last = self.epochs.last_mut().and_then(|last| last.model.as_mut());
        if let Some(covariance) = last.and_then(|model| model.covariance.as_mut()) {
            for j in [0, 2] {
                covariance[j][j] += variance_nt2;
            }
        }
    }
}

/// How likely it is that a change was the compass's zero, where it is not told as that and
/// the odds are worth a wider band.
pub(super) fn zero_besides(change: &Change) -> Option<f64> {
    let causes = change.causes.iter().filter(|c| c.cause != change.cause);
    let mut zero = causes.filter(|c| c.cause == Cause::Alignment);
    zero.next().map(|zero| zero.probability)
}
