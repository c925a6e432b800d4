//! The step of a column: a mantissa of 1 to 15 and a negative power of ten.
//!
//! A value is `integer · mantissa / 10^exponent`. It is computed in integers up
//! to the last division, so that 7 steps of 0.05 are exactly 0.35.

use super::predict::VALUE_LIMIT;

/// `mantissa / 10^exponent`, one byte in the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Step {
    mantissa: u8,
    exponent: u8,
}

impl Step {
    /// A step known at compile time: mantissa 1 to 15, exponent 0 to 15.
    pub(super) const fn new(mantissa: u8, exponent: u8) -> Step {
        assert!(mantissa >= 1 && mantissa <= 15 && exponent <= 15);
        Step { mantissa, exponent }
    }

    /// The step as a byte: mantissa in the high four bits, exponent in the low
    /// four.
    pub(super) fn byte(self) -> u8 {
        self.mantissa << 4 | self.exponent
    }

    /// The step of a byte; `None` for a mantissa of zero.
    pub(super) fn from_byte(byte: u8) -> Option<Step> {
        let (mantissa, exponent) = (byte >> 4, byte & 15);
        (mantissa > 0).then_some(Step { mantissa, exponent })
    }

    /// Steps in a full circle, when they are a whole number.
    pub(super) fn circle(self) -> Option<i64> {
        let fine = 360 * 10_i64.pow(u32::from(self.exponent));
        let mantissa = i64::from(self.mantissa);
        (fine % mantissa == 0).then_some(fine / mantissa)
    }

    /// The nearest number of steps, clamped to the range of a column.
    pub(super) fn count(self, value: f64) -> i64 {
        let scale = 10_f64.powi(i32::from(self.exponent));
        let steps = (value * scale / f64::from(self.mantissa)).round();
        // `as` clamps large values; NaN, which callers have refused, becomes 0.
        (steps as i64).clamp(-VALUE_LIMIT, VALUE_LIMIT)
    }

    /// The value of `steps` as an exact fraction.
    pub(super) fn exact(self, steps: i64) -> Decimal {
        Decimal {
            units: i128::from(steps) * i128::from(self.mantissa),
            exponent: self.exponent,
        }
    }
}

/// `units / 10^exponent`, exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Decimal {
    units: i128,
    exponent: u8,
}

impl Decimal {
    /// Zero.
    pub(super) const ZERO: Decimal = Decimal {
        units: 0,
        exponent: 0,
    };

    /// The exact sum.
    pub(super) fn plus(self, other: Decimal) -> Decimal {
        let exponent = self.exponent.max(other.exponent);
        let units = |d: Decimal| d.units * power(exponent - d.exponent);
        Decimal {
            units: units(self) + units(other),
            exponent,
        }
    }

    /// The direction wrapped into [0, 360).
    pub(super) fn wrapped_360(self) -> Decimal {
        let circle = 360 * power(self.exponent);
        Decimal {
            units: self.units.rem_euclid(circle),
            ..self
        }
    }

    /// The direction wrapped into [−180, 180).
    pub(super) fn wrapped_180(self) -> Decimal {
        let circle = 360 * power(self.exponent);
        Decimal {
            units: (self.units + circle / 2).rem_euclid(circle) - circle / 2,
            ..self
        }
    }

    /// The nearest float.
    pub(super) fn value(self) -> f64 {
        self.units as f64 / 10_f64.powi(i32::from(self.exponent))
    }

    /// The value in millionths, rounded down.
    pub(super) fn micros(self) -> i128 {
        (self.units * 1_000_000).div_euclid(power(self.exponent))
    }
}

fn power(exponent: u8) -> i128 {
    10_i128.pow(u32::from(exponent))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_come_to_decimals_as_they_are_written() {
        let step = Step::new(5, 2);
        assert_eq!(step.exact(7).value().to_string(), "0.35");
        assert_eq!(step.count(0.35), 7);
        assert_eq!(step.circle(), Some(7200));
        assert_eq!(Step::new(7, 2).circle(), None);
    }

    #[test]
    fn a_step_is_one_byte_and_never_zero() {
        assert_eq!(
            Step::from_byte(Step::new(5, 2).byte()),
            Some(Step::new(5, 2))
        );
        assert_eq!(Step::from_byte(0x02), None);
    }

    #[test]
    fn a_sum_across_north_is_exact() {
        let sum = Step::new(5, 2).exact(7199).plus(Step::new(2, 2).exact(5));
        assert_eq!(sum.wrapped_360().value().to_string(), "0.05");
    }
}
