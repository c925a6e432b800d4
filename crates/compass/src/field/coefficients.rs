//! Gauss coefficients of the models, read once from the embedded files.
//!
//! Terms are stored order by order: all degrees of order 0, then of order 1 and so on, the
//! sequence of the synthesis. A table's epochs ascend. Interpolation two epochs, coefficients are
//! linear in the decimal year.

use super::FieldModel;
use std::sync::LazyLock;

/// Highest degree of either model; WMM2025 ends at 12 and has zeros at 13.
pub(super) const MAX_DEGREE: usize = 13;
/// Number of terms: every degree from 0, and every order of it.
pub(super) const TERMS: usize = (MAX_DEGREE + 1) * (MAX_DEGREE + 2) / 2;

/// Index of a degree and order among the terms.
pub(super) const fn term_index(degree: usize, order: usize) -> usize {
    // Lower orders take MAX_DEGREE + 1, MAX_DEGREE, … terms.
    order * (2 * MAX_DEGREE + 3 - order) / 2 + degree - order
}

/// Schmidt quasi-normalised Gauss coefficients, nT, at one instant.
#[derive(Clone, Debug)]
pub(super) struct Terms {
    /// Coefficients of the cosines.
    pub(super) g: [f64; TERMS],
    /// Coefficients of the sines.
    pub(super) h: [f64; TERMS],
}

const NO_TERMS: Terms = Terms {
    g: [0.0; TERMS],
    h: [0.0; TERMS],
};

/// Coefficients of a model at each of its epochs.
pub(super) struct Table {
    years: Vec<f64>,
    terms: Vec<Terms>,
}

impl Table {
    pub(super) fn first_year(&self) -> f64 {
        self.years[0]
    }

    pub(super) fn last_year(&self) -> f64 {
        self.years[self.years.len() - 1]
    }

    /// Brackets a decimal year by two epochs; `None` outside the model or for NaN.
    pub(super) fn bracket(&'static self, year: f64) -> Option<Interpolation> {
        if !(self.first_year()..=self.last_year()).contains(&year) {
            return None;
        }
        let later = self.years.partition_point(|epoch| *epoch <= year);
        // The last year itself belongs to the interval that it ends.
        let later = later.min(self.years.len() - 1);
        let (from, to) = (self.years[later - 1], self.years[later]);
        Some(Interpolation {
            before: &self.terms[later - 1],
            after: &self.terms[later],
            share: (year - from) / (to - from),
        })
    }
}

/// An instant between two epochs.
pub(super) struct Interpolation {
    before: &'static Terms,
    after: &'static Terms,
    /// Elapsed fraction of the interval, 0 to 1.
    share: f64,
}

impl Interpolation {
    /// Interpolates the coefficients at the instant.
    pub(super) fn terms(&self) -> Terms {
        let between = |before: &[f64; TERMS], after: &[f64; TERMS]| {
            std::array::from_fn(|index| before[index] + self.share * (after[index] - before[index]))
        };
        Terms {
            g: between(&self.before.g, &self.after.g),
            h: between(&self.before.h, &self.after.h),
        }
    }
}

/// Returns the table of a model, read on first use.
pub(super) fn table(model: FieldModel) -> &'static Table {
    static IGRF14: LazyLock<Table> = LazyLock::new(|| {
        read_shc(include_str!("../../data/IGRF14.shc")).expect("the embedded IGRF-14 file is whole")
    });
    static WMM2025: LazyLock<Table> = LazyLock::new(|| {
        read_cof(include_str!("../../data/WMM2025.COF"))
            .expect("the embedded WMM2025 file is whole")
    });
    match model {
        FieldModel::Igrf14 => &IGRF14,
        FieldModel::Wmm2025 => &WMM2025,
    }
}

/// Reads an SHC file: comments, a line of sizes, a line of epochs, then degree,
/// order (negative for sines) and one coefficient an epoch.
fn read_shc(text: &str) -> Option<Table> {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let _sizes = lines.next()?;
    let years: Vec<f64> = numbers(lines.next()?)?;
    let mut terms = vec![NO_TERMS; years.len()];
    for line in lines.filter(|line| !line.trim().is_empty()) {
        let row = numbers(line)?;
        let (degree, order) = (row.first()?, row.get(1)?);
        let values = row.get(2..2 + years.len())?;
        let index = parse_index(*degree, order.abs())?;
        for (epoch, value) in terms.iter_mut().zip(values) {
            let side = if *order < 0.0 {
                &mut epoch.h
            } else {
                &mut epoch.g
            };
            side[index] = *value;
        }
    }
    (years.len() >= 2).then_some(Table { years, terms })
}

/// Reads a COF file: a line with the epoch, then degree, order, g, h and their
/// yearly changes, ended by a line of nines. The model holds for five years.
fn read_cof(text: &str) -> Option<Table> {
    const YEARS_VALID: f64 = 5.0;
    let mut lines = text.lines();
    let first_year: f64 = lines.next()?.split_whitespace().next()?.parse().ok()?;
    let mut terms = vec![NO_TERMS; 2];
    for line in lines.take_while(|line| !line.starts_with("9999")) {
        let [degree, order, g, h, g_yearly, h_yearly] = numbers(line)?.try_into().ok()?;
        let index = parse_index(degree, order)?;
        terms[0].g[index] = g;
        terms[0].h[index] = h;
        terms[1].g[index] = g + YEARS_VALID * g_yearly;
        terms[1].h[index] = h + YEARS_VALID * h_yearly;
    }
    Some(Table {
        years: vec![first_year, first_year + YEARS_VALID],
        terms,
    })
}

fn numbers(line: &str) -> Option<Vec<f64>> {
    line.split_whitespace()
        .map(|word| word.parse().ok())
        .collect()
}

fn parse_index(degree: f64, order: f64) -> Option<usize> {
    let (degree, order) = (degree as usize, order as usize);
    (1..=MAX_DEGREE).contains(&degree).then_some(())?;
    (order <= degree).then(|| term_index(degree, order))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_degree_and_order_has_its_own_index() {
        let mut seen = [false; TERMS];
        for order in 0..=MAX_DEGREE {
            for degree in order..=MAX_DEGREE {
                assert!(!std::mem::replace(
                    &mut seen[term_index(degree, order)],
                    true
                ));
            }
        }
        assert!(seen.iter().all(|is_taken| *is_taken));
    }

    #[test]
    fn the_embedded_files_hold_every_coefficient() {
        let igrf = table(FieldModel::Igrf14);
        assert_eq!(igrf.years.len(), 27);
        assert!(igrf.years.is_sorted());
        // 195 numbers of degrees 1 to 13, none of them zero in 2020 but few.
        let in_2020 = igrf.bracket(2020.0).unwrap().terms();
        let count = |side: &[f64]| side.iter().filter(|value| **value != 0.0).count();
        assert!(count(&in_2020.g) + count(&in_2020.h) > 190);
        let wmm = table(FieldModel::Wmm2025).bracket(2025.0).unwrap().terms();
        assert!(count(&wmm.g) + count(&wmm.h) > 160);
    }

    #[test]
    fn between_epochs_coefficients_are_linear() {
        let table = table(FieldModel::Igrf14);
        let dipole = |year| table.bracket(year).unwrap().terms().g[term_index(1, 0)];
        assert!((dipole(2025.0) + 29_350.0).abs() < 1e-9);
        assert!((dipole(2030.0) + 29_287.0).abs() < 1e-9);
        assert!((dipole(2027.5) - f64::midpoint(dipole(2025.0), dipole(2030.0))).abs() < 1e-9);
    }

    #[test]
    fn a_damaged_file_is_not_half_read() {
        assert!(read_shc("1 13 2 2 1 1900 1905\n1900 1905\n1 0 -3 x").is_none());
        assert!(read_shc("1 13 2 2 1 1900 1905\n1900 1905\n1 0 -3").is_none());
        assert!(read_shc("1 13 2 2 1 1900 1905\n1900 1905\n14 0 1 1").is_none());
        assert!(read_cof("2025.0 WMM\n 1 0 1 2 3\n").is_none());
        assert!(read_cof("").is_none());
    }
}
