//! Log-likelihood ratios and the odds that they stand for.

/// Leads are of models that are only nearly right: they count for this much.
pub(crate) const LIKELIHOOD_TEMPER: f64 = 0.5;
/// The odds that a lead stands for.
pub(crate) fn tempered_odds(log_likelihood_ratio: f64) -> f64 {
    (LIKELIHOOD_TEMPER * log_likelihood_ratio).exp()
}
