//! Robust weights and losses of innovations.

/// Innovations beyond so many standard deviations have their variance raised:
/// large enough that Gaussian noise loses nothing worth naming.
const DOUBTED: f64 = 2.5;

/// An innovation beyond this is no noise of the kind that levels describe.
const GROSS: f64 = 6.0;

/// The weight of an innovation by its size in standard deviations, squared: 1 up
/// to [`DOUBTED`], then falling with the square, so that the wilder an innovation,
/// the less it moves what is believed.
pub(crate) fn weight(z_squared: f64) -> f64 {
    let bound = DOUBTED * DOUBTED;
    if z_squared <= bound {
        1.0
    } else {
        bound / z_squared
    }
}

/// The weight in a fit of many rows at once, which falls faster beyond [`GROSS`]:
/// wild readings that are all to one side add up. It is never 0, lest a fit that
/// began far off stayed there.
pub(crate) fn weight_among_many(z_squared: f64) -> f64 {
    weight(z_squared) * (GROSS * GROSS / z_squared).min(1.0)
}

/// The loss whose slope is twice the weighted innovation, but no more than at
/// [`GROSS`]: however wild a few rows are, the levels are for the others.
pub(crate) fn loss_of(z_squared: f64) -> f64 {
    let square = z_squared.min(GROSS * GROSS);
    let bound = DOUBTED * DOUBTED;
    if square <= bound {
        square
    } else {
        bound * (1.0 + (square / bound).ln())
    }
}

/// The slope of [`loss_of`].
pub(crate) fn loss_slope(z_squared: f64) -> f64 {
    if z_squared > GROSS * GROSS {
        0.0
    } else {
        weight(z_squared)
    }
}
