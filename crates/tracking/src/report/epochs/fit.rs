//! Models of the epochs, their refusals, and the outcome of each reading.

use super::quality::{Knowledge, quality};
use super::spans::Span;
use crate::report::by_course::CourseUse;
use crate::report::diagnostics::{observation, record_outcome};
use crate::report::faults::Faults;
use crate::report::predictions::{WatchPredictions, widened};
use crate::report::references::References;
use crate::report::voyage::{NEEDED_SAMPLES, TrackedRow};
use crate::state_space::ship_state::ShipState;
use crate::weighing::records::Detected;
use binnacle_analysis::fit::{
    Observation, check_headings, check_residuals, check_used, long_gap, possible_mistake,
};
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::model::{Caution, Model, ReferenceGrade};
use binnacle_compass::result::{Epoch, FitError, NoiseLevels, ReferenceCheck, SampleReason};
use binnacle_compass::ship::{EarthField, PARAMETERS, WEAKEST_H_NT};

/// Least number of samples of an epoch of a known ship after a change.
const NEEDED_SAMPLES_KNOWN_SHIP: usize = 6;

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
}

/// Fits all epochs in order of time, and records the outcome in each reading.
pub(crate) fn fit_epochs(
    spans: &[Span<'_>],
    readings: &mut [Reading],
    fitting: &Fitting<'_>,
) -> Vec<Epoch> {
    let mut epochs: Vec<Epoch> = Vec::with_capacity(spans.len());
    for place in 0..spans.len() {
        let is_known = spans[place].begun_by_change.is_some()
            && spans[place].begun_by.is_none()
            && epochs.iter().any(|epoch| epoch.model.is_some());
        let epoch = fitting.fit(spans, place, is_known, readings);
        epochs.push(epoch);
    }
    epochs
}

impl Fitting<'_> {
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
            data_from: own.first().map(|r| r.sample().time),
            data_until: own.last().map(|r| r.sample().time),
            references: None,
            noise: None,
            model: None,
            refusal: None,
        };
        let check = match self.references.at(span.own.start) {
            Ok(check) => check.map(|check| self.count_dropped(check, own)),
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
    fn count_dropped(&self, mut check: ReferenceCheck, own: &[Reading]) -> ReferenceCheck {
        for reading in own {
            let trust = self.faults.trust(reading.sample().time);
            check.gyro_dropped += u64::from(reading.gyro.is_some() && !trust.gyro);
            check.satellite_dropped +=
                u64::from(reading.sample().satellite.is_some() && !trust.satellite);
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

    /// Returns the number of rows of an epoch that were read as samples of the vessel: what the
    /// analysis itself declares a fault of the reference is among them.
    fn found(&self, span: &Span<'_>, readings: &[Reading]) -> u64 {
        let rows = self.rows.iter().filter(|row| span.own.contains(&row.place));
        let laden = Some(SampleReason::MagneticCargo);
        let read = rows.filter(|row| readings[row.place].diagnostic.reason != laden);
        read.count() as u64
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
        let used_before = earlier
            .iter()
            .flat_map(|span| &readings[span.own.clone()])
            .filter(|reading| reading.diagnostic.used);
        let mut observations: Vec<Observation> = used_before.filter_map(observation).collect();
        let before = observations.len();
        let own = usable.iter();
        observations.extend(own.filter_map(|row| observation(&readings[row.place])));
        check_field(&readings[span.own.clone()], &observations)?;
        let needed = if is_known {
            NEEDED_SAMPLES_KNOWN_SHIP
        } else {
            NEEDED_SAMPLES
        };
        let Some(ship) = span.ship.filter(|_| observations.len() >= needed) else {
            return Err(self.too_few(observations.len() as u64, needed as u64));
        };
        if !is_known {
            check_headings(&observations)?;
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
        let residuals = usable.iter().map(|row| row.innovation_deg);
        let used = usable.iter();
        let used = used.filter(|row| readings[row.place].diagnostic.used);
        let found = self.found(span, readings);
        // A few rows after a change may all have been read before it was known.
        let caution = if usable.len() < NEEDED_SAMPLES {
            None
        } else {
            let caution = check_residuals(residuals, &self.noise)?;
            check_used(used.count() as u64, found)?;
            caution
        };
        self.complete(&mut model, &observations, ship, caution);
        count(&mut model, &readings[span.own.clone()], &earlier, before);
        Ok(model)
    }

    fn too_few(&self, found: u64, needed: u64) -> FitError {
        match self.course {
            Some(course) => course.refusal(found, needed),
            None => FitError::TooFewSamples { found, needed },
        }
    }

    /// Returns the ship; by course over ground, with the uncertainty of a lasting set.
    fn widened_by_set(&self, ship: &ShipState, observations: &[Observation]) -> ShipState {
        let h_nt = observations.last().map_or(0.0, |o| o.h_nt);
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
        }
    }

    /// Adds quality and cautions to a model.
    fn complete(
        &self,
        model: &mut Model,
        observations: &[Observation],
        ship: &ShipState,
        caution: Option<Caution>,
    ) {
        let (Some(last), Some(weakest_h_nt)) = (
            observations.last(),
            observations.iter().map(|o| o.h_nt).reduce(f64::min),
        ) else {
            return;
        };
        let known = Knowledge {
            ship,
            prior: self.prior,
            earth: EarthField {
                h_nt: last.h_nt,
                z_nt: last.z_nt,
            },
            weakest_h_nt,
            samples: observations.len(),
            row_variance: self.noise.row_variance(),
            reference_sd_deg: self.reference_sd_deg(observations),
        };
        let (mut quality, identifiable) = quality(model, &known);
        quality.cautions.extend(caution);
        quality.cautions.extend(long_gap(observations));
        // An azimuth shows whose error the constant is, and a course over ground drifts.
        let is_open = self.course.is_none() && !identifiable.constant_deg;
        let possible = is_open.then(|| possible_mistake(observations)).flatten();
        if let Some((possible, covariance)) = possible.zip(model.covariance.as_mut()) {
            covariance[PARAMETERS][PARAMETERS] += possible.variance_deg2;
            quality.cautions.push(possible.caution);
        }
        model.quality = Some(quality);
        model.identifiable = Some(identifiable);
    }

    /// Returns the standard deviation of the constant error of one reference, or of the mean of
    /// two.
    fn reference_sd_deg(&self, observations: &[Observation]) -> f64 {
        let has_both = |o: &Observation| o.gyro_less_satellite_deg.is_some();
        let references: f64 = if observations.iter().any(has_both) {
            2.0
        } else {
            1.0
        };
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

/// Counts the readings of the epoch, and the residuals of those that were used.
fn count(model: &mut Model, own: &[Reading], earlier: &[&Span<'_>], used_before: usize) {
    let used = || own.iter().filter(|reading| reading.diagnostic.used);
    let squares = used().filter_map(|reading| reading.diagnostic.residual_deg);
    let squares: f64 = squares.map(|residual| residual * residual).sum();
    let own_used = used().count();
    let offered = own.len() + earlier.iter().map(|span| span.own.len()).sum::<usize>();
    model.rms_deg = Some((squares / own_used.max(1) as f64).sqrt());
    model.samples_used = (own_used + used_before) as u64;
    model.samples_rejected = (offered - own_used - used_before) as u64;
}

/// Fails when there are readings, and the field is too weak for a compass in all of them.
fn check_field(own: &[Reading], observations: &[Observation]) -> Result<(), FitError> {
    let weak = own
        .iter()
        .filter(|reading| reading.diagnostic.reason == Some(SampleReason::FieldTooWeak))
        .filter_map(|reading| reading.earth);
    match weak.map(|earth| earth.h_nt).reduce(f64::max) {
        Some(strongest_nt) if observations.is_empty() => Err(FitError::FieldTooWeak {
            strongest_nt,
            needed_nt: WEAKEST_H_NT,
        }),
        _ => Ok(()),
    }
}

/// Fails when one compass heading stands for several courses in the usual field.
fn check_needle(model: &Model, observations: &[Observation]) -> Result<(), FitError> {
    let mut fields: Vec<EarthField> = observations
        .iter()
        .map(|o| EarthField {
            h_nt: o.h_nt,
            z_nt: o.z_nt,
        })
        .collect();
    let middle = fields.len() / 2;
    let (_, &mut earth, _) =
        fields.select_nth_unstable_by(middle, |a, b| a.h_nt.total_cmp(&b.h_nt));
    Coefficients::new(&model.parameters_over_lambda, earth)
        .and_then(|coefficients| coefficients.check_unambiguous())
        .map_err(|_| FitError::AmbiguousHeadings { h_nt: earth.h_nt })
}
