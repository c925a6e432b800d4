//! Digits of readings.

/// Digits of instruments and logs, degrees, the coarsest first.
const USUAL_DEG: [f64; 6] = [1.0, 0.5, 0.2, 0.1, 0.05, 0.01];
/// Part of a turn on which a ship is steadied for a swing, degrees: headings that were chosen,
/// not rounded.
const SET_DEG: f64 = 5.0;
/// Share of the readings that lie on the digits: others were averaged, or corrected.
const LEAST_SHARE: f64 = 0.98;
/// Distance from a digit, as a part of it, that arithmetic explains.
const ON_DIGIT: f64 = 1e-3;

/// Returns the coarsest digits to which readings were rounded, degrees; 0 where there are
/// none.
pub(super) fn digits_deg(readings: &[f64]) -> f64 {
    let count = readings.len() as f64;
    let lie_on = |digit: f64| {
        let on = readings.iter().filter(|&reading| {
            let steps = reading / digit;
            (steps - steps.round()).abs() < ON_DIGIT
        });
        on.count() as f64 >= LEAST_SHARE * count
    };
    if lie_on(SET_DEG) {
        return 0.0;
    }
    USUAL_DEG
        .into_iter()
        .find(|&digit| lie_on(digit))
        .unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_the_coarsest_that_the_readings_lie_on() {
        let cases: [(&[f64], f64); 5] = [
            (&[1.0, 271.0, 33.0, 0.0], 1.0),
            (&[1.5, 271.0, 33.0], 0.5),
            (&[1.1, 271.0, 33.3, 359.9], 0.1),
            (&[1.112_345, 271.0, 33.3], 0.0),
            (&[0.0, 10.0, 45.0, 350.0], 0.0),
        ];
        for (readings, expected) in cases {
            assert!(
                (digits_deg(readings) - expected).abs() < 1e-12,
                "{readings:?}"
            );
        }
    }
}
