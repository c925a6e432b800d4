//! Models of the epochs, their refusals, and the outcome of each reading.

use super::quality::{Knowledge, quality};
use super::spans::Span;
use crate::report::by_course::CourseUse;
use crate::report::diagnostics::{observation, record_outcome};
use crate::report::faults::Faults;
use crate::report::kept::{TrackedRow, is_offered, keep_some};
use crate::report::past::{Piece, Tally, stronger};
use crate::report::predictions::{WatchPredictions, widened};
use crate::report::references::References;
use crate::state_space::ship_state::ShipState;
use crate::weighing::records::Detected;
use binnacle_analysis::fit::{
    Observation, check_residuals, check_used, mean_h_nt, possible_mistake,
};
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::model::{Caution, Model, ReferenceGrade};
use binnacle_compass::result::{Epoch, FitError, NoiseLevels, ReferenceCheck, SampleReason};
use binnacle_compass::ship::{PARAMETERS, WEAKEST_H_NT};
use std::ops::Range;

/// Least number of samples of an epoch of a ship that is not known.
pub(crate) const NEEDED_SAMPLES: u64 = 12;
/// Least number of samples of an epoch of a known ship after a change.
const NEEDED_SAMPLES_KNOWN_SHIP: u64 = 6;

/// Input of the fits that all epochs share.
pub(crate) struct Fitting<'a> {
    pub(crate) rows: &'a [TrackedRow],
    pub(crate) predictions: &'a WatchPredictions,
    pub(crate) detected: &'a [Detected],
    pub(crate) references: &'a References,
    pub(crate) faults: &'a Faults,
    pub(crate) prior: &'a ShipPrior,
    /// Use of the course over ground; none with a heading reference.
    pub(crate) course: Option<CourseUse>,
    pub(crate) noise: NoiseLevels,
    /// Standard deviation of one reference's constant error, degrees.
    pub(crate) one_reference_sd_deg: f64,
    /// Epochs that are over and settled, the first first.
    pub(crate) settled: &'a [Epoch],
    /// Some of the settled readings.
    pub(crate) sampled: &'a [Reading],
}

/// Fits all epochs in order of time, and records the outcome in each reading.
pub(crate) fn fit_epochs(
    spans: &[Span<'_>],
    readings: &mut [Reading],
    fitting: &Fitting<'_>,
) -> Vec<Epoch> {
    let mut epochs: Vec<Epoch> = Vec::with_capacity(spans.len());
    for (place, span) in spans.iter().enumerate() {
        if let Some(settled) = fitting.settled(place, span) {
            epochs.push(settled.clone());
            continue;
        }
        let is_known = spans[place].begun_by_change.is_some()
            && spans[place].begun_by.is_none()
            && epochs.iter().any(|epoch| epoch.model.is_some());
        let epoch = fitting.fit(spans, place, is_known, readings);
        epochs.push(with_left_out(epoch, span, readings));
    }
    epochs
}

/// Returns an epoch with the numbers of readings that are left out.
fn with_left_out(epoch: Epoch, span: &Span<'_>, readings: &[Reading]) -> Epoch {
    let own = &readings[span.own.clone()];
    let count = |reason: SampleReason, past: fn(&Piece) -> u64| {
        let found = own.iter().filter(|r| r.diagnostic.reason == Some(reason));
        span.past.iter().map(past).sum::<u64>() + found.count() as u64
    };
    Epoch {
        left_out_laden: count(SampleReason::MagneticCargo, |piece| piece.left_out_laden),
        left_out_alongside: count(SampleReason::Berth, |piece| piece.left_out_alongside),
        ..epoch
    }
}

impl Fitting<'_> {
    /// Returns the epoch if it is settled.
    fn settled(&self, place: usize, span: &Span<'_>) -> Option<&Epoch> {
        let known = self.settled.get(place)?;
        let is_same = (known.from, known.to) == (span.from, span.to);
        (is_same && span.own.is_empty()).then_some(known)
    }

    fn fit(
        &self,
        spans: &[Span<'_>],
        place: usize,
        is_known: bool,
        readings: &mut [Reading],
    ) -> Epoch {
        let span = &spans[place];
        let own = &readings[span.own.clone()];
        let mut epoch = Epoch {
            from: span.from,
            to: span.to,
            begun_by: span.begun_by,
            begun_by_change: span.begun_by_change,
            resumes: span.resumes,
            data_from: (span.past.first().map(|piece| piece.from))
                .or(own.first().map(|r| r.sample().time)),
            data_until: (own.last().map(|r| r.sample().time))
                .or(span.past.last().map(|piece| piece.until)),
            left_out_laden: 0,
            left_out_alongside: 0,
            references: None,
            noise: None,
            model: None,
            refusal: None,
        };
        let check = match self.references.at(span.own.start) {
            Ok(check) => check.map(|check| self.count_dropped(check, span.past, own)),
            Err(refusal) => {
                epoch.refusal = Some(refusal);
                return epoch;
            }
        };
        epoch.references = check;
        match self.model(spans, place, is_known, readings) {
            Ok(model) => {
                epoch.noise = Some(self.noise);
                epoch.model = Some(model);
            }
            Err(refusal) => {
                self.refuse(span, readings);
                epoch.refusal = Some(refusal);
            }
        }
        epoch
    }

    /// Counts the readings whose reference was at fault.
    fn count_dropped(
        &self,
        mut check: ReferenceCheck,
        past: &[Piece],
        own: &[Reading],
    ) -> ReferenceCheck {
        for piece in past {
            check.gyro_dropped += piece.gyro_dropped;
            check.satellite_dropped += piece.satellite_dropped;
        }
        for reading in own {
            let (gyro, satellite) = self.faults.dropped(reading);
            check.gyro_dropped += u64::from(gyro);
            check.satellite_dropped += u64::from(satellite);
        }
        check
    }

    /// Returns the rows of an epoch that count for its model.
    fn usable(&self, span: &Span<'_>, readings: &[Reading]) -> Vec<TrackedRow> {
        let begin = self.rows.partition_point(|row| row.place < span.own.start);
        let end = self.rows.partition_point(|row| row.place < span.own.end);
        let rows = self.rows[begin..end].iter().copied();
        rows.filter(|row| readings[row.place].diagnostic.reason.is_none())
            .collect()
    }

    fn model(
        &self,
        spans: &[Span<'_>],
        place: usize,
        is_known: bool,
        readings: &mut [Reading],
    ) -> Result<Model, FitError> {
        let span = &spans[place];
        let usable = self.usable(span, readings);
        let earlier = earlier(spans, place);
        let observations = offered(span, &earlier, &usable, readings);
        check_field(span, readings, observations.count)?;
        let needed = if is_known {
            NEEDED_SAMPLES_KNOWN_SHIP
        } else {
            NEEDED_SAMPLES
        };
        let Some(ship) = span.ship.filter(|_| observations.count >= needed) else {
            return Err(self.too_few(observations.count, needed));
        };
        if !is_known {
            observations.headings.check()?;
        }
        let ship = &self.widened_by_set(ship, &observations);
        let mut model = self.of_ship(ship);
        model.covariance = model.covariance.map(|covariance| {
            let check = self.predictions.coverage(span.to, self.detected);
            let constant_variance = self.one_reference_sd_deg.powi(2);
            widened(&covariance, check.widening, constant_variance)
        });
        check_needle(&model, &observations)?;
        for row in &usable {
            record_outcome(&mut readings[row.place], row, &model, &self.noise);
        }
        // By the ship of each time: the latest would not explain a year of small changes.
        let residuals = usable.iter().map(|row| f64::from(row.innovation_deg));
        let found = span.past.iter().map(|piece| piece.judged).sum::<u64>()
            + judged(self.rows, &span.own, readings);
        // A few rows after a change may all have been read before it was known.
        let caution = if (usable.len() as u64) < NEEDED_SAMPLES {
            None
        } else {
            let caution = check_residuals(residuals, &self.noise)?;
            check_used(used_of(span, readings), found)?;
            caution
        };
        let rows = self.of_all_seas(span, &earlier, &usable, readings);
        model.mean_h_nt = mean_h_nt(&rows);
        self.complete(&mut model, &observations, &rows, ship, caution);
        count(&mut model, span, &earlier, readings);
        Ok(model)
    }

    /// Returns the observations that an epoch's model has, and of the settled ones some.
    fn of_all_seas(
        &self,
        span: &Span<'_>,
        earlier: &[&Span<'_>],
        usable: &[TrackedRow],
        readings: &[Reading],
    ) -> Vec<Observation> {
        let is_within = |reading: &&Reading| {
            let time = reading.sample().time;
            let mut spans = earlier.iter().copied().chain([span]);
            is_offered(reading.diagnostic.reason)
                && spans.any(|span| {
                    span.from.is_none_or(|from| from <= time) && span.to.is_none_or(|to| time < to)
                })
        };
        let mut rows: Vec<&Reading> = self.sampled.iter().filter(is_within).collect();
        let is_whole = rows.is_empty();
        let earlier = earlier.iter().flat_map(|span| &readings[span.own.clone()]);
        rows.extend(earlier.filter(|reading| reading.diagnostic.used));
        rows.extend(usable.iter().map(|row| &readings[row.place]));
        if !is_whole {
            keep_some(&mut rows, |reading| reading.sample().time);
        }
        rows.into_iter().filter_map(observation).collect()
    }

    fn too_few(&self, found: u64, needed: u64) -> FitError {
        match self.course {
            Some(course) => course.refusal(found, needed),
            None => FitError::TooFewSamples { found, needed },
        }
    }

    /// Returns the ship; by course over ground, with the uncertainty of a lasting set.
    fn widened_by_set(&self, ship: &ShipState, observations: &Tally) -> ShipState {
        let h_nt = observations.last.map_or(0.0, |earth| earth.h_nt);
        let widened = self.course.map(|course| course.widen(ship, h_nt));
        widened.unwrap_or_else(|| ship.clone())
    }

    /// Returns the model of a ship's state, without its quality.
    fn of_ship(&self, ship: &ShipState) -> Model {
        let seen = ship.in_compass_axes();
        Model {
            parameters_over_lambda: seen.parameters(),
            constant_deg: wrap_180(seen.mean[PARAMETERS]),
            covariance: Some(seen.covariance),
            identifiable: None,
            rms_deg: None,
            samples_used: 0,
            samples_rejected: 0,
            quality: None,
            reference_grade: match self.course {
                Some(_) => ReferenceGrade::CourseOverGround,
                None => ReferenceGrade::Heading,
            },
            mean_h_nt: None,
            needles: None,
        }
    }

    /// Adds quality and cautions to a model.
    fn complete(
        &self,
        model: &mut Model,
        observations: &Tally,
        rows: &[Observation],
        ship: &ShipState,
        caution: Option<Caution>,
    ) {
        let (Some(earth), Some(weakest_h_nt)) = (observations.last, observations.weakest_h_nt)
        else {
            return;
        };
        let known = Knowledge {
            ship,
            prior: self.prior,
            earth,
            weakest_h_nt,
            samples: observations.count,
            row_variance: self.noise.row_variance(),
            reference_sd_deg: self.reference_sd_deg(observations),
        };
        let (mut quality, identifiable) = quality(model, &known);
        quality.cautions.extend(caution);
        quality.cautions.extend(observations.gaps.caution());
        // An azimuth shows whose error the constant is, and a course over ground drifts.
        let is_open = self.course.is_none() && !identifiable.constant_deg;
        let possible = is_open.then(|| possible_mistake(rows, observations.count));
        if let Some((possible, covariance)) = possible.flatten().zip(model.covariance.as_mut()) {
            covariance[PARAMETERS][PARAMETERS] += possible.variance_deg2;
            quality.cautions.push(possible.caution);
        }
        model.quality = Some(quality);
        model.identifiable = Some(identifiable);
    }

    /// Returns the standard deviation of the constant error of one reference, or of the mean of
    /// two.
    fn reference_sd_deg(&self, observations: &Tally) -> f64 {
        let references: f64 = if observations.has_both { 2.0 } else { 1.0 };
        self.one_reference_sd_deg / references.sqrt()
    }

    /// Marks every row that would have counted as one without a model.
    fn refuse(&self, span: &Span<'_>, readings: &mut [Reading]) {
        for row in self.rows.iter().filter(|row| span.own.contains(&row.place)) {
            let diagnostic = &mut readings[row.place].diagnostic;
            if matches!(diagnostic.reason, None | Some(SampleReason::Outlier)) {
                diagnostic.reason = Some(SampleReason::NoModel);
                diagnostic.predicted_deg = None;
                diagnostic.residual_deg = None;
                diagnostic.weight = 0.0;
                diagnostic.used = false;
            }
        }
    }
}

/// Returns the earlier epochs with the same magnetism.
fn earlier<'a>(spans: &'a [Span<'a>], place: usize) -> Vec<&'a Span<'a>> {
    let mut earlier = Vec::new();
    let mut next = spans[place].resumes;
    while let Some(same) = next {
        earlier.insert(0, &spans[same]);
        next = spans[same].resumes;
    }
    earlier
}

/// Returns what the readings of an epoch say for its model, and those of earlier epochs with the
/// same magnetism.
fn offered(
    span: &Span<'_>,
    earlier: &[&Span<'_>],
    usable: &[TrackedRow],
    readings: &[Reading],
) -> Tally {
    let mut offered = Tally::default();
    let mut add = |past: &[Piece], readings: &mut dyn Iterator<Item = &Reading>| {
        for piece in past {
            offered.append(&piece.offered);
        }
        let mut own = Tally::default();
        for observation in readings.filter_map(observation) {
            own.add(&observation);
        }
        offered.append(&own);
    };
    for span in earlier {
        let own = readings[span.own.clone()].iter();
        add(span.past, &mut own.filter(|r| r.diagnostic.used));
    }
    add(
        span.past,
        &mut usable.iter().map(|row| &readings[row.place]),
    );
    offered
}

/// Returns the number of rows that were read as samples of the vessel, and that a model judges:
/// what the analysis itself declares a fault of the reference is among them.
pub(crate) fn judged(rows: &[TrackedRow], own: &Range<usize>, readings: &[Reading]) -> u64 {
    let rows = rows.iter().filter(|row| own.contains(&row.place));
    let judged = rows.filter(|row| {
        let reason = readings[row.place].diagnostic.reason;
        !matches!(
            reason,
            Some(SampleReason::MagneticCargo | SampleReason::NoModel)
        )
    });
    judged.count() as u64
}

fn used_of(span: &Span<'_>, readings: &[Reading]) -> u64 {
    let past: u64 = span.past.iter().map(|piece| piece.used).sum();
    let own = readings[span.own.clone()].iter();
    past + own.filter(|reading| reading.diagnostic.used).count() as u64
}

/// Counts the readings of the epoch and of the earlier ones, and the residuals of those that were
/// used.
fn count(model: &mut Model, span: &Span<'_>, earlier: &[&Span<'_>], readings: &[Reading]) {
    let offered_of = |span: &Span<'_>| {
        let past: u64 = span.past.iter().map(|piece| piece.readings).sum();
        past + span.own.len() as u64
    };
    let past = span.past.iter().map(|piece| piece.squares);
    let own = readings[span.own.clone()].iter();
    let own = own.filter(|reading| reading.diagnostic.used);
    let own = own.filter_map(|reading| reading.diagnostic.residual_deg);
    let squares: f64 = past.chain(own.map(|residual| residual * residual)).sum();
    let own_used = used_of(span, readings);
    let used = own_used + (earlier.iter().map(|span| used_of(span, readings))).sum::<u64>();
    let offered = offered_of(span) + earlier.iter().map(|span| offered_of(span)).sum::<u64>();
    model.rms_deg = Some((squares / own_used.max(1) as f64).sqrt());
    model.samples_used = used;
    model.samples_rejected = offered - used;
}

/// Fails when there are readings, and the field is too weak for a compass in all of them.
fn check_field(span: &Span<'_>, readings: &[Reading], offered: u64) -> Result<(), FitError> {
    let weak = readings[span.own.clone()]
        .iter()
        .filter(|reading| reading.diagnostic.reason == Some(SampleReason::FieldTooWeak))
        .filter_map(|reading| reading.earth);
    let weak = weak.map(|earth| Some(earth.h_nt));
    let past = span.past.iter().map(|piece| piece.strongest_weak_nt);
    match past.chain(weak).reduce(stronger).flatten() {
        Some(strongest_nt) if offered == 0 => Err(FitError::FieldTooWeak {
            strongest_nt,
            needed_nt: WEAKEST_H_NT,
        }),
        _ => Ok(()),
    }
}

/// Fails when one compass heading stands for several courses in the usual field.
fn check_needle(model: &Model, observations: &Tally) -> Result<(), FitError> {
    let Some(earth) = observations.usual_field() else {
        return Ok(());
    };
    Coefficients::new(&model.parameters_over_lambda, earth)
        .and_then(|coefficients| coefficients.check_unambiguous())
        .map_err(|_| FitError::AmbiguousHeadings { h_nt: earth.h_nt })
}
