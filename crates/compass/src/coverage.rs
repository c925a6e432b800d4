//! Coverage of the data: sample counts by sector of compass heading and band of magnetic
//! latitude.
//!
//! At one magnetic latitude, headings determine only the sums bx + χ13 Z and by + χ23 Z.
//! The more bands are filled, the better the model holds elsewhere.

use crate::angle::CompassHeading;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Width of a heading sector.
pub const HEADING_STEP_DEG: u16 = 15;
/// Width of a band of magnetic latitude.
pub const MAGNETIC_LATITUDE_STEP_DEG: i16 = 10;

/// Counts of samples by heading and magnetic latitude.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Coverage {
    /// Width of a heading sector, degrees.
    pub heading_step_deg: u16,
    /// Width of a band of magnetic latitude, degrees.
    pub magnetic_latitude_step_deg: i16,
    /// Bands with samples, from south to north.
    pub bands: Vec<CoverageBand>,
    /// Cells with samples, by band and then by heading.
    pub cells: Vec<CoverageCell>,
}

/// The range of fields in one band of magnetic latitude.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct CoverageBand {
    /// The band's southern edge, degrees of magnetic latitude.
    pub magnetic_latitude_from_deg: i16,
    /// Least horizontal field of its samples, nT.
    pub h_nt_from: f64,
    /// Greatest horizontal field of its samples, nT.
    pub h_nt_to: f64,
    /// Least vertical field of its samples, nT, down positive.
    pub z_nt_from: f64,
    /// Greatest vertical field of its samples, nT, down positive.
    pub z_nt_to: f64,
    /// Number of samples in it.
    pub samples: u64,
}

/// One sector of heading within one band.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct CoverageCell {
    /// The sector's first compass heading, degrees.
    pub heading_from_deg: u16,
    /// The band's southern edge, degrees of magnetic latitude.
    pub magnetic_latitude_from_deg: i16,
    /// Number of samples in it.
    pub samples: u64,
}

impl Default for Coverage {
    /// Returns the coverage of no sample.
    fn default() -> Coverage {
        Coverage {
            heading_step_deg: HEADING_STEP_DEG,
            magnetic_latitude_step_deg: MAGNETIC_LATITUDE_STEP_DEG,
            bands: Vec::new(),
            cells: Vec::new(),
        }
    }
}

impl Coverage {
    /// Adds the counts of other samples.
    pub fn append(&mut self, other: &Coverage) {
        for band in &other.bands {
            let from = band.magnetic_latitude_from_deg;
            let place = self
                .bands
                .binary_search_by_key(&from, |known| known.magnetic_latitude_from_deg);
            match place {
                Ok(place) => self.bands[place].append(band),
                Err(place) => self.bands.insert(place, *band),
            }
        }
        let key = |cell: &CoverageCell| (cell.magnetic_latitude_from_deg, cell.heading_from_deg);
        for cell in &other.cells {
            match self.cells.binary_search_by_key(&key(cell), key) {
                Ok(place) => self.cells[place].samples += cell.samples,
                Err(place) => self.cells.insert(place, *cell),
            }
        }
    }
}

impl CoverageBand {
    fn append(&mut self, other: &CoverageBand) {
        self.h_nt_from = self.h_nt_from.min(other.h_nt_from);
        self.h_nt_to = self.h_nt_to.max(other.h_nt_to);
        self.z_nt_from = self.z_nt_from.min(other.z_nt_from);
        self.z_nt_to = self.z_nt_to.max(other.z_nt_to);
        self.samples += other.samples;
    }
}

/// Magnetic latitude in degrees, atan(tan(dip)/2), north positive: the latitude with this
/// dip on a dipole earth.
pub fn magnetic_latitude_deg(h_nt: f64, z_nt: f64) -> f64 {
    z_nt.atan2(2.0 * h_nt).to_degrees()
}

/// Southern edge of a field's band, degrees of magnetic latitude.
pub fn magnetic_latitude_band_deg(h_nt: f64, z_nt: f64) -> i16 {
    band_of(magnetic_latitude_deg(h_nt, z_nt))
}

/// Counts samples given as compass heading, horizontal and vertical field in nT.
pub fn coverage(samples: impl IntoIterator<Item = (CompassHeading, f64, f64)>) -> Coverage {
    let mut bands: BTreeMap<i16, CoverageBand> = BTreeMap::new();
    let mut cells: BTreeMap<(i16, u16), u64> = BTreeMap::new();
    for (compass, h_nt, z_nt) in samples {
        let band_from = magnetic_latitude_band_deg(h_nt, z_nt);
        let band = bands.entry(band_from).or_insert(CoverageBand {
            magnetic_latitude_from_deg: band_from,
            h_nt_from: h_nt,
            h_nt_to: h_nt,
            z_nt_from: z_nt,
            z_nt_to: z_nt,
            samples: 0,
        });
        band.h_nt_from = band.h_nt_from.min(h_nt);
        band.h_nt_to = band.h_nt_to.max(h_nt);
        band.z_nt_from = band.z_nt_from.min(z_nt);
        band.z_nt_to = band.z_nt_to.max(z_nt);
        band.samples += 1;
        *cells.entry((band_from, sector_of(compass))).or_default() += 1;
    }
    Coverage {
        bands: bands.into_values().collect(),
        cells: cells
            .into_iter()
            .map(
                |((magnetic_latitude_from_deg, heading_from_deg), samples)| CoverageCell {
                    heading_from_deg,
                    magnetic_latitude_from_deg,
                    samples,
                },
            )
            .collect(),
        ..Coverage::default()
    }
}

/// The southern edge of the band; the pole itself belongs to the last band.
fn band_of(magnetic_latitude_deg: f64) -> i16 {
    let step = MAGNETIC_LATITUDE_STEP_DEG;
    let band = (magnetic_latitude_deg / f64::from(step)).floor() as i16 * step;
    band.clamp(-90, 90 - step)
}

fn sector_of(compass: CompassHeading) -> u16 {
    (compass.degrees() / f64::from(HEADING_STEP_DEG)) as u16 * HEADING_STEP_DEG
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // exact values go in and come out
mod tests {
    use super::*;

    fn heading(degrees: f64) -> CompassHeading {
        CompassHeading::new(degrees).unwrap()
    }

    #[test]
    fn magnetic_latitude_follows_the_dip() {
        // Where tan(dip) is 2, a dipole's latitude is 45°.
        assert!((magnetic_latitude_deg(20_000.0, 40_000.0) - 45.0).abs() < 1e-9);
        assert!((magnetic_latitude_deg(20_000.0, -40_000.0) + 45.0).abs() < 1e-9);
        assert_eq!(magnetic_latitude_deg(30_000.0, 0.0), 0.0);
    }

    #[test]
    fn samples_fall_into_their_sector_and_band() {
        let counted = coverage([
            (heading(0.0), 20_000.0, 40_000.0),
            (heading(14.9), 21_000.0, 42_000.0),
            (heading(359.9), 30_000.0, -1.0),
        ]);
        assert_eq!(counted.bands.len(), 2);
        assert_eq!(counted.bands[0].magnetic_latitude_from_deg, -10);
        assert_eq!(counted.bands[1].magnetic_latitude_from_deg, 40);
        assert_eq!(counted.bands[1].h_nt_to, 21_000.0);
        assert_eq!(
            counted.cells,
            vec![
                CoverageCell {
                    heading_from_deg: 345,
                    magnetic_latitude_from_deg: -10,
                    samples: 1
                },
                CoverageCell {
                    heading_from_deg: 0,
                    magnetic_latitude_from_deg: 40,
                    samples: 2
                },
            ]
        );
    }

    #[test]
    fn counts_of_two_parts_add_up_to_those_of_all() {
        let samples = [
            (heading(0.0), 20_000.0, 40_000.0),
            (heading(14.9), 21_000.0, 42_000.0),
            (heading(200.0), 31_000.0, -2.0),
            (heading(359.9), 30_000.0, -1.0),
        ];
        for parted in 0..=samples.len() {
            let (one, other) = samples.split_at(parted);
            let mut counted = Coverage::default();
            counted.append(&coverage(one.iter().copied()));
            counted.append(&coverage(other.iter().copied()));
            assert_eq!(counted, coverage(samples), "{parted}");
        }
    }

    #[test]
    fn the_magnetic_pole_belongs_to_the_last_band() {
        let counted = coverage([
            (heading(90.0), 0.0, 60_000.0),
            (heading(90.0), 0.0, -60_000.0),
        ]);
        assert_eq!(counted.bands[0].magnetic_latitude_from_deg, -90);
        assert_eq!(counted.bands[1].magnetic_latitude_from_deg, 80);
    }
}
