//! Reasons for which there is no card although there is a model.

use axum::http::StatusCode;
use binnacle_compass::deviation::DeviationError;
use binnacle_drawing::angles::heading;
use binnacle_platform::error::{DomainProblem, Error};
use binnacle_platform::time::Time;
use serde_json::Map;

/// Samples older than this make no card, days: by the drift that is usual
/// (docs/science.md, table of (9)) a ship's permanent field has then wandered by so
/// much that the half degree to which a card is read is no longer sure.
pub(super) const OLDEST_DAYS: f64 = 90.0;

/// Reason for which a card is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// Too long since the last sample.
    #[error(
        "the model's last sample dates from {}, {days:.0} days before the card; the limit is \
         {OLDEST_DAYS} days: steer steady courses on several headings to renew the model",
        data_until.to_the_minute()
    )]
    TooOld {
        /// Time of the last sample.
        data_until: Time,
        /// Age of the last sample at the card's time, days.
        days: f64,
    },
    /// Deviation is not known well enough on some heading.
    #[error(
        "on compass heading {} the deviation is known only to ±{band95_deg:.1}°, and this \
         vessel's limit is ±{limit_deg}°: steer steady courses near that heading to narrow it",
        heading(*compass_deg)
    )]
    BandTooWide {
        /// Half the 95 % band where it is widest, degrees.
        band95_deg: f64,
        /// Compass heading of the widest band.
        compass_deg: f64,
        /// The vessel's limit.
        limit_deg: f64,
    },
    /// The compass gives no unique heading there, or none at all.
    #[error("{0}")]
    NoHeadings(#[from] DeviationError),
    /// Something is wrong with the compass now.
    #[error("an alert on this compass is open: {summary}")]
    CompassSuspected {
        /// The alert's own words.
        summary: String,
    },
}

impl Refusal {
    /// Returns the last word of the problem's type, and its title.
    fn kind(&self) -> (&'static str, &'static str) {
        match self {
            Refusal::TooOld { .. } => ("model-too-old", "The model is too old for a card"),
            Refusal::BandTooWide { .. } => {
                ("band-too-wide", "The model is too uncertain for a card")
            }
            Refusal::NoHeadings(
                DeviationError::FieldTooWeak { .. } | DeviationError::InvalidField { .. },
            ) => ("field-too-weak", "The earth's field there is too weak"),
            Refusal::NoHeadings(_) => ("headings-ambiguous", "Headings are ambiguous"),
            Refusal::CompassSuspected { .. } => ("compass-suspected", "The compass is suspected"),
        }
    }
}

impl From<Refusal> for Error {
    fn from(refusal: Refusal) -> Error {
        let (kind, title) = refusal.kind();
        let problem = DomainProblem {
            status: StatusCode::CONFLICT,
            kind,
            title,
            detail: refusal.to_string(),
            extra: Map::new(),
        };
        problem.into()
    }
}
