//! A filter's covariance: a symmetric matrix, of which the right upper quarter is not
//! worked out.

use super::states::STATES;

/// Columns of a panel.
pub(crate) const PANEL_COLUMNS: usize = STATES / 2;

/// In two panels of columns, one after the other, each from the diagonal down: sixteen
/// rows, and eight. The squares about the diagonal are whole.
///
/// Loops run along rows and leave out those that a zero makes idle: so compilers work on
/// several numbers of a row at a time, and not on several rows.
#[derive(Clone, Debug)]
pub(crate) struct SymmetricMatrix([[f64; PANEL_COLUMNS]; STATES + PANEL_COLUMNS]);

impl SymmetricMatrix {
    pub(crate) fn zeros() -> SymmetricMatrix {
        SymmetricMatrix([[0.0; PANEL_COLUMNS]; STATES + PANEL_COLUMNS])
    }

    /// The rows of either panel; the second's begin with row [`PANEL_COLUMNS`].
    fn panels(&self) -> [&[[f64; PANEL_COLUMNS]]; 2] {
        let (left, right) = self.0.split_at(STATES);
        [left, right]
    }

    /// The same, to be changed.
    pub(crate) fn panels_mut(&mut self) -> [&mut [[f64; PANEL_COLUMNS]]; 2] {
        let (left, right) = self.0.split_at_mut(STATES);
        [left, right]
    }

    pub(crate) fn at(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        let panel = j / PANEL_COLUMNS;
        self.panels()[panel][i - panel * PANEL_COLUMNS][j % PANEL_COLUMNS]
    }

    /// Makes this one's element, and the one mirrored, a value.
    pub(crate) fn set(&mut self, i: usize, j: usize, value: f64) {
        let (i, j) = (i.max(j), i.min(j));
        let panel = j / PANEL_COLUMNS;
        let (row, column) = (i - panel * PANEL_COLUMNS, j % PANEL_COLUMNS);
        let rows = &mut self.panels_mut()[panel];
        rows[row][column] = value;
        if row < PANEL_COLUMNS {
            rows[column][row] = value;
        }
    }

    pub(crate) fn add(&mut self, i: usize, j: usize, value: f64) {
        self.set(i, j, self.at(i, j) + value);
    }

    /// The product with a vector.
    pub(crate) fn times(&self, vector: &[f64; STATES]) -> [f64; STATES] {
        let mut product = [0.0; STATES];
        for (panel, rows) in self.panels().into_iter().enumerate() {
            let vector = &vector[panel * PANEL_COLUMNS..];
            let product = &mut product[panel * PANEL_COLUMNS..];
            let mut sums = [0.0; PANEL_COLUMNS];
            for (row, x) in rows.iter().zip(vector) {
                if *x == 0.0 {
                    continue;
                }
                for (sum, c) in sums.iter_mut().zip(row) {
                    *sum += c * x;
                }
            }
            for (part, sum) in product.iter_mut().zip(sums) {
                *part += sum;
            }
            // What stands below the square stands mirrored beside it.
            for (row, part) in rows.iter().zip(product).skip(PANEL_COLUMNS) {
                *part += dot(row, vector);
            }
        }
        product
    }

    /// Takes off a vector's products with itself, times a factor.
    pub(crate) fn subtract_outer_product(&mut self, vector: &[f64; STATES], factor: f64) {
        for (panel, rows) in self.panels_mut().into_iter().enumerate() {
            let vector = &vector[panel * PANEL_COLUMNS..];
            let own: [f64; PANEL_COLUMNS] = std::array::from_fn(|column| vector[column]);
            for (row, x) in rows.iter_mut().zip(vector) {
                if *x == 0.0 {
                    continue;
                }
                let step = x * factor;
                for (c, own) in row.iter_mut().zip(&own) {
                    *c -= step * own;
                }
            }
        }
    }
}

/// The product of two vectors as long as the shorter: in four sums side by side, which
/// need not wait for one another.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    for (a, b) in a.as_chunks::<4>().0.iter().zip(b.as_chunks::<4>().0) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{SMatrix, SVector};

    /// About one in three is zero.
    fn vector(seed: usize) -> [f64; STATES] {
        std::array::from_fn(|i| ((i * i + seed * (i + 3)) % 7) as f64 - 3.0)
            .map(|x: f64| if x.abs() < 1.5 { 0.0 } else { x })
    }

    #[test]
    fn products_are_those_of_the_whole_matrix() {
        let mut symmetric = SymmetricMatrix::zeros();
        let mut whole = SMatrix::<f64, STATES, STATES>::zeros();
        for i in 0..STATES {
            symmetric.add(i, i, 2.0);
            whole[(i, i)] += 2.0;
        }
        for seed in 0..STATES {
            let v = vector(seed);
            symmetric.subtract_outer_product(&v, 0.25);
            let v = SVector::from(v);
            whole -= v * v.transpose() * 0.25;
        }
        symmetric.set(3, 12, 5.0);
        (whole[(3, 12)], whole[(12, 3)]) = (5.0, 5.0);
        symmetric.add(14, 9, -1.5);
        whole[(14, 9)] -= 1.5;
        whole[(9, 14)] -= 1.5;
        for seed in 0..STATES {
            let product = whole * SVector::from(vector(seed));
            let off = SVector::from(symmetric.times(&vector(seed))) - product;
            assert!(off.amax() < 1e-12, "{seed}: {off}");
        }
        for i in 0..STATES {
            for j in 0..STATES {
                assert!(
                    (symmetric.at(i, j) - whole[(i, j)]).abs() < 1e-12,
                    "{i}, {j}"
                );
            }
        }
    }
}
