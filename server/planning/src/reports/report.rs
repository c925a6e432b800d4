//! A fleet's report, the source of JSON, CSV and PDF.

use binnacle_orders::work_orders::State;
use binnacle_platform::ids::{CompassId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::needs::Urgency;
use chrono::NaiveDate;
use serde::Serialize;
use utoipa::ToSchema;

/// Report on a fleet: due dates, deviations and completed work.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = FleetReport)]
pub(super) struct Report {
    /// Name of the operator.
    #[schema(example = "Naviera Vizcaína")]
    pub(super) operator_name: String,
    /// First day of the period in which jobs are counted, UTC.
    pub(super) from: NaiveDate,
    /// Last day of the period, UTC.
    pub(super) to: NaiveDate,
    /// Time of the report; due dates and deviations are as of then.
    pub(super) made_at: Time,
    /// Number of vessels in the fleet.
    pub(super) vessels: usize,
    /// Number of their compasses.
    pub(super) compasses: usize,
    /// Every compass with a due date, the earliest first.
    pub(super) due: Vec<DueCompass>,
    /// Greatest deviation of each compass, the largest first and unknown ones last.
    pub(super) deviation: Vec<WorstDeviation>,
    /// Adjustments completed in the period, in order.
    pub(super) jobs: Vec<Job>,
    /// Savings against swinging.
    pub(super) saved: Saving,
}

/// Due date of a compass.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = ReportDue)]
pub(super) struct DueCompass {
    /// The vessel.
    pub(super) vessel_id: VesselId,
    /// Name of the vessel.
    pub(super) vessel_name: String,
    /// The compass.
    pub(super) compass_id: CompassId,
    /// Name of the compass.
    pub(super) compass_name: String,
    /// Last day for the adjustment.
    pub(super) due_on: NaiveDate,
    /// Urgency of the due date.
    pub(super) urgency: Urgency,
    /// Reason of the due date, as a sentence.
    pub(super) reason: String,
    /// Day of the last adjustment on record.
    #[schema(required)]
    pub(super) adjusted_on: Option<NaiveDate>,
    /// Its work order under way.
    #[schema(required)]
    pub(super) order: Option<UnderWay>,
}

impl DueCompass {
    /// Returns whether the compass is due soon or overdue.
    pub(super) fn is_pressing(&self) -> bool {
        self.urgency >= Urgency::Soon
    }
}

/// Summary of a work order under way.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = ReportOrder)]
pub(super) struct UnderWay {
    /// The order.
    pub(super) id: OrderId,
    /// State of the order.
    pub(super) state: State,
    /// The port.
    pub(super) port: String,
    /// Planned time of the work.
    pub(super) planned_at: Time,
    /// The firm that has it.
    #[schema(required)]
    pub(super) firm: Option<String>,
}

/// Greatest deviation of a compass, at the place of its model.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = ReportDeviation)]
pub(super) struct WorstDeviation {
    /// The vessel.
    pub(super) vessel_id: VesselId,
    /// Name of the vessel.
    pub(super) vessel_name: String,
    /// The compass.
    pub(super) compass_id: CompassId,
    /// Name of the compass.
    pub(super) compass_name: String,
    /// Compass heading of the greatest deviation; `null` without a model.
    #[schema(required)]
    pub(super) compass_deg: Option<f64>,
    /// Deviation there, degrees, east positive.
    #[schema(required)]
    pub(super) deviation_deg: Option<f64>,
    /// Half the width of its 95 % band, degrees.
    #[schema(required)]
    pub(super) band95_deg: Option<f64>,
    /// Time of the last sample in the model.
    #[schema(required)]
    pub(super) data_until: Option<Time>,
}

/// Completed adjustment.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = ReportJob)]
pub(super) struct Job {
    /// The order.
    pub(super) order_id: OrderId,
    /// The vessel.
    pub(super) vessel_id: VesselId,
    /// Name of the vessel.
    pub(super) vessel_name: String,
    /// The compass.
    pub(super) compass_id: CompassId,
    /// Name of the compass.
    pub(super) compass_name: String,
    /// The port.
    pub(super) port: String,
    /// Time of completion.
    pub(super) completed_at: Time,
    /// The firm.
    #[schema(required)]
    pub(super) firm: Option<String>,
    /// State of the order.
    pub(super) state: State,
    /// `true` when it spared the vessel a swing: headings at sea do not contradict it.
    pub(super) spared_swing: bool,
    /// Fee of the firm, euros; `null` when unknown.
    #[schema(required)]
    pub(super) fee_eur: Option<f64>,
    /// Source of the fee.
    #[schema(required)]
    pub(super) fee_from: Option<FeeFrom>,
    /// Number of the visit.
    #[serde(skip)]
    pub(super) visit: usize,
}

/// Source of a fee.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ReportFeeFrom)]
pub(super) enum FeeFrom {
    /// Proposed by the firm and agreed by the operator.
    Agreed,
    /// Usual fee by the firm's current terms, without travel. A further compass of a visit has the
    /// fee for further ones.
    Terms,
}

/// Savings from adjusting at the berth instead of swinging the vessel.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = ReportSaved)]
pub(super) struct Saving {
    /// Number of jobs that spared the vessel a swing: completed and not contradicted at sea.
    pub(super) jobs: usize,
    /// Number of swings that they spared, one for all compasses adjusted at one visit.
    pub(super) swings: usize,
    /// Cost of a swing, euros, from the operator's settings.
    pub(super) swing_eur: f64,
    /// Duration of a swing, hours, from the operator's settings.
    pub(super) swing_h: f64,
    /// Sum of the known fees of all jobs, euros, including those of jobs that failed at sea.
    pub(super) fees_eur: f64,
    /// Number of jobs whose fee is unknown.
    pub(super) without_fee: usize,
    /// Cost of the swings less the fees, euros; negative when the fees are higher.
    pub(super) saved_eur: f64,
    /// Duration of the spared swings, hours.
    pub(super) saved_h: f64,
}
