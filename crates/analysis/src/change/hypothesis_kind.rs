//! Kinds of hypotheses.

/// Kind of a hypothesis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HypothesisKind {
    /// A step of the vessel's magnetism.
    Step,
    /// A step of a reference's error: the gyro's, if there are two.
    ReferenceStep,
    /// A disturbance of the earth's field for hours.
    Transient,
    /// A return of the vessel's magnetism to an earlier state.
    Return,
    /// The end of a transient.
    TransientEnd,
    /// A step of the satellite compass's error.
    SatelliteStep,
    /// A disturbance greater than any storm's.
    SevereTransient,
    /// A step of the vessel's magnetism far larger than usual.
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

/// Kinds of lasting changes of the vessel.
pub(crate) const STEPS: [HypothesisKind; 2] = [HypothesisKind::Step, HypothesisKind::LargeStep];
pub(crate) const OTHER_KINDS: [HypothesisKind; 6] = [
    HypothesisKind::ReferenceStep,
    HypothesisKind::Transient,
    HypothesisKind::Return,
    HypothesisKind::TransientEnd,
    HypothesisKind::SatelliteStep,
    HypothesisKind::SevereTransient,
];
/// Kinds of disturbances that last for hours.
pub(crate) const TRANSIENTS: [HypothesisKind; 2] =
    [HypothesisKind::Transient, HypothesisKind::SevereTransient];
/// Kinds whose jump is as large as the innovation of the next reading.
pub(crate) const REFERENCE_STEPS: [HypothesisKind; 2] =
    [HypothesisKind::ReferenceStep, HypothesisKind::SatelliteStep];
