//! View of an order, with everything that the next action depends on.

use crate::work_orders::offers::Offer;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::as_found::AsFound;
use crate::work_orders::payload::chosen_plan::ChosenPlan;
use crate::work_orders::payload::photograph::Photo;
use crate::work_orders::payload::port_call::CallChange;
use crate::work_orders::payload::recorded_reading::BerthCheck;
use crate::work_orders::payload::recorded_second_reading::SecondReadingResult;
use crate::work_orders::payload::sea_verification::SeaVerification;
use crate::work_orders::payload::signed_record::{Completion, KnownKey, RecordedSignature};
use crate::work_orders::payload::step_result::StepResult;
use crate::work_orders::state::State;
use crate::work_orders::summary::Summary;
use binnacle_adjustment::adjust::{Limits, ReadingForm, Step};
use binnacle_adjustment::binnacle::Setting;
use binnacle_compass::angle::wrap_360;
use binnacle_platform::tenants::Tenant;
use serde::Serialize;
use utoipa::ToSchema;

/// Status of every prediction until headings at sea confirm it.
pub(crate) const NOT_A_CERTIFICATE: &str = "predicted, not a certificate";

/// Order with everything that the next action depends on.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrder)]
pub(crate) struct Order {
    /// Summary.
    #[serde(flatten)]
    pub summary: Summary,
    /// Fee agreed with the firm that has the order, euros, without travel; `null` without a firm,
    /// or without a fee.
    #[schema(required)]
    pub fee_eur: Option<f64>,
    /// Change of the port call since the time was agreed; `null` if it has not moved.
    #[schema(required)]
    pub call_change: Option<CallChange>,
    /// Status of the figures: predictions, until headings at sea agree.
    #[schema(example = "predicted, not a certificate")]
    pub standing: &'static str,
    /// Limits on plans.
    pub limits: Limits,
    /// Correctors and compass as found; `null` before they were reported. Nothing is planned
    /// before.
    #[schema(required)]
    pub as_found: Option<AsFound>,
    /// Defects by the checks alongside, to be repaired before anything is planned.
    pub defects: Vec<String>,
    /// Last accepted reading of the magnetometer.
    #[schema(required)]
    pub reading: Option<ReadingForm>,
    /// Check of that reading.
    #[schema(required)]
    pub berth_check: Option<BerthCheck>,
    /// Plan being followed.
    #[schema(required)]
    pub plan: Option<ChosenPlan>,
    /// Number of its steps done.
    pub steps_done: usize,
    /// Next step; `null` when all are done, or there is no plan.
    #[schema(required)]
    pub next_step: Option<Step>,
    /// Result of the last step.
    #[schema(required)]
    pub last_step: Option<StepResult>,
    /// Second reading of the present settings.
    #[schema(required)]
    pub second_reading: Option<SecondReadingResult>,
    /// True if the settings were reported since that reading.
    pub looked_since: bool,
    /// Present setting of the correctors; `null` before the first reading.
    #[schema(required)]
    pub setting: Option<Setting>,
    /// Last reading of the compass at the berth, degrees.
    #[schema(required)]
    pub compass_deg: Option<f64>,
    /// Completion of the adjustment.
    #[schema(required)]
    pub completion: Option<Completion>,
    /// Verdict of headings at sea.
    #[schema(required)]
    pub verification: Option<SeaVerification>,
    /// Photographs, in order.
    pub photos: Vec<Photo>,
    /// Signatures over the record by firms' keys, with their owners.
    pub signatures: Vec<KeySignature>,
    /// Offers, in the order in which they are sent; a firm sees its own only.
    pub offers: Vec<Offer>,
}

/// Signature over the record.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrderSignature)]
pub(crate) struct KeySignature {
    /// The public key, hexadecimal.
    pub public_key: String,
    /// The signature, hexadecimal.
    pub signature: String,
    /// Owner of the key; `null` for a key that the order's firm has not registered.
    #[schema(required)]
    pub key: Option<KnownKey>,
}

impl From<RecordedSignature> for KeySignature {
    fn from(by: RecordedSignature) -> KeySignature {
        KeySignature {
            public_key: by.signature.public_key,
            signature: by.signature.signature,
            key: by.key,
        }
    }
}

impl Order {
    /// Combines the summary with the state by the log.
    pub(crate) fn new(summary: Summary, state: OrderState, tenant: Tenant) -> Order {
        let setting = state.setting().cloned();
        // Relative to the present reading of the compass, as the next step will be judged.
        let next_step = state.next_step().map(|step| Step {
            expected_compass_deg: state
                .compass_deg
                .map_or(step.expected_compass_deg, |now_deg| {
                    wrap_360(now_deg + step.change_deg)
                }),
            ..step.clone()
        });
        let verified = state.is_verified();
        let of_firm = tenant.firm();
        let closed = of_firm.is_some() && summary.state.is_over();
        let seen = |offer: &Offer| of_firm.is_none_or(|firm| offer.firm_id == firm);
        let signatures = state.signatures.into_iter().map(KeySignature::from);
        Order {
            standing: match summary.state {
                State::Verified => "verified at sea",
                _ if verified => "verified at sea",
                _ => NOT_A_CERTIFICATE,
            },
            fee_eur: state.offers.holder().and_then(Offer::fee),
            call_change: state.call_change,
            limits: state.limits,
            defects: state
                .as_found
                .as_ref()
                .map_or_else(Vec::new, |found| found.dockside.defects()),
            as_found: state.as_found,
            next_step,
            setting,
            steps_done: state.steps_done,
            compass_deg: state.compass_deg,
            last_step: state.last_step,
            looked_since: state.inspected_since_reading && state.second_reading.is_some(),
            second_reading: state.second_reading.map(|second| second.result),
            reading: state.reading.as_ref().map(|read| read.given.clone()),
            berth_check: state.reading.and_then(|read| read.checked),
            // A firm sees the plan only while the order is open.
            plan: state.plan.filter(|_| !closed),
            completion: state.completion,
            verification: state.verification,
            photos: state.photos,
            signatures: signatures.collect(),
            offers: state.offers.all.into_iter().filter(seen).collect(),
            summary,
        }
    }
}
