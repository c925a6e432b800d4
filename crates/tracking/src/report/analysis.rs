//! Whole analysis of a compass by the tracker: samples and logbook to epochs, models and
//! changes.

use super::course_use::CourseUse;
use super::detected_changes::change;
use crate::hypotheses::kinds::Kind;
use crate::state_space::levels::{Level, Levels};
use crate::state_space::row::Placed;
use crate::state_space::ship_state::ShipState;
use crate::weighing::records::{Class, Detected};
use crate::weighing::tracker::{Tracked, Tracker};
use binnacle_analysis::analyse::berth_stays::mark_alongside;
use binnacle_analysis::analyse::reading::{Reading, readings};
use binnacle_analysis::analyse::steady_course::mark_unsteady_courses;
use binnacle_analysis::estimate::{POPULATION_SD, weight};
use binnacle_analysis::fit::Observation;
use binnacle_analysis::fit::check_headings;
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::angle::{CourseOverGround, Deviation, TrueHeading, wrap_180};
use binnacle_compass::azimuth::Azimuth;
use binnacle_compass::coverage::coverage;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::model::{Caution, FromData, Identifiable, Model, Quality, ReferenceGrade};
use binnacle_compass::result::{
    Analysis, Cause, Epoch, FitError, NoiseLevels, ReferenceCheck, SampleReason,
};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;

/// Name of the estimator, kept with its models.
const ESTIMATOR: &str = "hypotheses-1";
/// Robust weight below which a sample counts as an outlier.
const OUTLIER_BELOW: f64 = 0.5;
/// Part of the population's standard deviation that leaves a parameter to the data.
const DATA_DRIVEN: f64 = 0.45;
/// Noise of one independent sample, degrees.
const SAMPLE_DEG: f64 = 0.3;
/// Least number of samples of a model.
const NEEDED_SAMPLES: usize = 12;

/// Input of an analysis of one compass.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Samples in any order, with repetitions or without.
    pub samples: &'a [Sample],
    /// Logbook of the vessel.
    pub logbook: &'a [LogbookEntry],
    /// Azimuths taken with this compass.
    pub azimuths: &'a [Azimuth],
    /// Prior knowledge of the vessel.
    pub prior: &'a ShipPrior,
    /// Settings of the operator.
    pub settings: AnalysisSettings,
}

/// Analyses all samples of one compass.
pub fn analyse(input: &Input<'_>) -> Analysis {
    let Input {
        samples,
        logbook,
        settings,
        ..
    } = *input;
    let settings = &settings;
    let grade = ReferenceGrade::of(samples);
    let mut readings = readings(samples, logbook, settings, grade);
    mark_alongside(&mut readings);
    if grade == ReferenceGrade::CourseOverGround {
        mark_unsteady_courses(&mut readings);
    }
    let mut voyage = Voyage::new(input, CourseUse::count(grade, &readings));
    for reading in &mut readings {
        voyage.read(reading);
    }
    voyage.finish(readings)
}

/// Boundary between two epochs by the logbook.
struct LoggedBoundary {
    at: Timestamp,
    kind: LogbookKind,
    ship_before: ShipState,
}

/// State of an analysis between samples.
struct Voyage {
    tracker: Tracker,
    /// Coming notes of the logbook, the next last.
    notes: Vec<Note>,
    /// Coming azimuths, the next last.
    azimuths: Vec<Azimuth>,
    /// Number of azimuths with no sample near them in time.
    unread_azimuths: usize,
    boundaries: Vec<LoggedBoundary>,
    observations: Vec<Observation>,
    pairs: u64,
    squares: f64,
    settings: AnalysisSettings,
    course: Option<CourseUse>,
}

/// Note of the logbook at its time.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct Note {
    at: Timestamp,
    kind: LogbookKind,
    is_end: bool,
}

impl Voyage {
    fn new(input: &Input<'_>, course: Option<CourseUse>) -> Voyage {
        let logbook = input.logbook;
        let mut azimuths = input.azimuths.to_vec();
        azimuths.sort_by(|a, b| in_order(b, a));
        let begins = logbook.iter().map(|entry| Note {
            at: entry.from,
            kind: entry.kind,
            is_end: false,
        });
        let ends = logbook.iter().filter_map(|entry| {
            Some(Note {
                at: entry.to?,
                kind: entry.kind,
                is_end: true,
            })
        });
        let mut notes: Vec<Note> = begins.chain(ends).collect();
        notes.sort_by(|a, b| b.partial_cmp(a).unwrap_or(std::cmp::Ordering::Equal));
        Voyage {
            tracker: Tracker::new(input.settings.reference_constant_sd_deg, input.prior),
            notes,
            azimuths,
            unread_azimuths: 0,
            boundaries: Vec::new(),
            observations: Vec::new(),
            pairs: 0,
            squares: 0.0,
            settings: input.settings,
            course,
        }
    }

    fn read(&mut self, reading: &mut Reading) {
        let time = reading.sample().time;
        while self.notes.last().is_some_and(|note| note.at <= time) {
            let note = self.notes.pop().expect("there is a last one");
            self.note(note);
        }
        let excluded = reading.diagnostic.reason;
        if excluded.is_some_and(|reason| reason != SampleReason::MagneticCargo) {
            return;
        }
        let (Some(variation), Some(earth)) = (reading.variation, reading.earth) else {
            return;
        };
        let sample = *reading.sample();
        let placed = Placed {
            sample: &sample,
            gyro: reading.gyro,
            variation,
            earth,
        };
        let Some(tracked) = self.tracker.read(&placed) else {
            return;
        };
        self.diagnose(reading, &tracked);
        self.read_azimuths(Some(time));
    }

    /// Reads the azimuths up to a time, or all that are left.
    fn read_azimuths(&mut self, until: Option<Timestamp>) {
        let is_due = |azimuth: &Azimuth| until.is_none_or(|until| azimuth.time() <= until);
        while let Some(azimuth) = self.azimuths.pop_if(|azimuth| is_due(azimuth)) {
            self.unread_azimuths += usize::from(!self.tracker.read_azimuth(&azimuth));
        }
    }

    fn note(&mut self, note: Note) {
        if note.is_end {
            if note.kind == LogbookKind::MagneticCargo {
                self.tracker.note_discharge();
            }
            return;
        }
        if note.kind.ends_an_epoch()
            && let Some(ship_before) = self.tracker.current_ship()
        {
            self.boundaries.push(LoggedBoundary {
                at: note.at,
                kind: note.kind,
                ship_before,
            });
        }
        self.tracker.note(note.kind);
    }

    fn diagnose(&mut self, reading: &mut Reading, tracked: &Tracked) {
        let innovation = tracked.read.deviation;
        let sample = *reading.sample();
        let (Some(variation), Some(earth)) = (reading.variation, reading.earth) else {
            return;
        };
        let heading = sample.satellite.or(reading.gyro).map(TrueHeading::degrees);
        let course = sample.cog.map(CourseOverGround::degrees);
        let Some(heading_deg) = heading.or(course) else {
            return;
        };
        let measured = wrap_180(heading_deg - variation.degrees_east() - sample.compass.degrees());
        let weight = weight(innovation.z_squared());
        let diagnostic = &mut reading.diagnostic;
        diagnostic.deviation_deg = Some(measured);
        diagnostic.residual_deg = Some(innovation.value);
        diagnostic.predicted_deg = Some(wrap_180(measured - innovation.value));
        diagnostic.weight = weight;
        diagnostic.used = true;
        diagnostic.reason = (weight < OUTLIER_BELOW).then_some(SampleReason::Outlier);
        self.pairs += u64::from(reading.gyro.is_some() && sample.satellite.is_some());
        self.squares += weight * innovation.value * innovation.value;
        self.observations.push(Observation {
            time: Some(sample.time),
            position: Some(sample.position),
            compass: sample.compass,
            deviation: Deviation::new(measured).unwrap_or(Deviation::ZERO),
            variation,
            h_nt: earth.h_nt,
            z_nt: earth.z_nt,
            gyro_share: 1.0,
            gyro_less_satellite_deg: None,
            sog_kn: sample.sog_kn,
            windows: sample.windows,
            spread_deg: sample.spread_deg,
            weight: 1.0,
        });
    }

    fn finish(mut self, readings: Vec<Reading>) -> Analysis {
        self.read_azimuths(None);
        let epochs = self.epochs();
        let mut changes: Vec<_> = self.tracker.detected.iter().map(change).collect();
        changes.sort_by_key(|change| (change.from, change.detected_at));
        let with_deviation = readings
            .iter()
            .filter(|r| r.diagnostic.deviation_deg.is_some());
        let coverage = coverage(
            with_deviation.filter_map(|r| r.earth.map(|e| (r.sample().compass, e.h_nt, e.z_nt))),
        );
        Analysis {
            estimator: ESTIMATOR.to_owned(),
            data_from: readings.first().map(|r| r.sample().time),
            data_until: readings.last().map(|r| r.sample().time),
            last_place: readings.iter().rev().find_map(Reading::place),
            coverage,
            epochs,
            changes,
            notices: self.notices(),
            samples: readings.into_iter().map(|r| r.diagnostic).collect(),
        }
    }

    /// Returns the epochs between the detected changes of the ship and the logbook's boundaries.
    fn epochs(&self) -> Vec<Epoch> {
        let mut boundaries: Vec<Boundary<'_>> = Vec::new();
        for logged in &self.boundaries {
            boundaries.push(Boundary {
                at: logged.at,
                ship_before: &logged.ship_before,
                begun_by: Some(logged.kind),
                detected: None,
                is_return: false,
            });
        }
        for detected in self
            .tracker
            .detected
            .iter()
            .filter(|detected| detected.begins_an_epoch())
        {
            boundaries.push(Boundary {
                at: detected.event.from,
                ship_before: &detected.event.ship_before,
                begun_by: None,
                detected: Some(detected),
                is_return: false,
            });
            if let Some((at, ship)) = detected
                .event
                .until
                .zip(detected.event.ship_at_end.as_deref())
            {
                boundaries.push(Boundary {
                    at,
                    ship_before: ship,
                    begun_by: None,
                    detected: Some(detected),
                    is_return: true,
                });
            }
        }
        boundaries.sort_by_key(|boundary| boundary.at);
        let mut epochs: Vec<Epoch> = Vec::new();
        let mut from: Option<&Boundary<'_>> = None;
        let mut begun: Vec<(Timestamp, usize)> = Vec::new();
        for boundary in &boundaries {
            epochs.push(self.epoch(from, Some(boundary.at), Some(boundary.ship_before), &begun));
            if let Some(detected) = boundary.detected.filter(|_| !boundary.is_return) {
                begun.push((detected.event.from, epochs.len() - 1));
            }
            from = Some(boundary);
        }
        let last = self.tracker.current_ship();
        epochs.push(self.epoch(from, None, last.as_ref(), &begun));
        epochs
    }

    fn epoch(
        &self,
        from: Option<&Boundary<'_>>,
        to: Option<Timestamp>,
        ship: Option<&ShipState>,
        begun: &[(Timestamp, usize)],
    ) -> Epoch {
        let begin = from.map(|boundary| boundary.at);
        let within: Vec<&Observation> = self
            .observations
            .iter()
            .filter(|o| {
                let time = o.time.expect("samples have times");
                begin.is_none_or(|begin| time > begin) && to.is_none_or(|to| time <= to)
            })
            .collect();
        let detected = from.and_then(|boundary| boundary.detected);
        let is_return = from.is_some_and(|boundary| boundary.is_return);
        let fitted = self.model(ship, to);
        let resumes = detected.filter(|_| is_return).and_then(|detected| {
            let same = begun.iter().find(|(at, _)| *at == detected.event.from);
            same.map(|(_, index)| *index)
        });
        Epoch {
            from: begin,
            to,
            begun_by: from.and_then(|boundary| boundary.begun_by),
            begun_by_change: detected.map(|detected| change(detected).cause),
            resumes,
            data_from: within.first().and_then(|o| o.time),
            data_until: within.last().and_then(|o| o.time),
            references: self.course.is_none().then(|| self.references()),
            noise: Some(noise(self.tracker.levels(), self.course.is_none())),
            refusal: fitted.as_ref().err().cloned(),
            model: fitted.ok(),
        }
    }

    /// Returns the model of a ship's state, if enough was known by then.
    fn model(&self, ship: Option<&ShipState>, to: Option<Timestamp>) -> Result<Model, FitError> {
        let known = self
            .observations
            .partition_point(|o| to.is_none_or(|to| o.time.is_some_and(|time| time <= to)));
        let known = &self.observations[..known];
        let (found, needed) = (known.len() as u64, NEEDED_SAMPLES as u64);
        let Some(ship) = ship.filter(|_| found >= needed) else {
            let course = self.course.map(|course| course.refusal(found, needed));
            return Err(course.unwrap_or(FitError::TooFewSamples { found, needed }));
        };
        check_headings(known)?;
        let h_nt = known.last().map_or(0.0, |o| o.h_nt);
        let ship = &self
            .course
            .map_or_else(|| ship.clone(), |course| course.widen(ship, h_nt));
        let seen = ship.in_compass_axes();
        let sd = |j: usize| ship.covariance[j][j].max(0.0).sqrt();
        let part = |j: usize| sd(j) / POPULATION_SD[j];
        let shown = |j: usize| part(j) < DATA_DRIVEN;
        let identifiable = Identifiable {
            bx_nt: shown(0) && shown(1),
            chi13: shown(0) && shown(1),
            by_nt: shown(2) && shown(3),
            chi23: shown(2) && shown(3),
            chi11_minus_chi22: shown(4),
            chi12: shown(5),
            chi21: shown(6),
            constant_deg: false,
        };
        let share = |j: usize| (1.0 - part(j) * part(j)).clamp(0.0, 1.0);
        let mut cautions = Vec::new();
        if !(identifiable.bx_nt && identifiable.by_nt) {
            cautions.push(Caution::OneMagneticLatitude);
        }
        let rms = (self.squares / self.observations.len().max(1) as f64).sqrt();
        Ok(Model {
            parameters_over_lambda: seen.parameters(),
            constant_deg: wrap_180(seen.mean[7]),
            covariance: Some(seen.covariance),
            identifiable: Some(identifiable),
            rms_deg: Some(rms),
            samples_used: known.len() as u64,
            samples_rejected: 0,
            quality: Some(Quality {
                effective_samples: (SAMPLE_DEG * SAMPLE_DEG / ship.covariance[4][4].max(1e-12)
                    * POPULATION_SD[4].powi(2))
                .min(known.len() as f64),
                condition: None,
                from_data: FromData {
                    bx_nt: share(0),
                    chi13: share(1),
                    by_nt: share(2),
                    chi23: share(3),
                    chi11_minus_chi22: share(4),
                    chi12: share(5),
                    chi21: share(6),
                    constant_deg: 0.0,
                },
                cautions,
            }),
            reference_grade: match self.course {
                Some(_) => ReferenceGrade::CourseOverGround,
                None => ReferenceGrade::Heading,
            },
        })
    }

    fn notices(&self) -> Vec<String> {
        let unread = (self.unread_azimuths > 0).then(|| {
            format!(
                "{} azimuths are more than six hours from any sample and are not used",
                self.unread_azimuths
            )
        });
        let course = self.course.map(CourseUse::notice);
        unread.into_iter().chain(course).collect()
    }

    fn references(&self) -> ReferenceCheck {
        ReferenceCheck {
            pairs: self.pairs,
            offset_deg: None,
            failed_beyond_deg: 5.0,
            constant_sd_deg: self.settings.reference_constant_sd_deg,
            gyro_dropped: 0,
            satellite_dropped: 0,
        }
    }
}

/// Boundary between two epochs.
struct Boundary<'a> {
    at: Timestamp,
    ship_before: &'a ShipState,
    begun_by: Option<LogbookKind>,
    detected: Option<&'a Detected>,
    is_return: bool,
}

impl Detected {
    fn begins_an_epoch(&self) -> bool {
        self.class == Class::Ship
            && self.withdrawn.is_none()
            && self.event.kind != Kind::ShipDrift
            && change(self).cause != Cause::Drift
    }
}

/// Orders azimuths by time, and those of one time by what they showed.
fn in_order(a: &Azimuth, b: &Azimuth) -> std::cmp::Ordering {
    let shown = |azimuth: &Azimuth| azimuth.result().deviation_deg.degrees_east();
    let heading = |azimuth: &Azimuth| azimuth.compass_heading().degrees();
    a.time()
        .cmp(&b.time())
        .then(heading(a).total_cmp(&heading(b)))
        .then(shown(a).total_cmp(&shown(b)))
}

/// Returns the levels as reported; those of instruments are zero on a ship without them.
fn noise(levels: &Levels, has_instruments: bool) -> NoiseLevels {
    let of_instruments = |level: Level| {
        if has_instruments {
            levels.at(level)
        } else {
            0.0
        }
    };
    NoiseLevels {
        white_deg: levels.at(Level::White),
        schuler_deg: of_instruments(Level::Schuler),
        turn_deg: 2.0 * of_instruments(Level::Schuler),
        slow_gyro_deg: of_instruments(Level::GyroSlow),
        compass_swing_deg: levels.at(Level::Swing),
        variation_deg: levels.at(Level::Variation),
        drift_nt: levels.at(Level::Drift),
        satellite_deg: of_instruments(Level::Reflection),
        difference_deg: of_instruments(Level::DifferenceWhite),
    }
}
