//! Exchange between the operator and one firm: confidential from other firms.

use binnacle_platform::ids::FirmId;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A firm, by its name then.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct NamedFirm {
    /// Its id.
    pub firm_id: FirmId,
    /// Its name.
    pub firm_name: String,
}

/// What is said between the operator and one firm: nobody else's business.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Exchange {
    /// The firm, whoever of the two speaks.
    #[serde(flatten)]
    pub firm: NamedFirm,
    /// Until when an answer is waited for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub answer_by: Option<Time>,
    /// The fee that is offered, or at which it is taken as it was offered, euros.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fee_eur: Option<f64>,
    /// What is proposed, or agreed on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub terms: Option<Terms>,
    /// Who will come.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adjuster_name: Option<String>,
    /// The number of their licence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adjuster_licence: Option<String>,
    /// In words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// Other terms than were offered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = WorkOrderTerms, example = json!({
    "planned_at": "2026-11-22T13:00:00Z", "berth": "A7", "fee_eur": 900.0
}))]
pub(crate) struct Terms {
    /// When it is to be done.
    pub planned_at: Time,
    /// The berth, if another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub berth: Option<String>,
    /// The fee, euros.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0, maximum = 1_000_000)]
    pub fee_eur: Option<f64>,
}

impl Exchange {
    /// Nothing said yet.
    pub(crate) fn with(firm: NamedFirm) -> Exchange {
        Exchange {
            firm,
            answer_by: None,
            fee_eur: None,
            terms: None,
            adjuster_name: None,
            adjuster_licence: None,
            text: None,
        }
    }
    /// Fee, terms and text in one line; `None` where there are none.
    pub(crate) fn quote(&self) -> Option<String> {
        let terms = self.terms.as_ref().map(|terms| {
            let berth = terms.berth.as_deref();
            let berth = berth.map_or_else(String::new, |berth| format!(", berth {berth}"));
            let fee = terms.fee_eur;
            let fee = fee.map_or_else(String::new, |eur| format!(", for {eur:.2} euros"));
            format!("{}{berth}{fee}.", terms.planned_at.to_the_minute())
        });
        let fee = self.fee_eur.map(|eur| format!("For {eur:.2} euros."));
        let words = fee.into_iter().chain(terms).chain(self.text.clone());
        let words: Vec<String> = words.collect();
        (!words.is_empty()).then(|| words.join(" "))
    }
}
