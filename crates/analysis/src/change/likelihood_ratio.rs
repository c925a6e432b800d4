//! Odds by log-likelihood ratios.

/// Factor on log-likelihood ratios: the models are only nearly right.
pub(crate) const LIKELIHOOD_TEMPER: f64 = 0.5;
/// Returns the odds that a log-likelihood ratio stands for.
pub(crate) fn tempered_odds(log_likelihood_ratio: f64) -> f64 {
    (LIKELIHOOD_TEMPER * log_likelihood_ratio).exp()
}
