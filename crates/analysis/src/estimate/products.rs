//! Sums of weighted products of columns for normal equations.

use nalgebra::SMatrix;

/// Σ w v vᵀ over vectors v of an even length `N`. Only the lower triangle is kept, in
/// blocks of two by two: processors multiply two numbers at a time.
#[derive(Clone, Debug)]
pub(crate) struct Products<const N: usize>([[f64; N]; N]);

impl<const N: usize> Products<N> {
    /// Makes an empty sum.
    pub(crate) fn new() -> Products<N> {
        const { assert!(N.is_multiple_of(2)) };
        Products([[0.0; N]; N])
    }

    /// Adds a vector's products with itself.
    pub(crate) fn add(&mut self, v: &[f64; N], weight: f64) {
        let pairs = v.as_chunks::<2>().0;
        for (i, [first, second]) in self.0.as_chunks_mut::<2>().0.iter_mut().enumerate() {
            let [a, b] = pairs[i].map(|x| x * weight);
            let first = first.as_chunks_mut::<2>().0;
            let second = second.as_chunks_mut::<2>().0;
            for ((first, second), [c, d]) in first.iter_mut().zip(second).zip(&pairs[..=i]) {
                first[0] += a * c;
                first[1] += a * d;
                second[0] += b * c;
                second[1] += b * d;
            }
        }
    }

    /// Adds another sum.
    pub(crate) fn add_all(&mut self, other: &Products<N>) {
        for (row, other) in self.0.iter_mut().zip(&other.0) {
            for (cell, other) in row.iter_mut().zip(other) {
                *cell += other;
            }
        }
    }

    /// Returns the element in row `i` and column `j`.
    pub(crate) fn at(&self, i: usize, j: usize) -> f64 {
        self.0[i.max(j)][i.min(j)]
    }

    /// Returns the whole sum.
    pub(crate) fn to_matrix(&self) -> SMatrix<f64, N, N> {
        SMatrix::from_fn(|i, j| self.at(i, j))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SVector;

    #[test]
    fn the_sum_is_that_of_whole_matrices() {
        let vectors = [[1.0, -2.0, 3.0, 0.5], [4.0, 0.0, -1.0, 7.0]];
        let weights = [0.25, 2.0];
        let mut products = Products::new();
        let mut whole = SMatrix::<f64, 4, 4>::zeros();
        for (v, weight) in vectors.iter().zip(weights) {
            products.add(v, weight);
            let v = SVector::from(*v);
            whole += v * v.transpose() * weight;
        }
        assert_eq!(products.to_matrix(), whole);
        assert_eq!(products.at(0, 3).to_bits(), products.at(3, 0).to_bits());
        products.add_all(&products.clone());
        assert_eq!(products.to_matrix(), whole * 2.0);
    }
}
