//! Robust weights and losses of innovations.

/// Innovation from which its weight falls, standard deviations: Gaussian noise loses next
/// to nothing.
const FULL_WEIGHT_SD: f64 = 2.5;

/// Innovation from which it is no noise that the levels describe, standard deviations.
const GROSS_ERROR_SD: f64 = 6.0;

/// Returns the weight of an innovation by its square in standard deviations: 1 up to
/// `FULL_WEIGHT_SD`, then falling with the square, so that a wilder innovation moves the state
/// less.
pub fn weight(z_squared: f64) -> f64 {
    let bound = FULL_WEIGHT_SD * FULL_WEIGHT_SD;
    if z_squared <= bound {
        1.0
    } else {
        bound / z_squared
    }
}

/// Returns the weight in a fit of many rows, which falls faster beyond `GROSS_ERROR_SD`: wild
/// readings to one side add up. It is never 0, because a fit that began far off would stay
/// there.
pub(crate) fn batch_weight(z_squared: f64) -> f64 {
    weight(z_squared) * (GROSS_ERROR_SD * GROSS_ERROR_SD / z_squared).min(1.0)
}

/// Returns the loss whose slope is twice the weighted innovation, from its square in standard
/// deviations.
pub fn heavy_tailed_loss(z_squared: f64) -> f64 {
    let bound = FULL_WEIGHT_SD * FULL_WEIGHT_SD;
    if z_squared <= bound {
        z_squared
    } else {
        bound * (1.0 + (z_squared / bound).ln())
    }
}

/// Returns the same loss up to its value at `GROSS_ERROR_SD`: the levels describe the other rows,
/// however wild a few are.
pub(crate) fn robust_loss(z_squared: f64) -> f64 {
    heavy_tailed_loss(z_squared.min(GROSS_ERROR_SD * GROSS_ERROR_SD))
}

/// Returns the slope of [`robust_loss`].
pub(crate) fn loss_slope(z_squared: f64) -> f64 {
    if z_squared > GROSS_ERROR_SD * GROSS_ERROR_SD {
        0.0
    } else {
        weight(z_squared)
    }
}
