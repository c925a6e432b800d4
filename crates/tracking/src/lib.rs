//! Tracking of a ship's magnetism by weighed hypotheses of what happened to her
//! (multiple-hypothesis tracking: Reid 1979; Gaussian sums: Alspach & Sorenson 1972).
//!
//! One state-space model holds the ship, her compass, the field's error and the references
//! (`state_space`). A hypothesis is a Kalman filter over it with a list of supposed events
//! (`hypotheses`): what each kind of event moves, how often it happens and how it ends stands
//! in one table. `weighing` reads rows, supposes events where innovations suggest them,
//! replays the late rows under each, and weighs all by likelihood and prior. Causes, dates and
//! returns are marginals of that one posterior (`report`).
//!
//! **Row.** With ψ the magnetic heading, e the errors of reference r, of variation and of the
//! card, a the alignment and δ the exact deviation (docs/science.md, eq. 5),
//!
//! ```text
//! r − variation − ζ = δ(ψ; p, b′) + a + e_r + e_v + e_c
//! ```
//!
//! where b′ adds to (bx, by) what the hull retains of the induced field and what a list brings:
//! ρ L with L′ = (h − L)/τ for two memories τ, and J × heel. Where gyro and satellite compass
//! are both read, their difference is a row in which the ship has no part. An azimuth is a row
//! without e_r: it alone separates a from the reference's constant.
//!
//! **Weights.** A hypothesis weighs its likelihood times the prior of its events: for each, the
//! rate of its kind times the time in which it may have happened, and for each that lasts the
//! probability that it has lasted as long. An event is reported when the sum of the weights of
//! all hypotheses that have it passes a threshold.
//!
//! **Learning.** Sizes of habits have log-normal priors and follow the slope of the likelihood
//! (recursive maximum likelihood: Ljung & Söderström 1983, chapter 3).
//!
//! **A fold.** [`analyse`] is a fold over segments of 10 days. A [`Voyage`] is the state between
//! two of them: a plain value that, kept and read again, goes on as if it had never been put away.
//! Samples of more than a month ago are settled: no later one changes what is said of them.
//!
//! **Constants.** Those of the detector stand in one list (`constants`), each with unit and
//! source; what is known of ships and events beforehand stands in tables.
//!
//! Invariants: the analysis is a pure function of its input; order and repetition of samples
//! change nothing; every state has a prior, so that no result is ever NaN.

mod constants;
mod hypotheses;
mod report;
mod state_space;
pub mod validation;
mod weighing;

pub use report::{Input, Part, Voyage, analyse};
