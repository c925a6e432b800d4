//! Plausibility of the place and the time of a reading at the berth.
//!
//! Invariants: a reading is refused by independent knowledge alone, the port of the order and the
//! vessel's own track. Without either it is accepted.

use crate::berth_session::plan::READING_VALIDITY_S;
use crate::firms::named_port;
use crate::work_orders::refusal::{Cure, Refusal};
use crate::work_orders::summary::Summary;
use binnacle_adjustment::adjust::ReadingForm;
use binnacle_compass::position::Position;
use binnacle_fleet::analysis;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::time::Time;

/// Largest distance of a berth from the listed position of its port, nautical miles.
const MAX_BERTH_DISTANCE_NM: f64 = 60.0;
/// Highest speed of a vessel, knots.
const MAX_SPEED_KN: f64 = 30.0;
/// Tolerance between a track and a berth on the chart, nautical miles.
const TRACK_TOLERANCE_NM: f64 = 5.0;
/// Period of the track around a reading, seconds.
const TRACK_WINDOW_S: f64 = 48.0 * 3600.0;
/// Mean radius of the earth, nautical miles.
const EARTH_NM: f64 = 3440.07;

/// Refuses a reading that is too old for a plan.
///
/// # Errors
/// Names the field.
pub(crate) fn check_reading_age(given: &ReadingForm, now: Time) -> Result<()> {
    let age_s = now.0.seconds_since(given.at);
    if age_s > READING_VALIDITY_S {
        return Err(Error::Invalid {
            field: "at",
            detail: format!(
                "is {:.0} hours old: a reading is valid for {:.0}",
                age_s / 3600.0,
                READING_VALIDITY_S / 3600.0
            ),
        });
    }
    Ok(())
}

/// Refuses a reading at a place where the vessel cannot have been at that time.
pub(crate) async fn check_position(
    app: &App,
    summary: &Summary,
    given: &ReadingForm,
) -> Result<Option<Refusal>> {
    let Ok(berth) = Position::new(given.lat, given.lon) else {
        return Ok(None);
    };
    if let Some(words) = not_in_port(berth, &summary.port) {
        return Ok(Some(refusal(words)));
    }
    let around = [-TRACK_WINDOW_S, TRACK_WINDOW_S].map(|s| Some(Time(given.at.plus_seconds(s))));
    let samples = analysis::samples(
        &app.db,
        summary.vessel_id,
        summary.compass_id,
        around[0],
        around[1],
    )
    .await?;
    let mut nearest: Option<(f64, Position)> = None;
    for found in samples {
        let apart_s = given.at.seconds_since(found.sample.time).abs();
        if nearest.is_none_or(|(least_s, _)| apart_s < least_s) {
            nearest = Some((apart_s, found.sample.position));
        }
    }
    Ok(nearest
        .and_then(|(apart_s, seen)| too_far(berth, apart_s, seen))
        .map(refusal))
}

fn refusal(words: String) -> Refusal {
    Refusal {
        refusal: "position_unlikely".to_owned(),
        words,
        could_be: vec![
            "the position is wrong, perhaps east for west or north for south".to_owned(),
            "it was read at another time".to_owned(),
            "the vessel is in another port than the order's".to_owned(),
        ],
        cures: vec![Cure::ReadAgain],
    }
}

/// Compares the position with the listed port. Unknown ports are not checked.
fn not_in_port(berth: Position, port: &str) -> Option<String> {
    let known = named_port(port)?;
    let (apart_nm, name) = (distance_nm(berth, known.position), known.name);
    (apart_nm > MAX_BERTH_DISTANCE_NM).then(|| {
        format!(
            "the position of the reading is {apart_nm:.0} nautical miles from {name}, where the \
             order is to be done"
        )
    })
}

/// Compares the position with the nearest one on the vessel's track.
fn too_far(berth: Position, apart_s: f64, seen: Position) -> Option<String> {
    let apart_nm = distance_nm(berth, seen);
    let hours = apart_s / 3600.0;
    (apart_nm > TRACK_TOLERANCE_NM + MAX_SPEED_KN * hours).then(|| {
        format!(
            "the position of the reading is {apart_nm:.0} nautical miles from the vessel's \
                track, {hours:.1} hours apart"
        )
    })
}

/// Great-circle distance, nautical miles.
fn distance_nm(one: Position, other: Position) -> f64 {
    let [lat, other_lat] = [one, other].map(|place| place.lat_deg().to_radians());
    let [lon, other_lon] = [one, other].map(|place| place.lon_deg().to_radians());
    let half = ((other_lat - lat) / 2.0).sin().powi(2)
        + lat.cos() * other_lat.cos() * ((other_lon - lon) / 2.0).sin().powi(2);
    2.0 * EARTH_NM * half.clamp(0.0, 1.0).sqrt().asin()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(lat: f64, lon: f64) -> Position {
        Position::new(lat, lon).unwrap()
    }

    #[test]
    fn a_minute_of_latitude_is_a_mile() {
        let apart = distance_nm(at(43.0, -3.0), at(44.0, -3.0));
        assert!((apart - 60.0).abs() < 0.1, "{apart}");
        let apart = distance_nm(at(0.0, 179.5), at(0.0, -179.5));
        assert!((apart - 60.0).abs() < 0.1, "{apart}");
    }

    #[test]
    fn a_berth_is_near_its_port_whatever_the_case_of_its_name() {
        for port in ["Bilbao", " bilbao ", "ESBIO", "Bilbao (ESBIO)"] {
            assert_eq!(not_in_port(at(43.35, -3.04), port), None);
            assert!(
                not_in_port(at(43.35, 3.04), port).is_some(),
                "east for west"
            );
            assert!(not_in_port(at(10.0, -3.04), port).is_some());
        }
        assert_eq!(not_in_port(at(10.0, -3.04), "Nowhere at all"), None);
    }

    #[test]
    fn she_is_no_farther_than_she_can_have_steamed() {
        assert!(too_far(at(43.0, -3.0), 600.0, at(44.0, -3.0)).is_some());
        assert_eq!(too_far(at(43.0, -3.0), 7_200.0, at(44.0, -3.0)), None);
    }
}
