//! What the page of a vessel's changes shows, from what is stored.
//!
//! What always holds: every index is of an epoch in the same timeline; an epoch has a
//! model or says why it has none.

use super::schema::{CauseProbabilitySchema, CauseSchema, StepSchema};
use super::store::{Analysed, StoredEpoch, Version};
use crate::alerts::FoundChange;
use crate::analysis::RefusalSchema;
use crate::deviation::{self, Row};
use crate::ids::CompassId;
use crate::logbook::LogbookKindSchema;
use crate::time::Time;
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::result::{Cause, CauseProbability, FitError, LastPlace, Step};
use binnacle_compass::ship::EarthField;
use serde::Serialize;
use utoipa::ToSchema;

/// Degrees of compass heading between a curve's rows.
const STEP_DEG: f64 = 10.0;

/// A compass's epochs and changes, by its last analysis.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Timeline)]
pub(super) struct Timeline {
    /// The compass.
    compass_id: CompassId,
    /// When the analysis was made; none before the first.
    #[schema(required)]
    analysed_at: Option<Time>,
    /// Where the last sample was taken: all curves are of here; none before the first
    /// analysis.
    #[schema(required)]
    place: Option<Place>,
    /// In order of time, without gaps; the last one goes on.
    epochs: Vec<Epoch>,
    /// In order of time.
    changes: Vec<ChangeFound>,
    /// What entries of the logbook do to the samples that people should know, a sentence
    /// each.
    #[schema(example = json!([]))]
    notices: Vec<String>,
}

/// Where and when the last sample was taken, and the earth's field there.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = TimelinePlace)]
pub(super) struct Place {
    /// When.
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

/// An interval in which the ship's magnetism was constant, but for slow drift.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Epoch)]
pub(super) struct Epoch {
    /// Its beginning; none for the first, which reaches back without end.
    #[schema(required)]
    from: Option<Time>,
    /// Its end; none for the last, which goes on.
    #[schema(required)]
    to: Option<Time>,
    /// The kind of logbook entry that began it; none where none did.
    #[schema(required, value_type = Option<LogbookKindSchema>)]
    begun_by: Option<LogbookKind>,
    /// The likeliest cause of the change that began it, or that was over by then; none
    /// where the samples show no change.
    #[schema(required, value_type = Option<CauseSchema>)]
    begun_by_change: Option<Cause>,
    /// Place in this list of the earlier epoch whose magnetism it is again.
    #[schema(required)]
    resumes: Option<usize>,
    /// Time of its first sample.
    #[schema(required)]
    data_from: Option<Time>,
    /// Time of its last sample.
    #[schema(required)]
    data_until: Option<Time>,
    /// The last version of the model that was made from samples up to this epoch's;
    /// none where there was none.
    #[schema(required, example = 4)]
    model_version: Option<i64>,
    /// Root mean square of the residuals, degrees.
    #[schema(required, example = 0.3)]
    rms_deg: Option<f64>,
    /// Samples that carry weight in its model.
    #[schema(required, example = 412)]
    samples_used: Option<u64>,
    /// Its deviation at `place`, by compass heading from 0, each 10°; none without a
    /// model, or where headings are ambiguous.
    #[schema(required)]
    curve: Option<Vec<Row>>,
    /// Why it has no model.
    #[schema(required, value_type = Option<RefusalSchema>)]
    refusal: Option<FitError>,
}

/// Something that changed what the compass shows, or seemed to.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Change)]
pub(super) struct ChangeFound {
    /// When it most likely happened.
    from: Time,
    /// It hardly happened before this.
    from_earliest: Time,
    /// Nor after this.
    from_latest: Time,
    /// Time of the sample that told.
    detected_at: Time,
    /// Whether it is certain enough to act on; if not, more samples will tell.
    confirmed: bool,
    /// Whether it had been certain, until what came after did not bear it out: it was none,
    /// and `ended` is when that told.
    withdrawn: bool,
    /// The likeliest cause.
    #[schema(value_type = CauseSchema)]
    cause: Cause,
    /// All causes that may be, the likeliest first.
    #[schema(value_type = Vec<CauseProbabilitySchema>)]
    causes: Vec<CauseProbability>,
    /// Why, a sentence each.
    #[schema(example = json!(["it began at sea", "the logbook has a report of that time"]))]
    evidence: Vec<String>,
    /// By how much the deviation changed where the ship was then, on the heading where
    /// it changed most, degrees; none where the ship's magnetism did not change.
    #[schema(required, example = 6.2)]
    deviation_change_deg: Option<f64>,
    /// How the ship's permanent magnetism changed; none where it did not.
    #[schema(required, value_type = Option<StepSchema>)]
    step: Option<Step>,
    /// When it was over; none while it lasts.
    #[schema(required)]
    ended: Option<Time>,
    /// Place in `epochs` of the one that it ended: its curve is the one before. None
    /// where it ended none.
    #[schema(required)]
    epoch_before: Option<usize>,
    /// Place of the one that it began: its curve is the one after.
    #[schema(required)]
    epoch_after: Option<usize>,
    /// Place of the one that began when it was over.
    #[schema(required)]
    epoch_ended: Option<usize>,
}

/// Puts together what was found.
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
            .filter(is_told)
            .map(told)
            .collect(),
        epochs: epochs
            .into_iter()
            .map(|epoch| in_line(epoch, place, versions))
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

fn in_line(epoch: StoredEpoch, place: Option<LastPlace>, versions: &[Version]) -> Epoch {
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

/// The last version made from samples that end in the epoch.
fn version(epoch: &StoredEpoch, versions: &[Version]) -> Option<i64> {
    let (from, until) = (epoch.data_from?, epoch.data_until?);
    let within = |found: &&Version| (from..=until).contains(&found.data_until.0);
    let last = versions.iter().rev().find(within)?;
    Some(last.version)
}

/// What is too faint for the ship alone is told when others speak for it.
fn is_told(found: &FoundChange) -> bool {
    !found.change.is_weak_transient()
}

fn told(found: FoundChange) -> ChangeFound {
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
