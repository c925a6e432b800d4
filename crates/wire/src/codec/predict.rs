//! Predictors: the expected next integer of a column, from those before it.
//!
//! Integers only, so that every decoder in every language gets the same values.
//! Values stay within ±2⁵³, so nothing here can overflow.

/// The greatest magnitude of a column's value: floats hold it exactly.
pub(super) const VALUE_LIMIT: i64 = 1 << 53;

/// Fractional bits of the running mean.
const MEAN_BITS: u32 = 8;

/// The next value is predicted as …
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Predictor {
    /// the first value of the column;
    First,
    /// the value before;
    Previous,
    /// the line through the two before, evenly spaced;
    Linear,
    /// a running mean that moves by 1/2, 1/4, 1/8 or 1/16 of each value's
    /// innovation;
    Mean(u32),
    /// the line through the two before, by their times;
    LinearInTime,
    /// the time since the value before, less that value, and at most the
    /// greatest so far. This fits back-to-back stretches: the values are
    /// lengths, the times their middles in half units.
    BackToBack,
}

impl Predictor {
    /// All predictors, by their number in the frame. A plain frame has the
    /// first eight.
    pub(super) const ALL: [Predictor; 9] = [
        Predictor::First,
        Predictor::Previous,
        Predictor::Linear,
        Predictor::Mean(1),
        Predictor::Mean(2),
        Predictor::Mean(3),
        Predictor::Mean(4),
        Predictor::LinearInTime,
        Predictor::BackToBack,
    ];

    /// True when it predicts from the samples' times, which must then be known.
    pub(super) fn needs_times(self) -> bool {
        matches!(self, Predictor::LinearInTime | Predictor::BackToBack)
    }
}

/// The state of a predictor in one column.
#[derive(Debug)]
pub(super) struct PredictorState {
    predictor: Predictor,
    first: i64,
    /// The last value and its time.
    last: (i64, i64),
    before: Option<(i64, i64)>,
    greatest: i64,
    /// The running mean, with [`MEAN_BITS`] fractional bits.
    mean: i64,
}

impl PredictorState {
    /// Starts from the column's first value and its time.
    pub(super) fn new(predictor: Predictor, value: i64, time: i64) -> PredictorState {
        PredictorState {
            predictor,
            first: value,
            last: (value, time),
            before: None,
            greatest: value,
            mean: value << MEAN_BITS,
        }
    }

    /// Returns the prediction for `time`.
    pub(super) fn predict(&self, time: i64) -> i64 {
        let (last, last_time) = self.last;
        let predicted = match (self.predictor, self.before) {
            (Predictor::First, _) => self.first,
            (Predictor::Mean(_), _) => (self.mean + (1 << (MEAN_BITS - 1))) >> MEAN_BITS,
            (Predictor::Linear, Some((before, _))) => 2 * last - before,
            (Predictor::LinearInTime, Some((before, before_time))) if last_time > before_time => {
                let rise = i128::from(last - before) * i128::from(time - last_time);
                let line = i128::from(last) + rise.div_euclid(i128::from(last_time - before_time));
                let limit = i128::from(VALUE_LIMIT);
                line.clamp(-limit, limit) as i64
            }
            (Predictor::BackToBack, _) => (time - last_time - last).min(self.greatest),
            _ => last,
        };
        predicted.clamp(-VALUE_LIMIT, VALUE_LIMIT)
    }

    /// Updates the state with the actual value.
    pub(super) fn update(&mut self, value: i64, time: i64) {
        self.before = Some(self.last);
        self.last = (value, time);
        self.greatest = self.greatest.max(value);
        if let Predictor::Mean(shift) = self.predictor {
            self.mean += ((value << MEAN_BITS) - self.mean) >> shift;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn predictions(predictor: Predictor, values: &[(i64, i64)]) -> Vec<i64> {
        let mut state = PredictorState::new(predictor, values[0].0, values[0].1);
        values[1..]
            .iter()
            .map(|(value, time)| {
                let expected = state.predict(*time);
                state.update(*value, *time);
                expected
            })
            .collect()
    }

    #[test]
    fn each_predictor_matches_its_description() {
        let values = [(10, 0), (12, 1), (14, 3), (20, 6)];
        assert_eq!(predictions(Predictor::First, &values), [10, 10, 10]);
        assert_eq!(predictions(Predictor::Previous, &values), [10, 12, 14]);
        assert_eq!(predictions(Predictor::Linear, &values), [10, 14, 16]);
        assert_eq!(predictions(Predictor::Mean(1), &values), [10, 11, 13]);
        assert_eq!(predictions(Predictor::LinearInTime, &values), [10, 16, 17]);
        // The third began where the second ended; between the last two was a
        // gap.
        let lengths = [(60, 300), (60, 420), (20, 500), (60, 600)];
        assert_eq!(predictions(Predictor::BackToBack, &lengths), [60, 20, 60]);
    }

    #[test]
    fn two_values_at_one_time_do_not_divide_by_zero() {
        let values = [(10, 0), (12, 0), (14, 0)];
        assert_eq!(predictions(Predictor::LinearInTime, &values), [10, 12]);
    }

    #[test]
    fn the_widest_values_do_not_overflow() {
        let (low, high) = (-VALUE_LIMIT, VALUE_LIMIT);
        let values = [(low, low), (high, low + 1), (low, high), (high, high)];
        for predictor in Predictor::ALL {
            for expected in predictions(predictor, &values) {
                assert!((low..=high).contains(&expected), "{predictor:?}");
            }
        }
    }
}
