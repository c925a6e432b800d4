//! The intensity of the earth's field and its elements.

use crate::angle::Variation;
use crate::ship::EarthField;

/// The earth's field at one place and time, in nanotesla.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Towards true (geodetic) north.
    pub x_nt: f64,
    /// Towards east.
    pub y_nt: f64,
    /// Down.
    pub z_nt: f64,
}

impl Field {
    /// Horizontal intensity, nT: what the compass points by.
    ///
    /// Below 6000 nT the WMM calls declination a matter of caution, below
    /// 2000 nT unusable.
    pub fn h_nt(&self) -> f64 {
        self.x_nt.hypot(self.y_nt)
    }

    /// Total intensity, nT.
    pub fn f_nt(&self) -> f64 {
        self.h_nt().hypot(self.z_nt)
    }

    /// Declination, which seamen call variation: east positive.
    #[allow(clippy::missing_panics_doc, reason = "it cannot: see the message")]
    pub fn declination(&self) -> Variation {
        Variation::new(self.y_nt.atan2(self.x_nt).to_degrees())
            .expect("a field is only made from finite parts")
    }

    /// Dip: degrees below the horizon, positive north of the magnetic equator.
    pub fn inclination_deg(&self) -> f64 {
        self.z_nt.atan2(self.h_nt()).to_degrees()
    }

    /// Dip latitude: the magnetic latitude whose dipole has this dip, degrees.
    pub fn magnetic_latitude_deg(&self) -> f64 {
        self.z_nt.atan2(2.0 * self.h_nt()).to_degrees()
    }

    /// The parts a ship meets: horizontal and vertical.
    pub fn for_ship(&self) -> EarthField {
        EarthField {
            h_nt: self.h_nt(),
            z_nt: self.z_nt,
        }
    }
}
