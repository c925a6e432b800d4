//! Hours that a team travels between ports, and between berths of one.

use crate::ports::{self, PortCode};
use binnacle_compass::position::Position;
use serde::{Deserialize, Serialize};

/// Hours between two berths of one port, with the gear: an assumption.
pub(crate) const BERTH_H: f64 = 0.5;
/// Hours to load and unload a car with the gear: an assumption.
const BY_ROAD_H: f64 = 0.5;
/// Mean speed by road, km/h: an assumption.
const ROAD_KM_H: f64 = 60.0;
/// Length of a road over the great circle's. Ballou, Rahardja and Sakai,
/// "Selected country circuity factors for road travel distance estimation",
/// Transportation Research Part A 36, 2002: 1.2 to 1.6 in most countries.
const DETOUR: f64 = 1.3;
/// Hours to, in and from airports: an assumption.
const BY_AIR_H: f64 = 5.0;
/// Mean speed by air, km/h: an assumption.
const AIR_KM_H: f64 = 750.0;
/// Mean radius of the earth, km (IUGG).
const EARTH_KM: f64 = 6371.0;

/// Hours between two ports, either way; between berths where they are one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct TravelTime {
    /// A port of the firm, UN/LOCODE.
    #[cfg_attr(feature = "openapi", schema(value_type = String, example = "NLRTM"))]
    pub from: PortCode,
    /// Another, or the same.
    #[cfg_attr(feature = "openapi", schema(value_type = String, example = "BEANR"))]
    pub to: PortCode,
    /// Hours from one job's end to the next one's beginning.
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 72))]
    pub hours: f64,
}

/// Returns the seconds between all of a firm's ports, in their order: its own times, and
/// by distance where it gives none. A way by a third port is taken where it is
/// shorter.
pub(crate) fn travel_s(ports: &[PortCode], own: &[TravelTime]) -> Vec<Vec<i64>> {
    let mut times: Vec<Vec<i64>> = ports
        .iter()
        .map(|from| {
            let each = ports
                .iter()
                .map(|to| (hours(own, *from, *to) * 3600.0).ceil() as i64);
            each.collect()
        })
        .collect();
    for by in 0..ports.len() {
        for from in 0..ports.len() {
            for to in 0..ports.len() {
                let longer = times[from][by] + times[by][to];
                if from != to && longer < times[from][to] {
                    times[from][to] = longer;
                }
            }
        }
    }
    times
}

fn hours(own: &[TravelTime], from: PortCode, to: PortCode) -> f64 {
    let own = own
        .iter()
        .find(|time| (time.from, time.to) == (from, to) || (time.to, time.from) == (from, to));
    own.map_or_else(|| usual_hours(from, to), |time| time.hours)
}

/// Returns the hours between two ports by the quicker of road and air, from their distance
/// along the great circle; those between two berths, for one port.
pub fn usual_hours(from: PortCode, to: PortCode) -> f64 {
    if from == to {
        return BERTH_H;
    }
    let (Some(from), Some(to)) = (ports::find(from), ports::find(to)) else {
        return BERTH_H;
    };
    let km = distance_km(from.position, to.position);
    (BY_ROAD_H + km * DETOUR / ROAD_KM_H).min(BY_AIR_H + km / AIR_KM_H)
}

/// Returns the distance along the great circle (haversine formula).
fn distance_km(from: Position, to: Position) -> f64 {
    let [lat, other_lat] = [from, to].map(|at| at.lat_deg().to_radians());
    let half_lat = (other_lat - lat) / 2.0;
    let half_lon = (to.lon_deg() - from.lon_deg()).to_radians() / 2.0;
    let chord = half_lat.sin().powi(2) + lat.cos() * other_lat.cos() * half_lon.sin().powi(2);
    2.0 * EARTH_KM * chord.sqrt().min(1.0).asin()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn port(code: &str) -> PortCode {
        PortCode::parse(code).unwrap()
    }

    #[test]
    fn near_ports_are_reached_by_road_and_far_ones_by_air() {
        let hours = |from, to| usual_hours(port(from), port(to));
        assert!((hours("NLRTM", "NLRTM") - 0.5).abs() < 1e-9);
        // 76 km, and 10 500 km.
        assert!(
            (1.9..2.6).contains(&hours("NLRTM", "BEANR")),
            "{}",
            hours("NLRTM", "BEANR")
        );
        assert!(
            (18.5..19.5).contains(&hours("NLRTM", "SGSIN")),
            "{}",
            hours("NLRTM", "SGSIN")
        );
        assert!((hours("SGSIN", "NLRTM") - hours("NLRTM", "SGSIN")).abs() < 1e-9);
    }
}
