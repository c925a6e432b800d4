//! Refusals of a reading or a plan, with their cures.

pub use binnacle_adjustment::adjust::Cure;

use axum::http::StatusCode;
use binnacle_adjustment::adjust::Refused;
use binnacle_platform::error::{DomainProblem, Error};
use serde::{Deserialize, Serialize};
use serde_json::Map;
use utoipa::ToSchema;

/// Refusal of a reading or a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = AdjustmentRefusal)]
pub struct Refusal {
    /// Kind of the refusal.
    #[schema(example = "inconsistent_berth")]
    pub refusal: String,
    /// Reason in words.
    pub words: String,
    /// Mistakes, each of which alone would explain it.
    pub could_be: Vec<String>,
    /// Cures, the easiest first.
    pub cures: Vec<Cure>,
}

impl Refusal {
    /// Returns the reason and the possible mistakes as one sentence.
    fn with_explanations(&self) -> String {
        match self.could_be.join(", or ").as_str() {
            "" => self.words.clone(),
            explained => format!("{}; it could be that {explained}", self.words),
        }
    }

    /// Puts an implausible position before all other explanations.
    pub(crate) fn with_cause(mut self, implausible_position: Option<Refusal>) -> Refusal {
        if let Some(implausible_position) = implausible_position {
            self.could_be.insert(0, implausible_position.words);
        }
        self
    }
}

impl From<&Refused> for Refusal {
    fn from(refused: &Refused) -> Refusal {
        let word = serde_json::to_value(&refused.refusal).ok();
        let word = word.and_then(|value| Some(value.get("refusal")?.as_str()?.to_owned()));
        Refusal {
            refusal: word.unwrap_or_else(|| "refused".to_owned()),
            // The explanations follow in their own field.
            words: refused.refusal.summary(),
            could_be: refused.refusal.explanations(),
            cures: refused.cures.clone(),
        }
    }
}

/// Fields of the problem `not-adjustable`.
#[derive(Serialize, ToSchema)]
pub struct NotAdjustableFields {
    /// Refusals with their cures; only in `not-adjustable`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(required = false)]
    refusals: Option<Vec<Refusal>>,
}

/// Returns the problem `not-adjustable`: a plan or a reading is refused.
pub(crate) fn not_adjustable(refusals: Vec<Refusal>) -> Error {
    let detail = refusals.iter().map(Refusal::with_explanations);
    let problem = DomainProblem {
        status: StatusCode::UNPROCESSABLE_ENTITY,
        kind: "not-adjustable",
        title: "No plan is possible",
        detail: detail.collect::<Vec<_>>().join("; "),
        extra: Map::new(),
    };
    let fields = NotAdjustableFields {
        refusals: Some(refusals),
    };
    problem.with(&fields).into()
}
