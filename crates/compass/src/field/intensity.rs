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
    /// Horizontal intensity, nT: the compass's directive field.
    ///
    /// The WMM's caution zone is below 6000 nT, its blackout zone below 2000 nT.
    pub fn h_nt(&self) -> f64 {
        self.x_nt.hypot(self.y_nt)
    }

    /// Total intensity, nT.
    pub fn f_nt(&self) -> f64 {
        self.h_nt().hypot(self.z_nt)
    }

    /// Declination, the navigator's variation: east positive.
    #[allow(clippy::missing_panics_doc, reason = "it cannot: see the message")]
    pub fn declination(&self) -> Variation {
        Variation::new(self.y_nt.atan2(self.x_nt).to_degrees())
            .expect("a field is only made from finite parts")
    }

    /// Dip: degrees below the horizon, positive north of the magnetic equator.
    pub fn inclination_deg(&self) -> f64 {
        self.z_nt.atan2(self.h_nt()).to_degrees()
    }

    /// Magnetic latitude: the latitude with this dip on a dipole earth, degrees.
    pub fn magnetic_latitude_deg(&self) -> f64 {
        self.z_nt.atan2(2.0 * self.h_nt()).to_degrees()
    }

    /// Horizontal and vertical parts, as a ship meets them.
    pub fn for_ship(&self) -> EarthField {
        EarthField {
            h_nt: self.h_nt(),
            z_nt: self.z_nt,
        }
    }
}
