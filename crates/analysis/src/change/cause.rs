//! Why: Bayes' rule over what is known of a change's circumstances.
//!
//! Every cause has a rate before any evidence, and every circumstance a
//! probability under each cause. They are judgements, kept in one table so that
//! they can be argued with (docs/science.md, §9).

use super::event::EventKind;
use super::likelihood_ratio::LIKELIHOOD_TEMPER;
use binnacle_compass::result::{Cause, CauseProbability};

/// How much likelier a cause is that people reported at the time.
const REPORTED_FACTOR: f64 = 100.0;
/// Bursts longer than this are hardly a place's, shorter hardly a storm's.
const LONG_TRANSIENT_S: f64 = 3.0 * 3600.0;
/// Changes that took longer to be told apart from nothing than this crept in.
const SLOW_DETECTION_S: f64 = 20.0 * 86_400.0;

/// What is known of a change beside its size.
#[allow(
    clippy::struct_excessive_bools,
    reason = "each is a circumstance of its own"
)]
#[derive(Clone, Debug, Default)]
pub(crate) struct Circumstances {
    /// Leads by kind, nats.
    pub(crate) leads: [f64; 4],
    /// Whether it began at a port call; none where that cannot be told.
    pub(crate) at_port: Option<bool>,
    /// Whether the ship became herself again, and whether at a port call.
    pub(crate) ended_at_port: Option<bool>,
    /// By how much what was first taken for a step is likelier than that, nats.
    pub(crate) over_step_log_likelihood_ratio: f64,
    /// By how much a zero that moved is likelier than a step, nats, where that is open.
    pub(crate) alignment_over_step_log_likelihood_ratio: Option<f64>,
    /// How long a burst lasted, or has lasted yet.
    pub(crate) transient_s: Option<f64>,
    /// Whether a burst, or a reference's fault, is over.
    pub(crate) is_over: bool,
    /// Whether it came with a berth at which samples were taken, and went with it if it is over.
    pub(crate) alongside: bool,
    /// How far a burst led the compass astray, degrees where H is 24 µT.
    pub(crate) disturbance_deg: Option<f64>,
    /// Whether nothing is certain yet.
    pub(crate) is_open: bool,
    /// Whether there was no second reference.
    pub(crate) one_reference: bool,
    /// Whether another step at sea, weeks before or after, went the same way.
    pub(crate) is_drifting: bool,
    /// How many lasting changes there were within a day of it, with it.
    pub(crate) changes_within_a_day: usize,
    /// From the change to the row that told.
    pub(crate) detection_delay_s: f64,
    /// What people reported at the time.
    pub(crate) reported: Vec<Cause>,
}

/// Rate a vessel-year, and the probabilities of: beginning at a port call; ending
/// again, at a port call or at sea; being told late; another going the same way.
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

/// A vessel-year.
const ALIGNMENT_RATE_PER_YEAR: f64 = 0.05;
const COMPASS_FAULT_RATE_PER_YEAR: f64 = 0.5;
/// Of a lone reference that is wild now and then, or swings.
const LONE_REFERENCE_FAULT_RATE_PER_YEAR: f64 = 1.0;

/// How far storms, anomalies and a compass that is at fault lead it astray, degrees where H
/// is 24 µT: the largest storms on record come to some eight, anomalies seldom to that, and
/// a card that was hit, lost its light or hangs swings by any number.
const STORM_DEG: f64 = 5.0;
const ANOMALY_DEG: f64 = 6.0;
const COMPASS_FAULT_DEG: f64 = 10.0;

/// How likely a compass's zero that moved is to be put right, beside a reference that is.
const ALIGNMENT_REPAIRED: f64 = 0.1;

/// How likely the sun, or a place at sea, begins and ends with a stay alongside.
const WITH_BERTH_STAY: f64 = 0.02;

/// What contradicts what the search decided weighs so much less; and so much while it has
/// not decided.
const CONTRADICTION_FACTOR: f64 = 0.02;
const OPEN_CONTRADICTION_FACTOR: f64 = 0.5;

/// The causes of an event, the likeliest first.
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
        // The headings sailed do not tell: it is not named for what may be as well.
        let steps = weights.iter().map(|(_, weight)| *weight);
        let likeliest = steps.fold(0.0, f64::max);
        let zero = ALIGNMENT_RATE_PER_YEAR * (step + LIKELIHOOD_TEMPER * over - most).exp();
        weights.push((Cause::Alignment, zero.min(likeliest)));
    }
    let transient_lead = (transient - most).exp();
    let astray_deg = circumstances.disturbance_deg.unwrap_or(0.0);
    let in_storm = (-(astray_deg / STORM_DEG).powi(2)).exp();
    let over_anomaly = 1.0 / (1.0 + (astray_deg / ANOMALY_DEG).powi(2));
    let by_fault = astray_deg.powi(2) / (astray_deg.powi(2) + COMPASS_FAULT_DEG.powi(2));
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
        // The same on every heading: which of the two was moved, nothing tells but its end.
        let share = if circumstances.is_over {
            ALIGNMENT_REPAIRED
        } else {
            1.0
        };
        weights.push((Cause::Alignment, share * of_reference));
    }
    // What is not over is no shorter than it has been.
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
    weights.push((
        Cause::MagneticStorm,
        6.0 * transient_lead * in_storm * (0.1 + 0.8 * long) * elsewhere,
    ));
    weights.push((
        Cause::LocalAnomaly,
        3.0 * transient_lead * over_anomaly * (0.9 - 0.8 * long) * elsewhere,
    ));
    let at_berth = match circumstances.at_port {
        // It lasts as long as she lies there.
        _ if circumstances.alongside => 1.0,
        Some(true) => 0.9 - 0.8 * long,
        _ => 0.01 * (0.9 - 0.8 * long),
    };
    weights.push((
        Cause::BerthSteel,
        3.0 * transient_lead * over_anomaly * at_berth,
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

/// Takes from the weight of what contradicts what the search decided.
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
        if cause.is_the_ships() != is_of_the_ship {
            // Whether an epoch begins has been decided: it is not named for what it is not.
            *weight = weight.min(most);
        }
    }
}

/// Whether a cause is of what the search decided, or in port of what it may yet be: there she
/// may be another since, as long as she has not sailed.
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
        // What has not ended may yet end: silence says little.
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

/// Whether a cause is of what the search decided.
fn agrees(event_kind: EventKind, cause: Cause, one_reference: bool) -> bool {
    match event_kind {
        EventKind::Step | EventKind::Return(_) => cause.is_the_ships(),
        EventKind::Alignment => cause == Cause::Alignment,
        EventKind::Drift => cause == Cause::Drift,
        EventKind::ReferenceFault => {
            cause == Cause::ReferenceFault || (one_reference && cause == Cause::Alignment)
        }
        EventKind::Transient => {
            !cause.is_the_ships() && (one_reference || cause != Cause::ReferenceFault)
        }
    }
}
