//! A direction by its sine and cosine, so that turning it needs no trigonometry.

/// A direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Direction {
    pub(crate) sin: f64,
    pub(crate) cos: f64,
}

impl Direction {
    /// Of an angle.
    pub(crate) fn of(radians: f64) -> Direction {
        let (sin, cos) = radians.sin_cos();
        Direction { sin, cos }
    }

    /// Of an angle of no more than a tenth: the series' first terms are as good as all.
    pub(crate) fn of_small(radians: f64) -> Direction {
        let x = radians * radians;
        let sin = 1.0 - x / 6.0 * (1.0 - x / 20.0 * (1.0 - x / 42.0 * (1.0 - x / 72.0)));
        let cos = 1.0 - x / 2.0 * (1.0 - x / 12.0 * (1.0 - x / 30.0 * (1.0 - x / 56.0)));
        Direction {
            sin: radians * sin,
            cos,
        }
    }

    /// Turned clockwise by another.
    pub(crate) fn turned(self, by: Direction) -> Direction {
        Direction {
            sin: self.sin * by.cos + self.cos * by.sin,
            cos: self.cos * by.cos - self.sin * by.sin,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_adds_angles() {
        for small in [-0.1, -0.03, 0.0, 1e-9, 0.0523, 0.1] {
            for large in [-3.0, 0.4, 2.0, 5.9] {
                let turned = Direction::of(large).turned(Direction::of_small(small));
                let expected = Direction::of(large + small);
                assert!((turned.sin - expected.sin).abs() < 1e-15, "{large} {small}");
                assert!((turned.cos - expected.cos).abs() < 1e-15, "{large} {small}");
            }
        }
    }
}
