//! Possible changes that are not certain: the model in force allows for them.
//!
//! Only the last epoch's model is widened, and nothing is reported.

use super::builder::EpochBuilder;
use crate::analyse::changes::{PossibleAlignment, PossibleEnd, PossibleStart};
use crate::analyse::epoch::{Reference, empty_epoch};
use crate::analyse::mixture::mixture;
use crate::analyse::reading::Reading;
use binnacle_compass::result::{Cause, Epoch};
use binnacle_compass::ship::PARAMETERS;

impl EpochBuilder {
    /// Widens the last epoch's model where the vessel may have returned to its state in the
    /// epoch `base`.
    pub(crate) fn widen_for_end(
        &mut self,
        ended: &PossibleEnd,
        base: Option<usize>,
        readings: &[Reading],
        reference: &Reference,
    ) {
        let resumed = Epoch {
            resumes: base,
            ..empty_epoch(Some(ended.at), None)
        };
        let from = readings.partition_point(|r| r.sample().time < ended.at);
        let mut fit_input = self.fit_input(&resumed, 0..0, reference);
        // As in earlier epochs: an outlier with the cargo may fit the vessel without.
        fit_input.earlier.push(from..readings.len());
        let base = base.and_then(|_| fit_input.model(readings));
        let laden = self.epochs.last().and_then(|epoch| epoch.model.as_ref());
        let open = base
            .zip(laden)
            .and_then(|(base, laden)| mixture(laden, &base, ended.probability));
        if let Some(last) = self.epochs.last_mut().filter(|_| open.is_some()) {
            last.model = open;
        }
    }

    /// Widens the last epoch's model where the vessel may have changed at a port call.
    pub(crate) fn widen_for_undetected_change(
        &mut self,
        begun: &PossibleStart,
        readings: &[Reading],
        reference: &Reference,
    ) {
        let changed = Epoch {
            begun_by_change: Some(Cause::Unknown),
            ..empty_epoch(Some(begun.at), None)
        };
        let from = readings.partition_point(|r| r.sample().time < begun.at);
        let fit_input = self.fit_input(&changed, from..readings.len(), reference);
        let now = self.epochs.last().and_then(|epoch| epoch.model.as_ref());
        let open = fit_input
            .model(readings)
            .zip(now)
            .and_then(|(changed, now)| mixture(now, &changed, begun.probability));
        if let Some(last) = self.epochs.last_mut().filter(|_| open.is_some()) {
            last.model = open;
        }
    }

    /// Widens the last epoch's model where its first change may have been an alignment
    /// change.
    pub(crate) fn widen_for_alignment(
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
        let moved = self
            .fit_input(&moved, own.clone(), reference)
            .model(readings);
        let open = last
            .model
            .as_ref()
            .zip(moved)
            .and_then(|(now, moved)| mixture(now, &moved, probability));
        last.model = open.or(last.model);
        self.push(last, own);
    }

    /// Widens the last epoch's model where the fault of the only reference may be an
    /// alignment change.
    pub(crate) fn widen_for_alignment_or_reference(
        &mut self,
        possible_alignment: &PossibleAlignment,
    ) {
        let Some(model) = self.epochs.last_mut().and_then(|last| last.model.as_mut()) else {
            return;
        };
        let mut moved = model.clone();
        moved.parameters_over_lambda = moved
            .parameters_over_lambda
            .with_compass_turned(-possible_alignment.moved_deg.to_radians());
        moved.constant_deg += possible_alignment.moved_deg;
        if let Some(covariance) = &mut moved.covariance {
            covariance[PARAMETERS][PARAMETERS] += possible_alignment.variance;
        }
        if let Some(open) = mixture(model, &moved, possible_alignment.probability) {
            *model = open;
        }
    }

    /// Widens the last epoch's model where a large step may have happened just now.
    pub(crate) fn widen_for_large_step(&mut self, variance_nt2: f64) {
        let last = self.epochs.last_mut().and_then(|last| last.model.as_mut());
        if let Some(covariance) = last.and_then(|model| model.covariance.as_mut()) {
            for j in [0, 2] {
                covariance[j][j] += variance_nt2;
            }
        }
    }
}
