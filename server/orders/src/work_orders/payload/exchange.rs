//! Exchange between the operator and one firm, confidential from other firms.

use crate::work_orders::payload::hours::Hours;
use binnacle_platform::ids::FirmId;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Firm, with its name at that time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct NamedFirm {
    /// Its id.
    pub firm_id: FirmId,
    /// Its name.
    pub firm_name: String,
}

/// Exchange between the operator and one firm.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Exchange {
    /// The firm, whether sender or addressee.
    #[serde(flatten)]
    pub firm: NamedFirm,
    /// Deadline for an answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub answer_by: Option<Time>,
    /// Fee offered, or accepted as offered, euros.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fee_eur: Option<f64>,
    /// Proposed or agreed terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub terms: Option<Terms>,
    /// Team of the firm that is to come, if its teams have names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub team: Option<String>,
    /// Name of the adjuster.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adjuster_name: Option<String>,
    /// Licence number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adjuster_licence: Option<String>,
    /// Text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// Terms other than offered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = WorkOrderTerms, example = json!({
    "planned_at": "2026-11-22T13:00:00Z", "planned_until": "2026-11-22T16:00:00Z",
    "berth": "A7", "fee_eur": 900.0
}))]
pub(crate) struct Terms {
    /// Time of the job.
    pub planned_at: Time,
    /// End of the job, within 24 hours; without it the job takes as long as before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planned_until: Option<Time>,
    /// Berth, if another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub berth: Option<String>,
    /// Fee, euros.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0, maximum = 1_000_000)]
    pub fee_eur: Option<f64>,
}

impl Terms {
    /// Hours of the job.
    pub(crate) fn hours(&self) -> Hours {
        Hours::new(self.planned_at, self.planned_until)
    }
}

impl Exchange {
    /// Exchange with a firm, without content.
    pub(crate) fn with(firm: NamedFirm) -> Exchange {
        Exchange {
            firm,
            answer_by: None,
            fee_eur: None,
            terms: None,
            team: None,
            adjuster_name: None,
            adjuster_licence: None,
            text: None,
        }
    }

    /// Returns fee, terms and text in one line, with hours in the time of a port; `None` without
    /// any.
    pub(crate) fn quote(&self, port: &str) -> Option<String> {
        let terms = self.terms.as_ref().map(|terms| {
            let berth = terms.berth.as_deref();
            let berth = berth.map_or_else(String::new, |berth| format!(", berth {berth}"));
            let fee = terms.fee_eur;
            let fee = fee.map_or_else(String::new, |eur| format!(", for {eur:.2} euros"));
            format!("{}{berth}{fee}.", terms.hours().describe(port))
        });
        let fee = self.fee_eur.map(|eur| format!("For {eur:.2} euros."));
        let words = fee.into_iter().chain(terms).chain(self.text.clone());
        let words: Vec<String> = words.collect();
        (!words.is_empty()).then(|| words.join(" "))
    }
}
