//! The sun at the horizon: its altitude there, and its bearing by amplitude
//! (docs/science.md, §12, equations 28 and 29).

use super::form::HorizonSight;

/// Refraction at the horizon, degrees: 34′ (*The Nautical Almanac*, rising and setting).
const HORIZON_REFRACTION_DEG: f64 = 34.0 / 60.0;
/// Standard deviation of the refraction at the horizon, degrees (Schaefer & Liller, 1990,
/// *Publ. Astron. Soc. Pacific* 102, 796).
const HORIZON_REFRACTION_SPREAD_DEG: f64 = 0.16;
/// Dip of the visible horizon, degrees for one metre of height of eye: 1.76′ (*The Nautical
/// Almanac*, altitude correction tables).
const DIP_DEG_AT_1_M: f64 = 1.76 / 60.0;
/// Semi-diameter of the sun at one astronomical unit, degrees: 959.63″.
const SEMI_DIAMETER_DEG: f64 = 959.63 / 3600.0;

/// Bearing of the sun at the horizon, by its declination and the latitude alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Amplitude {
    /// Angle from true north, degrees, 0 to 180 on either side.
    pub(super) from_north_deg: f64,
    /// Standard error from the refraction's spread, degrees.
    pub(super) standard_error_deg: f64,
}

/// Returns the altitude of the sun's centre without refraction, degrees, in the moment of
/// the sight.
pub(super) fn centre_altitude_deg(
    sight: HorizonSight,
    height_of_eye_m: f64,
    distance_au: f64,
) -> f64 {
    let horizon_deg = -(DIP_DEG_AT_1_M * height_of_eye_m.sqrt() + HORIZON_REFRACTION_DEG);
    let semi_diameter_deg = SEMI_DIAMETER_DEG / distance_au;
    match sight {
        HorizonSight::Celestial => 0.0,
        HorizonSight::Centre => horizon_deg,
        HorizonSight::UpperLimb => horizon_deg - semi_diameter_deg,
        HorizonSight::LowerLimb => horizon_deg + semi_diameter_deg,
    }
}

/// Computes the amplitude; `None` where the sun does not come to this altitude.
pub(super) fn amplitude(
    lat_deg: f64,
    declination_deg: f64,
    altitude_deg: f64,
) -> Option<Amplitude> {
    let (lat, altitude) = (lat_deg.to_radians(), altitude_deg.to_radians());
    let up = declination_deg.to_radians().sin() - lat.sin() * altitude.sin();
    let from_north = (up / (lat.cos() * altitude.cos())).acos();
    // At a pole, and where the sun stays above or below, there is no such angle.
    let slope = lat.tan() / from_north.sin();
    slope.is_finite().then(|| Amplitude {
        from_north_deg: from_north.to_degrees(),
        standard_error_deg: (HORIZON_REFRACTION_SPREAD_DEG * slope).abs(),
    })
}
