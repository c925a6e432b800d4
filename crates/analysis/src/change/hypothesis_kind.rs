//! Kinds of hypotheses.

/// What may have happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HypothesisKind {
    /// The ship's magnetism changed.
    Step,
    /// A reference's error changed: the gyro's, if there are two.
    ReferenceStep,
    /// The earth's field went astray for hours.
    Transient,
    /// The ship's magnetism is again what it was before.
    Return,
    /// The field that had gone astray is itself again.
    TransientEnd,
    /// The satellite compass's error changed.
    SatelliteStep,
    /// The compass swings by more than any storm makes it.
    SevereTransient,
    /// The ship's magnetism changed by far more than it does as a rule.
    LargeStep,
}

pub(crate) const ALL_KINDS: [HypothesisKind; 8] = [
    HypothesisKind::Step,
    HypothesisKind::ReferenceStep,
    HypothesisKind::Transient,
    HypothesisKind::Return,
    HypothesisKind::TransientEnd,
    HypothesisKind::SatelliteStep,
    HypothesisKind::SevereTransient,
    HypothesisKind::LargeStep,
];

/// Those in which the ship changed for good.
pub(crate) const STEPS: [HypothesisKind; 2] = [HypothesisKind::Step, HypothesisKind::LargeStep];
pub(crate) const OTHER_KINDS: [HypothesisKind; 6] = [
    HypothesisKind::ReferenceStep,
    HypothesisKind::Transient,
    HypothesisKind::Return,
    HypothesisKind::TransientEnd,
    HypothesisKind::SatelliteStep,
    HypothesisKind::SevereTransient,
];
/// Those in which something is astray for hours.
pub(crate) const TRANSIENTS: [HypothesisKind; 2] =
    [HypothesisKind::Transient, HypothesisKind::SevereTransient];
/// Those that are upset by as much as the next reading is astray.
pub(crate) const REFERENCE_STEPS: [HypothesisKind; 2] =
    [HypothesisKind::ReferenceStep, HypothesisKind::SatelliteStep];
