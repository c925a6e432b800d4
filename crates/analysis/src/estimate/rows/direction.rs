//! Directions by sine and cosine, which turn without trigonometry.

/// A direction.
#[derive(Clone, Copy, Debug)]
pub struct Direction {
    /// Its sine: the part towards east.
    pub sin: f64,
    /// Its cosine: the part towards north.
    pub cos: f64,
}

impl Direction {
    /// Makes the direction of an angle.
    pub fn from_radians(radians: f64) -> Direction {
        let (sin, cos) = radians.sin_cos();
        Direction { sin, cos }
    }

    /// Makes the direction of an angle of at most a tenth, by the first terms of the
    /// series.
    pub fn from_small_radians(radians: f64) -> Direction {
        let x = radians * radians;
        let sin = 1.0 - x / 6.0 * (1.0 - x / 20.0 * (1.0 - x / 42.0 * (1.0 - x / 72.0)));
        let cos = 1.0 - x / 2.0 * (1.0 - x / 12.0 * (1.0 - x / 30.0 * (1.0 - x / 56.0)));
        Direction {
            sin: radians * sin,
            cos,
        }
    }

    /// Returns the direction turned clockwise by another.
    pub fn rotated_by(self, by: Direction) -> Direction {
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
                let rotated_by =
                    Direction::from_radians(large).rotated_by(Direction::from_small_radians(small));
                let expected = Direction::from_radians(large + small);
                assert!(
                    (rotated_by.sin - expected.sin).abs() < 1e-15,
                    "{large} {small}"
                );
                assert!(
                    (rotated_by.cos - expected.cos).abs() < 1e-15,
                    "{large} {small}"
                );
            }
        }
    }
}
