//! Why: Bayes' rule over what is known of a change's circumstances.
//!
//! Every cause has a rate before any evidence, and every circumstance a
//! probability under each cause. They are judgements, kept in one table so that
//! they can be argued with (docs/science.md, §9).

use super::detect::What;
use binnacle_compass::result::{Cause, CauseProbability};

/// Leads are of models that are only nearly right: they count for this much.
const TEMPER: f64 = 0.5;
/// How much likelier a cause is that people reported at the time.
const REPORTED: f64 = 100.0;
/// Bursts longer than this are hardly a place's, shorter hardly a storm's.
const LONG_S: f64 = 3.0 * 3600.0;
/// Changes that took longer to be told apart from nothing than this crept in.
const SLOW_S: f64 = 20.0 * 86_400.0;

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
    pub(crate) over_step: f64,
    /// By how much a zero that moved is likelier than a step, nats, where that is open.
    pub(crate) zero_over_step: Option<f64>,
    /// How long a burst lasted, or has lasted yet.
    pub(crate) burst_s: Option<f64>,
    /// Whether a burst, or a reference's fault, is over.
    pub(crate) is_over: bool,
    /// Whether it came with a berth at which samples were taken, and went with it if it is over.
    pub(crate) alongside: bool,
    /// How far a burst led the compass astray, degrees where H is 24 µT.
    pub(crate) astray_deg: Option<f64>,
    /// Whether nothing is certain yet.
    pub(crate) is_open: bool,
    /// Whether there was no second reference.
    pub(crate) one_reference: bool,
    /// Whether another step at sea, weeks before or after, went the same way.
    pub(crate) creeps: bool,
    /// How many lasting changes there were within a day of it, with it.
    pub(crate) in_a_day: usize,
    /// From the change to the row that told.
    pub(crate) told_after_s: f64,
    /// What people reported at the time.
    pub(crate) reported: Vec<Cause>,
}

/// Rate a vessel-year, and the probabilities of: beginning at a port call; ending
/// again, at a port call or at sea; being told late; another going the same way.
struct Kind {
    cause: Cause,
    rate: f64,
    at_port: f64,
    ends_at_port: f64,
    ends_at_sea: f64,
    told_late: f64,
    creeps: f64,
}

const fn kind(cause: Cause, numbers: [f64; 6]) -> Kind {
    let [rate, at_port, ends_at_port, ends_at_sea, told_late, creeps] = numbers;
    Kind {
        cause,
        rate,
        at_port,
        ends_at_port,
        ends_at_sea,
        told_late,
        creeps,
    }
}

const LASTING: [Kind; 5] = [
    kind(Cause::LightningOrShock, [0.2, 0.1, 0.02, 0.05, 0.05, 0.02]),
    kind(Cause::MagneticCargo, [1.0, 0.97, 0.8, 0.03, 0.1, 0.02]),
    kind(
        Cause::AdjustmentOrRepair,
        [0.2, 0.9, 0.02, 0.01, 0.05, 0.02],
    ),
    kind(Cause::Drift, [0.1, 0.1, 0.02, 0.02, 0.8, 0.7]),
    kind(Cause::Unknown, [0.02, 0.3, 0.1, 0.1, 0.2, 0.1]),
];

/// A vessel-year.
const ALIGNMENT_RATE: f64 = 0.05;
const FAULT_RATE: f64 = 0.5;
/// Of a lone reference that is wild now and then, or swings.
const REFERENCE_RATE: f64 = 1.0;

/// How far storms, anomalies and a compass that is at fault lead it astray, degrees where H
/// is 24 µT: the largest storms on record come to some eight, anomalies seldom to that, and
/// a card that was hit, lost its light or hangs swings by any number.
const STORM_DEG: f64 = 5.0;
const ANOMALY_DEG: f64 = 6.0;
const FAULT_DEG: f64 = 10.0;

/// How likely a compass's zero that moved is to be put right, beside a reference that is.
const ZERO_PUT_RIGHT: f64 = 0.1;

/// How likely the sun, or a place at sea, begins and ends with a stay alongside.
const WITH_A_STAY: f64 = 0.02;

/// What contradicts what the search decided weighs so much less; and so much while it has
/// not decided.
const AGAINST: f64 = 0.02;
const AGAINST_WHILE_OPEN: f64 = 0.5;

/// The odds that a lead stands for.
pub(crate) fn odds(nats: f64) -> f64 {
    (TEMPER * nats).exp()
}

/// The causes of an event, the likeliest first.
pub(crate) fn causes(what: What, known: &Circumstances) -> Vec<CauseProbability> {
    let [step, reference, burst, _] = known.leads.map(|lead| TEMPER * lead);
    let rival = step + TEMPER * known.over_step;
    let most = rival.max(reference).max(burst);
    let mut weights: Vec<(Cause, f64)> = Vec::new();
    for kind in &LASTING {
        let lead = if what == What::Drift && kind.cause == Cause::Drift {
            rival
        } else {
            step
        };
        weights.push((kind.cause, kind.weight(known) * (lead - most).exp()));
    }
    if what == What::Alignment {
        weights.push((Cause::Alignment, ALIGNMENT_RATE * (rival - most).exp()));
    }
    if let Some(over) = known.zero_over_step.filter(|_| what == What::Step) {
        // The headings sailed do not tell: it is not named for what may be as well.
        let steps = weights.iter().map(|(_, weight)| *weight);
        let likeliest = steps.fold(0.0, f64::max);
        let zero = ALIGNMENT_RATE * (step + TEMPER * over - most).exp();
        weights.push((Cause::Alignment, zero.min(likeliest)));
    }
    let passing = (burst - most).exp();
    let astray_deg = known.astray_deg.unwrap_or(0.0);
    let in_storm = (-(astray_deg / STORM_DEG).powi(2)).exp();
    let over_anomaly = 1.0 / (1.0 + (astray_deg / ANOMALY_DEG).powi(2));
    let by_fault = astray_deg.powi(2) / (astray_deg.powi(2) + FAULT_DEG.powi(2));
    weights.push((Cause::CompassFault, FAULT_RATE * passing * by_fault));
    let swings = if known.one_reference {
        REFERENCE_RATE * passing * by_fault
    } else {
        0.0
    };
    let of_reference = 0.5 * (reference - most).exp() + swings;
    weights.push((Cause::ReferenceFault, of_reference));
    if what == What::Reference && known.one_reference {
        // The same on every heading: which of the two was moved, nothing tells but its end.
        let share = if known.is_over { ZERO_PUT_RIGHT } else { 1.0 };
        weights.push((Cause::Alignment, share * of_reference));
    }
    // What is not over is no shorter than it has been.
    let long = match known.burst_s {
        Some(seconds) if seconds > LONG_S => 1.0,
        Some(_) if known.is_over => 0.0,
        _ => 0.5,
    };
    let elsewhere = if known.alongside { WITH_A_STAY } else { 1.0 };
    weights.push((
        Cause::MagneticStorm,
        6.0 * passing * in_storm * (0.1 + 0.8 * long) * elsewhere,
    ));
    weights.push((
        Cause::LocalAnomaly,
        3.0 * passing * over_anomaly * (0.9 - 0.8 * long) * elsewhere,
    ));
    let at_berth = match known.at_port {
        // It lasts as long as she lies there.
        _ if known.alongside => 1.0,
        Some(true) => 0.9 - 0.8 * long,
        _ => 0.01 * (0.9 - 0.8 * long),
    };
    weights.push((Cause::BerthSteel, 3.0 * passing * over_anomaly * at_berth));
    for (cause, weight) in &mut weights {
        if known.reported.contains(cause) {
            *weight *= REPORTED;
        }
    }
    let agrees = |cause: Cause| is_of(what, cause, known);
    hold_to(what, known, &mut weights);
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
fn hold_to(what: What, known: &Circumstances, weights: &mut [(Cause, f64)]) {
    let agrees = |cause: Cause| is_of(what, cause, known);
    let is_of_the_ship = matches!(what, What::Return(_)) || what.is_lasting();
    let agreeing = weights.iter().filter(|(cause, _)| agrees(*cause));
    let most = agreeing
        .map(|(_, weight)| *weight)
        .fold(f64::MIN_POSITIVE, f64::max);
    let share = if known.is_open {
        AGAINST_WHILE_OPEN
    } else {
        AGAINST
    };
    let against = weights.iter_mut().filter(|(cause, _)| !agrees(*cause));
    for (cause, weight) in against {
        *weight *= share;
        if cause.changes_deviation() != is_of_the_ship {
            // Whether an epoch begins has been decided: it is not named for what it is not.
            *weight = weight.min(most);
        }
    }
}

/// Whether a cause is of what the search decided, or in port of what it may yet be: there she
/// may be another since, as long as she has not sailed.
fn is_of(what: What, cause: Cause, known: &Circumstances) -> bool {
    let may_be_hers = known.alongside && !known.is_over;
    let is_hers = matches!(cause, Cause::MagneticCargo | Cause::AdjustmentOrRepair);
    agrees(what, cause, known.one_reference) || (may_be_hers && is_hers)
}

impl Kind {
    fn weight(&self, known: &Circumstances) -> f64 {
        let of = |holds: bool, share: f64| if holds { share } else { 1.0 - share };
        let mut weight = self.rate;
        if let Some(at_port) = known.at_port {
            weight *= of(at_port, self.at_port);
        }
        // What has not ended may yet end: silence says little.
        weight *= match known.ended_at_port {
            Some(true) => self.ends_at_port,
            Some(false) => self.ends_at_sea,
            None => 1.0 - 0.3 * (self.ends_at_port + self.ends_at_sea),
        };
        weight *= of(known.creeps, self.creeps);
        weight * of(known.told_after_s > SLOW_S, self.told_late)
    }
}

/// Whether a cause is of what the search decided.
fn agrees(what: What, cause: Cause, one_reference: bool) -> bool {
    match what {
        What::Step | What::Return(_) => cause.changes_deviation(),
        What::Alignment => cause == Cause::Alignment,
        What::Drift => cause == Cause::Drift,
        What::Reference => {
            cause == Cause::ReferenceFault || (one_reference && cause == Cause::Alignment)
        }
        What::Burst => {
            !cause.changes_deviation() && (one_reference || cause != Cause::ReferenceFault)
        }
    }
}
