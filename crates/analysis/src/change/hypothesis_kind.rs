//! Kinds of hypotheses.

/// What may have happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The ship's magnetism changed.
    Step,
    /// A reference's error changed: the gyro's, if there are two.
    Reference,
    /// The earth's field went astray for hours.
    Burst,
    /// The ship's magnetism is again what it was before.
    Return,
    /// The field that had gone astray is itself again.
    Over,
    /// The satellite compass's error changed.
    Satellite,
    /// The compass swings by more than any storm makes it.
    Wild,
    /// The ship's magnetism changed by far more than it does as a rule.
    Large,
}

pub(crate) const KINDS: [Kind; 8] = [
    Kind::Step,
    Kind::Reference,
    Kind::Burst,
    Kind::Return,
    Kind::Over,
    Kind::Satellite,
    Kind::Wild,
    Kind::Large,
];

/// Those in which the ship changed for good.
pub(crate) const STEPS: [Kind; 2] = [Kind::Step, Kind::Large];
pub(crate) const RIVALS: [Kind; 6] = [
    Kind::Reference,
    Kind::Burst,
    Kind::Return,
    Kind::Over,
    Kind::Satellite,
    Kind::Wild,
];
/// Those in which something is astray for hours.
pub(crate) const PASSING: [Kind; 2] = [Kind::Burst, Kind::Wild];
/// Those that are upset by as much as the next reading is astray.
pub(crate) const REFERENCES: [Kind; 2] = [Kind::Reference, Kind::Satellite];
