//! A fleet's report, as JSON has it; CSV and paper are made from the same.

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
    /// The first day of the time that jobs are counted in, UTC.
    pub(super) from: NaiveDate,
    /// The last.
    pub(super) to: NaiveDate,
    /// Time of the report; due dates and deviations are as of then.
    pub(super) made_at: Time,
    /// Vessels in the fleet.
    pub(super) vessels: usize,
    /// Their compasses.
    pub(super) compasses: usize,
    /// Every compass that is due some day, the first due first.
    pub(super) due: Vec<DueCompass>,
    /// The greatest deviation of each compass, the greatest first; those of which nothing
    /// is known last.
    pub(super) deviation: Vec<WorstDeviation>,
    /// Adjustments that were completed in the time, in order.
    pub(super) jobs: Vec<Job>,
    /// Savings against swinging.
    pub(super) saved: Saving,
}

/// A compass and when it is due.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = ReportDue)]
pub(super) struct DueCompass {
    /// The vessel.
    pub(super) vessel_id: VesselId,
    /// Her name.
    pub(super) vessel_name: String,
    /// The compass.
    pub(super) compass_id: CompassId,
    /// Its name.
    pub(super) compass_name: String,
    /// The last day on which it may be adjusted.
    pub(super) due_on: NaiveDate,
    /// Urgency of the due date.
    pub(super) urgency: Urgency,
    /// Reason in plain words.
    pub(super) reason: String,
    /// The day of the last adjustment on record.
    #[schema(required)]
    pub(super) adjusted_on: Option<NaiveDate>,
    /// The work order that is under way for it.
    #[schema(required)]
    pub(super) order: Option<UnderWay>,
}

impl DueCompass {
    /// Returns whether the compass is due soon or overdue.
    pub(super) fn presses(&self) -> bool {
        self.urgency > Urgency::Routine
    }
}

/// A work order that is under way, in short.
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

/// A compass and its greatest deviation, where its model was made.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = ReportDeviation)]
pub(super) struct WorstDeviation {
    /// The vessel.
    pub(super) vessel_id: VesselId,
    /// Her name.
    pub(super) vessel_name: String,
    /// The compass.
    pub(super) compass_id: CompassId,
    /// Its name.
    pub(super) compass_name: String,
    /// The compass heading with the greatest deviation; none without a model.
    #[schema(required)]
    pub(super) compass_deg: Option<f64>,
    /// The deviation there, degrees, east positive.
    #[schema(required)]
    pub(super) deviation_deg: Option<f64>,
    /// Half the width of its 95 % band, degrees.
    #[schema(required)]
    pub(super) band95_deg: Option<f64>,
    /// The time of the last sample in the model.
    #[schema(required)]
    pub(super) data_until: Option<Time>,
}

/// An adjustment that was completed.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = ReportJob)]
pub(super) struct Job {
    /// The order.
    pub(super) order_id: OrderId,
    /// The vessel.
    pub(super) vessel_id: VesselId,
    /// Her name.
    pub(super) vessel_name: String,
    /// The compass.
    pub(super) compass_id: CompassId,
    /// Its name.
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
    /// Whether it spared the vessel a swing; not if headings at sea contradict it.
    pub(super) spared_swing: bool,
    /// Fee of the firm, euros; none where it is unknown.
    #[schema(required)]
    pub(super) fee_eur: Option<f64>,
    /// Source of the fee.
    #[schema(required)]
    pub(super) fee_from: Option<FeeFrom>,
    /// Tells one visit from others.
    #[serde(skip)]
    pub(super) visit: usize,
}

/// Source of a fee.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ReportFeeFrom)]
pub(super) enum FeeFrom {
    /// The firm proposed it and the operator agreed.
    Agreed,
    /// It is the firm's usual fee, by its terms of today, without travel; for a compass
    /// after the first of a visit, what each further one costs.
    Terms,
}

/// Savings from adjusting at the berth instead of swinging the vessel.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = ReportSaved)]
pub(super) struct Saving {
    /// Jobs that spared the ship a swing: those completed, but for any that the sea does
    /// not confirm.
    pub(super) jobs: usize,
    /// The swings that they spared: one for all compasses of a ship that were adjusted at
    /// one visit.
    pub(super) swings: usize,
    /// Cost of a swing, euros, from the operator's settings.
    pub(super) swing_eur: f64,
    /// Duration of a swing, hours, from the operator's settings.
    pub(super) swing_h: f64,
    /// Sum of the known fees of all jobs, euros, including those of jobs that failed at sea.
    pub(super) fees_eur: f64,
    /// Number of jobs whose fee is unknown.
    pub(super) without_fee: usize,
    /// The swings' cost less the fees, euros; less than nothing if the fees are more.
    pub(super) saved_eur: f64,
    /// The ship's hours that swings would have taken.
    pub(super) saved_h: f64,
}
