//! Posterior probabilities of a change's causes, by Bayes' rule.
//!
//! Every cause has a prior rate, and every circumstance a probability under each cause.
//! They are judgements, kept in one table so that they can be disputed (docs/science.md,
//! §9).

use super::event::EventKind;
use super::likelihood_ratio::LIKELIHOOD_TEMPER;
use binnacle_compass::result::{Cause, CauseProbability};

/// Factor on the weight of a cause that people reported at the time.
const REPORTED_FACTOR: f64 = 100.0;
/// Duration above which a transient is hardly a local anomaly, and below which it is hardly
/// a storm.
const LONG_TRANSIENT_S: f64 = 3.0 * 3600.0;
/// Delay of detection above which a change was gradual.
const SLOW_DETECTION_S: f64 = 20.0 * 86_400.0;

/// Circumstances of a change, beside its size.
#[allow(
    clippy::struct_excessive_bools,
    reason = "each is a circumstance of its own"
)]
#[derive(Clone, Debug, Default)]
pub(crate) struct Circumstances {
    /// Log-likelihood ratios against no change, by kind.
    pub(crate) leads: [f64; 4],
    /// True if it began at a port call, where that is known.
    pub(crate) at_port: Option<bool>,
    /// True if the vessel returned to its earlier state at a port call; none where it has
    /// not returned.
    pub(crate) ended_at_port: Option<bool>,
    /// Log-likelihood ratio against the step for which it was first taken.
    pub(crate) over_step_log_likelihood_ratio: f64,
    /// Log-likelihood ratio of an alignment change against a step, where that is open.
    pub(crate) alignment_over_step_log_likelihood_ratio: Option<f64>,
    /// Duration of a transient, up to now if it goes on.
    pub(crate) transient_s: Option<f64>,
    /// True if a transient or a reference's fault is over.
    pub(crate) is_over: bool,
    /// True if it began with a stay at a berth at which samples were taken, and ended with
    /// the stay if it is over.
    pub(crate) alongside: bool,
    /// Error of the compass during a transient, degrees where H is 24 µT.
    pub(crate) disturbance_deg: Option<f64>,
    /// True if nothing is certain yet.
    pub(crate) is_open: bool,
    /// True if there was no second reference.
    pub(crate) one_reference: bool,
    /// True if another step at sea, weeks before or after, had the same direction.
    pub(crate) is_drifting: bool,
    /// Number of lasting changes within a day of it, itself included.
    pub(crate) changes_within_a_day: usize,
    /// Time from the change to the row that detected it.
    pub(crate) detection_delay_s: f64,
    /// Causes that people reported at the time.
    pub(crate) reported: Vec<Cause>,
}

/// Prior rate of a cause per vessel-year, and the probabilities of: a beginning at a port
/// call, a return at a port call or at sea, a late detection, and another step in the same
/// direction.
struct CausePriors {
    cause: Cause,
    rate_per_year: f64,
    at_port: f64,
    ends_at_port: f64,
    ends_at_sea: f64,
    detected_late: f64,
    is_drifting: f64,
}

const fn cause_priors(cause: Cause, numbers: [f64; 6]) -> CausePriors {
    let [
        rate_per_year,
        at_port,
        ends_at_port,
        ends_at_sea,
        detected_late,
        is_drifting,
    ] = numbers;
    CausePriors {
        cause,
        rate_per_year,
        at_port,
        ends_at_port,
        ends_at_sea,
        detected_late,
        is_drifting,
    }
}

const LASTING_CAUSES: [CausePriors; 5] = [
    cause_priors(Cause::LightningOrShock, [0.2, 0.1, 0.02, 0.05, 0.05, 0.02]),
    cause_priors(Cause::MagneticCargo, [1.0, 0.97, 0.8, 0.03, 0.1, 0.02]),
    cause_priors(
        Cause::AdjustmentOrRepair,
        [0.2, 0.9, 0.02, 0.01, 0.05, 0.02],
    ),
    cause_priors(Cause::Drift, [0.1, 0.1, 0.02, 0.02, 0.8, 0.7]),
    cause_priors(Cause::Unknown, [0.02, 0.3, 0.1, 0.1, 0.2, 0.1]),
];

/// Rates per vessel-year.
const ALIGNMENT_RATE_PER_YEAR: f64 = 0.05;
const COMPASS_FAULT_RATE_PER_YEAR: f64 = 0.5;
/// Rate at which a lone reference has wild readings or oscillates.
const LONE_REFERENCE_FAULT_RATE_PER_YEAR: f64 = 1.0;

/// Errors of the compass in storms, over anomalies and by its own faults, degrees where H
/// is 24 µT. The largest storms on record come to about eight, anomalies seldom to that; a
/// damaged or suspended card moves by any number.
const STORM_DEG: f64 = 5.0;
const ANOMALY_DEG: f64 = 6.0;
const COMPASS_FAULT_DEG: f64 = 10.0;

/// Probability that an alignment change is corrected, relative to a reference's fault.
const ALIGNMENT_REPAIRED: f64 = 0.1;

/// Probability that a storm or an anomaly at sea begins and ends with a stay alongside.
const WITH_BERTH_STAY: f64 = 0.02;

/// Factor on the weight of a cause that contradicts the detector's decision: after the
/// decision, and while it is open.
const CONTRADICTION_FACTOR: f64 = 0.02;
const OPEN_CONTRADICTION_FACTOR: f64 = 0.5;

/// Returns the probable causes of an event, the likeliest first.
pub(crate) fn causes(
    event_kind: EventKind,
    circumstances: &Circumstances,
) -> Vec<CauseProbability> {
    let [step, reference_step, transient, _] =
        circumstances.leads.map(|lead| LIKELIHOOD_TEMPER * lead);
    let instead_of_step = step + LIKELIHOOD_TEMPER * circumstances.over_step_log_likelihood_ratio;
    let most = instead_of_step.max(reference_step).max(transient);
    let mut weights: Vec<(Cause, f64)> = Vec::new();
    for cause_priors in &LASTING_CAUSES {
        let lead = if event_kind == EventKind::Drift && cause_priors.cause == Cause::Drift {
            instead_of_step
        } else {
            step
        };
        weights.push((
            cause_priors.cause,
            cause_priors.weight(circumstances) * (lead - most).exp(),
        ));
    }
    if event_kind == EventKind::Alignment {
        weights.push((
            Cause::Alignment,
            ALIGNMENT_RATE_PER_YEAR * (instead_of_step - most).exp(),
        ));
    }
    if let Some(over) = circumstances
        .alignment_over_step_log_likelihood_ratio
        .filter(|_| event_kind == EventKind::Step)
    {
        // The headings sailed do not tell them apart: the alignment must not be named
        // first.
        let steps = weights.iter().map(|(_, weight)| *weight);
        let likeliest = steps.fold(0.0, f64::max);
        let zero = ALIGNMENT_RATE_PER_YEAR * (step + LIKELIHOOD_TEMPER * over - most).exp();
        weights.push((Cause::Alignment, zero.min(likeliest)));
    }
    let transient_lead = (transient - most).exp();
    let disturbance_deg = circumstances.disturbance_deg.unwrap_or(0.0);
    let by_fault = disturbance_deg.powi(2) / (disturbance_deg.powi(2) + COMPASS_FAULT_DEG.powi(2));
    weights.push((
        Cause::CompassFault,
        COMPASS_FAULT_RATE_PER_YEAR * transient_lead * by_fault,
    ));
    let by_lone_reference = if circumstances.one_reference {
        LONE_REFERENCE_FAULT_RATE_PER_YEAR * transient_lead * by_fault
    } else {
        0.0
    };
    let of_reference = 0.5 * (reference_step - most).exp() + by_lone_reference;
    weights.push((Cause::ReferenceFault, of_reference));
    if event_kind == EventKind::ReferenceFault && circumstances.one_reference {
        // The error is the same on every heading: only its end shows which instrument was
        // moved.
        let share = if circumstances.is_over {
            ALIGNMENT_REPAIRED
        } else {
            1.0
        };
        weights.push((Cause::Alignment, share * of_reference));
    }
    weights.extend(storm_and_place_weights(
        circumstances,
        transient_lead,
        disturbance_deg,
    ));
    for (cause, weight) in &mut weights {
        if circumstances.reported.contains(cause) {
            *weight *= REPORTED_FACTOR;
        }
    }
    let agrees = |cause: Cause| is_consistent(event_kind, cause, circumstances);
    discount_contradictions(event_kind, circumstances, &mut weights);
    let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
    let mut causes: Vec<CauseProbability> = weights
        .into_iter()
        .map(|(cause, weight)| CauseProbability {
            cause,
            probability: weight / sum,
        })
        .filter(|c| c.probability >= 0.005)
        .collect();
    let kept: f64 = causes.iter().map(|c| c.probability).sum();
    for c in &mut causes {
        c.probability /= kept;
    }
    causes.sort_by(|a, b| {
        let by_agreement = || agrees(b.cause).cmp(&agrees(a.cause));
        b.probability
            .total_cmp(&a.probability)
            .then_with(by_agreement)
    });
    causes
}

/// Returns the weights of a storm, a local anomaly and steel at a berth.
fn storm_and_place_weights(
    circumstances: &Circumstances,
    transient_lead: f64,
    disturbance_deg: f64,
) -> [(Cause, f64); 3] {
    let in_storm = (-(disturbance_deg / STORM_DEG).powi(2)).exp();
    let over_anomaly = 1.0 / (1.0 + (disturbance_deg / ANOMALY_DEG).powi(2));
    // A transient that goes on is no shorter than it has been.
    let long = match circumstances.transient_s {
        Some(seconds) if seconds > LONG_TRANSIENT_S => 1.0,
        Some(_) if circumstances.is_over => 0.0,
        _ => 0.5,
    };
    let elsewhere = if circumstances.alongside {
        WITH_BERTH_STAY
    } else {
        1.0
    };
    let at_berth = match circumstances.at_port {
        // It lasts as long as the stay.
        _ if circumstances.alongside => 1.0,
        Some(true) => 0.9 - 0.8 * long,
        _ => 0.01 * (0.9 - 0.8 * long),
    };
    [
        (
            Cause::MagneticStorm,
            6.0 * transient_lead * in_storm * (0.1 + 0.8 * long) * elsewhere,
        ),
        (
            Cause::LocalAnomaly,
            3.0 * transient_lead * over_anomaly * (0.9 - 0.8 * long) * elsewhere,
        ),
        (
            Cause::BerthSteel,
            3.0 * transient_lead * over_anomaly * at_berth,
        ),
    ]
}

/// Reduces the weights of causes that contradict the detector's decision.
fn discount_contradictions(
    event_kind: EventKind,
    circumstances: &Circumstances,
    weights: &mut [(Cause, f64)],
) {
    let agrees = |cause: Cause| is_consistent(event_kind, cause, circumstances);
    let is_of_the_ship = matches!(event_kind, EventKind::Return(_)) || event_kind.is_lasting();
    let agreeing = weights.iter().filter(|(cause, _)| agrees(*cause));
    let most = agreeing
        .map(|(_, weight)| *weight)
        .fold(f64::MIN_POSITIVE, f64::max);
    let share = if circumstances.is_open {
        OPEN_CONTRADICTION_FACTOR
    } else {
        CONTRADICTION_FACTOR
    };
    let against = weights.iter_mut().filter(|(cause, _)| !agrees(*cause));
    for (cause, weight) in against {
        *weight *= share;
        if cause.changes_deviation() != is_of_the_ship {
            // The detector decided whether an epoch begins: no contradicting cause may be
            // named first.
            *weight = weight.min(most);
        }
    }
}

/// Returns true if a cause is consistent with the decision. In port, before sailing again,
/// a change of the vessel itself remains possible.
fn is_consistent(event_kind: EventKind, cause: Cause, circumstances: &Circumstances) -> bool {
    let may_be_hers = circumstances.alongside && !circumstances.is_over;
    let is_hers = matches!(cause, Cause::MagneticCargo | Cause::AdjustmentOrRepair);
    agrees(event_kind, cause, circumstances.one_reference) || (may_be_hers && is_hers)
}

impl CausePriors {
    fn weight(&self, circumstances: &Circumstances) -> f64 {
        let of = |holds: bool, share: f64| if holds { share } else { 1.0 - share };
        let mut weight = self.rate_per_year;
        if let Some(at_port) = circumstances.at_port {
            weight *= of(at_port, self.at_port);
        }
        // A change that has not ended may yet end: its silence says little.
        weight *= match circumstances.ended_at_port {
            Some(true) => self.ends_at_port,
            Some(false) => self.ends_at_sea,
            None => 1.0 - 0.3 * (self.ends_at_port + self.ends_at_sea),
        };
        weight *= of(circumstances.is_drifting, self.is_drifting);
        weight
            * of(
                circumstances.detection_delay_s > SLOW_DETECTION_S,
                self.detected_late,
            )
    }
}

/// Returns true if a cause agrees with the detector's decision.
fn agrees(event_kind: EventKind, cause: Cause, one_reference: bool) -> bool {
    match event_kind {
        EventKind::Step | EventKind::Return(_) => cause.changes_deviation(),
        EventKind::Alignment => cause == Cause::Alignment,
        EventKind::Drift => cause == Cause::Drift,
        EventKind::ReferenceFault => {
            cause == Cause::ReferenceFault || (one_reference && cause == Cause::Alignment)
        }
        EventKind::Transient => {
            !cause.changes_deviation() && (one_reference || cause != Cause::ReferenceFault)
        }
    }
}
