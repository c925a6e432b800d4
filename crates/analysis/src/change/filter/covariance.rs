//! The filter's covariance: a symmetric matrix without its upper right quarter.

use super::states::STATES;

/// Columns of a panel.
pub(crate) const PANEL_COLUMNS: usize = STATES / 2;

/// Two panels of columns, each from the diagonal down: sixteen rows, and eight. The squares
/// about the diagonal are complete.
///
/// Loops run along rows and skip rows with a zero factor, so that compilers vectorise
/// within a row.
#[derive(Clone, Debug)]
pub(crate) struct SymmetricMatrix([[f64; PANEL_COLUMNS]; STATES + PANEL_COLUMNS]);

impl SymmetricMatrix {
    pub(crate) fn zeros() -> SymmetricMatrix {
        SymmetricMatrix([[0.0; PANEL_COLUMNS]; STATES + PANEL_COLUMNS])
    }

    /// Returns the rows of both panels; the second's begin with row [`PANEL_COLUMNS`].
    fn panels(&self) -> [&[[f64; PANEL_COLUMNS]]; 2] {
        let (left, right) = self.0.split_at(STATES);
        [left, right]
    }

    /// Returns the rows of both panels for writing.
    pub(crate) fn panels_mut(&mut self) -> [&mut [[f64; PANEL_COLUMNS]]; 2] {
        let (left, right) = self.0.split_at_mut(STATES);
        [left, right]
    }

    pub(crate) fn at(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        let panel = j / PANEL_COLUMNS;
        self.panels()[panel][i - panel * PANEL_COLUMNS][j % PANEL_COLUMNS]
    }

    /// Sets an element and its mirror image.
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

    /// Returns the product with a vector.
    pub(crate) fn multiply(&self, vector: &[f64; STATES]) -> [f64; STATES] {
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
            // Elements below the square stand mirrored beside it.
            for (row, part) in rows.iter().zip(product).skip(PANEL_COLUMNS) {
                *part += dot(row, vector);
            }
        }
        product
    }

    /// Subtracts a vector's outer product with itself, times a factor.
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

/// Returns the product of two vectors over the shorter length, in four independent sums.
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

    /// Test vector with about one zero in three.
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
            let off = SVector::from(symmetric.multiply(&vector(seed))) - product;
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
