//! Timeline of a compass, as the API shows it.
//!
//! Invariants: every index is of an epoch in the same timeline. An epoch has a model, or the
//! reason for which it has none.

use super::store::{Analysed, StoredEpoch, Version};
use crate::analysis::ChangeFinding;
use crate::deviation::{self, DeviationRow};
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::result::{Cause, CauseProbability, FitError, LastPlace, Step};
use binnacle_compass::ship::EarthField;
use binnacle_platform::ids::CompassId;
use binnacle_platform::time::Time;
use serde::Serialize;
use utoipa::ToSchema;

/// Step of compass heading between the rows of a curve, degrees.
const STEP_DEG: f64 = 10.0;

/// Epochs and changes of a compass, by its last analysis.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Timeline)]
pub(super) struct Timeline {
    /// The compass.
    compass_id: CompassId,
    /// Time of the analysis; none before the first.
    #[schema(required)]
    analysed_at: Option<Time>,
    /// Place of the last sample, to which all curves belong; none before the first analysis.
    #[schema(required)]
    place: Option<Place>,
    /// In order of time, without gaps; the last one has no end.
    epochs: Vec<Epoch>,
    /// In order of time.
    changes: Vec<ChangeFound>,
    /// Effects of logbook entries on the samples that people should know, a sentence each.
    #[schema(example = json!([]))]
    notices: Vec<String>,
}

/// Place and time of the last sample, and the earth's field there.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = TimelinePlace)]
pub(super) struct Place {
    /// Time.
    at: Time,
    /// Degrees north.
    #[schema(example = 43.4)]
    lat: f64,
    /// Degrees east.
    #[schema(example = -3.1)]
    lon: f64,
    /// Variation, degrees, east positive.
    #[schema(example = 0.4)]
    variation_deg: f64,
    /// Horizontal field, nT.
    #[schema(example = 24_300.0)]
    h_nt: f64,
    /// Vertical field, nT, down positive.
    #[schema(example = 39_600.0)]
    z_nt: f64,
}

/// Interval of constant ship's magnetism, but for slow drift.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Epoch)]
pub(super) struct Epoch {
    /// Its beginning; none for the first epoch.
    #[schema(required)]
    from: Option<Time>,
    /// Its end; none for the last epoch.
    #[schema(required)]
    to: Option<Time>,
    /// Kind of the logbook entry that began it; none where none did.
    #[schema(required)]
    begun_by: Option<LogbookKind>,
    /// Likeliest cause of the change that began it, or that was over by then; none where the
    /// samples show no change.
    #[schema(required)]
    begun_by_change: Option<Cause>,
    /// Index in this list of the earlier epoch whose magnetism it has again.
    #[schema(required)]
    resumes: Option<usize>,
    /// Time of its first sample.
    #[schema(required)]
    data_from: Option<Time>,
    /// Time of its last sample.
    #[schema(required)]
    data_until: Option<Time>,
    /// Last version of the model that was made from samples up to this epoch's; none where
    /// there was none.
    #[schema(required, example = 4)]
    model_version: Option<i64>,
    /// Root mean square of the residuals, degrees.
    #[schema(required, example = 0.3)]
    rms_deg: Option<f64>,
    /// Number of samples that carry weight in its model.
    #[schema(required, example = 412)]
    samples_used: Option<u64>,
    /// Its deviation at `place`, by compass heading from 0 in steps of 10°; none without a
    /// model, or where headings are ambiguous.
    #[schema(required)]
    curve: Option<Vec<DeviationRow>>,
    /// Reason for which it has no model.
    #[schema(required)]
    refusal: Option<FitError>,
}

/// Change of the deviation, real or apparent.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Change)]
pub(super) struct ChangeFound {
    /// Most likely time.
    from: Time,
    /// Earliest likely time.
    from_earliest: Time,
    /// Latest likely time.
    from_latest: Time,
    /// Time of the sample that showed it.
    detected_at: Time,
    /// True if it is certain enough to act on; otherwise more samples will tell.
    confirmed: bool,
    /// True if it had been certain, and later samples did not confirm it. There was no change,
    /// and `ended` is the time at which that showed.
    withdrawn: bool,
    /// Likeliest cause.
    cause: Cause,
    /// All possible causes, the likeliest first.
    causes: Vec<CauseProbability>,
    /// Evidence, a sentence each.
    #[schema(example = json!(["it began at sea", "the logbook has a report of that time"]))]
    evidence: Vec<String>,
    /// Change of the deviation at the ship's place then, on the heading where it changed most,
    /// degrees; none where the ship's magnetism did not change.
    #[schema(required, example = 6.2)]
    deviation_change_deg: Option<f64>,
    /// Change of the ship's permanent magnetism; none where it did not change.
    #[schema(required)]
    step: Option<Step>,
    /// Its end; none while it lasts.
    #[schema(required)]
    ended: Option<Time>,
    /// Index in `epochs` of the epoch that it ended, whose curve is the one before. None where
    /// it ended none.
    #[schema(required)]
    epoch_before: Option<usize>,
    /// Index of the epoch that it began, whose curve is the one after.
    #[schema(required)]
    epoch_after: Option<usize>,
    /// Index of the epoch that began when it was over.
    #[schema(required)]
    epoch_ended: Option<usize>,
}

/// Makes the timeline from stored records.
pub(super) fn timeline(
    compass_id: CompassId,
    analysed: Option<Analysed>,
    versions: &[Version],
) -> Timeline {
    let Some(Analysed {
        at,
        epochs,
        findings,
    }) = analysed
    else {
        return Timeline {
            compass_id,
            analysed_at: None,
            place: None,
            epochs: Vec::new(),
            changes: Vec::new(),
            notices: Vec::new(),
        };
    };
    let place = findings.last_place;
    Timeline {
        compass_id,
        analysed_at: Some(at),
        place: place.map(Place::from),
        notices: findings.notices,
        changes: findings
            .changes
            .into_iter()
            .filter(is_shown)
            .map(ChangeFound::from)
            .collect(),
        epochs: epochs
            .into_iter()
            .map(|epoch| Epoch::new(epoch, place, versions))
            .collect(),
    }
}

impl From<LastPlace> for Place {
    fn from(place: LastPlace) -> Place {
        Place {
            at: place.time.into(),
            lat: place.position.lat_deg(),
            lon: place.position.lon_deg(),
            variation_deg: place.variation_deg,
            h_nt: place.h_nt,
            z_nt: place.z_nt,
        }
    }
}

impl Epoch {
    fn new(epoch: StoredEpoch, place: Option<LastPlace>, versions: &[Version]) -> Epoch {
        let model = epoch.model.as_ref();
        let curve = model.zip(place).and_then(|(model, place)| {
            let earth = EarthField {
                h_nt: place.h_nt,
                z_nt: place.z_nt,
            };
            deviation::table(model, earth, STEP_DEG).ok()
        });
        Epoch {
            from: epoch.from.map(Time),
            to: epoch.to.map(Time),
            begun_by: epoch.begun_by,
            begun_by_change: epoch.begun_by_change,
            resumes: epoch.resumes,
            data_from: epoch.data_from.map(Time),
            data_until: epoch.data_until.map(Time),
            model_version: model.and_then(|_| version(&epoch, versions)),
            rms_deg: model.and_then(|model| model.rms_deg),
            samples_used: model.map(|model| model.samples_used),
            curve,
            refusal: epoch.refusal,
        }
    }
}

/// Returns the last version made from samples that end in the epoch.
fn version(epoch: &StoredEpoch, versions: &[Version]) -> Option<i64> {
    let (from, until) = (epoch.data_from?, epoch.data_until?);
    let within = |found: &&Version| (from..=until).contains(&found.data_until.0);
    let last = versions.iter().rev().find(within)?;
    Some(last.version)
}

/// Tells whether a change is shown. A disturbance too small to be certain by this ship alone is
/// shown once other ships confirm it.
fn is_shown(found: &ChangeFinding) -> bool {
    !found.change.is_weak_transient()
}

impl From<ChangeFinding> for ChangeFound {
    fn from(found: ChangeFinding) -> ChangeFound {
        let change = found.change;
        ChangeFound {
            from: change.from.into(),
            from_earliest: change.from_earliest.into(),
            from_latest: change.from_latest.into(),
            detected_at: change.detected_at.into(),
            confirmed: change.confirmed,
            withdrawn: change.withdrawn,
            cause: change.cause,
            causes: change.causes,
            evidence: change.evidence,
            deviation_change_deg: change.deviation_change_deg,
            step: change.step,
            ended: change.ended.map(Time),
            epoch_before: found.epoch.and_then(|after| after.checked_sub(1)),
            epoch_after: found.epoch,
            epoch_ended: found.epoch_ended,
        }
    }
}
