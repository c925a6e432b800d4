//! What other ships tell of a disturbance: one of the same hours in other waters
//! speaks for a magnetic storm, one of other times at the same place for the place.
//!
//! What always holds: what is the ship's for certain, and what a reference did, is left
//! as it was; without evidence so is everything; the probabilities add up to one. No
//! ship is named, and no place.

use super::change::{Cause, CauseProbability, Change};
use crate::position::Position;
use crate::time::Timestamp;

/// How much likelier a storm is for each other ship that was disturbed in the same
/// hours, and a place for each that was disturbed there: a ship under way in a storm
/// most often shows it, while by chance hardly one in twenty is disturbed just then.
const FOR_EACH_SHIP: f64 = 10.0;
/// More ships than this add nothing: what misleads one may mislead the next.
const MOST_SHIPS: i32 = 3;
/// Ships nearer to each other than this may share a place, nautical miles.
const APART_NM: f64 = 100.0;
/// The crust's anomalies and ports are smaller than this, nautical miles.
const PLACE_NM: f64 = 20.0;
/// Of the shorter of two disturbances, so large a part must be of the same hours.
const SHARED: f64 = 0.5;
/// A storm lasts days: what is closer in time does not speak for the place, seconds.
const OTHER_TIMES_S: f64 = 2.0 * 86_400.0;
/// What was too unlikely to be listed may still be.
const FLOOR: f64 = 0.002;

/// A passing disturbance of another ship's compass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FleetDisturbance {
    /// Tells ships apart, and says nothing else of them.
    pub ship: usize,
    /// When it began.
    pub from: Timestamp,
    /// When it was over, or last seen.
    pub until: Timestamp,
    /// About where that ship was.
    pub position: Position,
}

/// The same change in the light of what other ships showed; `position` is about where
/// this one was, and `until` when it was last seen if it lasts.
pub fn weigh_with_fleet(
    change: &Change,
    position: Option<Position>,
    until: Timestamp,
    others: &[FleetDisturbance],
) -> Change {
    let mut change = change.clone();
    if change.withdrawn || (change.confirmed && !change.cause.is_transient()) {
        return change;
    }
    let span = (change.from, change.ended.unwrap_or(until).max(change.from));
    let apart_nm =
        |other: &FleetDisturbance| position.map(|here| nautical_miles(here, other.position));
    let at_once = ships(others, |other| {
        is_of_the_same_hours(span, other) && apart_nm(other).is_none_or(|nm| nm > APART_NM)
    });
    let at_the_place = ships(others, |other| {
        is_of_other_times(span, other) && apart_nm(other).is_some_and(|nm| nm < PLACE_NM)
    });
    if at_once + at_the_place == 0 {
        return change;
    }
    weigh(&mut change.causes, |cause| match cause {
        Cause::MagneticStorm => FOR_EACH_SHIP.powi(at_once.min(MOST_SHIPS)),
        Cause::LocalAnomaly | Cause::BerthSteel => FOR_EACH_SHIP.powi(at_the_place.min(MOST_SHIPS)),
        _ => 1.0,
    });
    change.cause = change.causes.first().map_or(change.cause, |c| c.cause);
    if change.cause.is_transient() {
        change.confirmed |= change.is_weak_transient();
        change.step = None;
        change.deviation_change_deg = None;
    }
    let ships_were = |count| match count {
        1 => "1 other ship was".to_owned(),
        count => format!("{count} other ships were"),
    };
    if at_once > 0 {
        change.evidence.push(format!(
            "{} disturbed in the same hours in other waters",
            ships_were(at_once)
        ));
    }
    if at_the_place > 0 {
        change.evidence.push(format!(
            "{} disturbed at this place at another time",
            ships_were(at_the_place)
        ));
    }
    change
}

/// How many different ships show such a disturbance.
fn ships(others: &[FleetDisturbance], such: impl Fn(&FleetDisturbance) -> bool) -> i32 {
    let mut found: Vec<usize> = others.iter().filter(|o| such(o)).map(|o| o.ship).collect();
    found.sort_unstable();
    found.dedup();
    i32::try_from(found.len()).unwrap_or(i32::MAX)
}

fn is_of_the_same_hours((from, until): (Timestamp, Timestamp), other: &FleetDisturbance) -> bool {
    let shared_s = until.min(other.until).seconds_since(from.max(other.from));
    let shorter_s = until
        .seconds_since(from)
        .min(other.until.seconds_since(other.from));
    shared_s >= 0.0 && shared_s >= SHARED * shorter_s
}

fn is_of_other_times((from, until): (Timestamp, Timestamp), other: &FleetDisturbance) -> bool {
    from.seconds_since(other.until) > OTHER_TIMES_S
        || other.from.seconds_since(until) > OTHER_TIMES_S
}

/// Bayes' rule with the likelihood of the evidence under each cause.
fn weigh(causes: &mut Vec<CauseProbability>, likelihood: impl Fn(Cause) -> f64) {
    for cause in [Cause::MagneticStorm, Cause::LocalAnomaly] {
        if causes.iter().all(|known| known.cause != cause) {
            causes.push(CauseProbability {
                cause,
                probability: FLOOR,
            });
        }
    }
    for known in causes.iter_mut() {
        known.probability *= likelihood(known.cause);
    }
    let sum: f64 = causes.iter().map(|known| known.probability).sum();
    for known in causes.iter_mut() {
        known.probability /= sum;
    }
    causes.sort_by(|a, b| b.probability.total_cmp(&a.probability));
}

/// Nearly, for places that are not far apart.
fn nautical_miles(a: Position, b: Position) -> f64 {
    let north = a.lat_deg() - b.lat_deg();
    let east = crate::angle::wrap_180(a.lon_deg() - b.lon_deg());
    60.0 * north.hypot(east * a.lat_deg().to_radians().cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(hour: f64) -> Timestamp {
        Timestamp::parse("2026-11-18T00:00:00Z")
            .unwrap()
            .plus_seconds(3600.0 * hour)
    }

    fn place(lat: f64, lon: f64) -> Position {
        Position::new(lat, lon).unwrap()
    }

    /// Two hours astray: by itself rather a place than the sun.
    fn astray() -> Change {
        Change {
            from: at(10.0),
            from_earliest: at(9.8),
            from_latest: at(10.0),
            detected_at: at(10.5),
            confirmed: true,
            withdrawn: false,
            cause: Cause::LocalAnomaly,
            causes: [(Cause::LocalAnomaly, 0.8), (Cause::MagneticStorm, 0.2)]
                .map(|(cause, probability)| CauseProbability { cause, probability })
                .to_vec(),
            evidence: vec!["it lasted 2.0 hours".to_owned()],
            deviation_change_deg: None,
            step: None,
            ended: Some(at(12.0)),
        }
    }

    fn other(ship: usize, hour: f64, position: Position) -> FleetDisturbance {
        FleetDisturbance {
            ship,
            from: at(hour),
            until: at(hour + 3.0),
            position,
        }
    }

    fn seen(change: &Change, others: &[FleetDisturbance]) -> Change {
        let seen = weigh_with_fleet(change, Some(place(43.0, -4.0)), at(24.0), others);
        let sum: f64 = seen.causes.iter().map(|c| c.probability).sum();
        assert!((sum - 1.0).abs() < 1e-9);
        assert_eq!(seen.cause, seen.causes[0].cause);
        seen
    }

    #[test]
    fn two_ships_in_one_storm_name_it_and_one_alone_does_not() {
        let alone = astray();
        assert_eq!(seen(&alone, &[]), alone);
        let far = place(55.0, 10.0);
        let stormy = seen(&alone, &[other(0, 9.0, far)]);
        assert_eq!(stormy.cause, Cause::MagneticStorm);
        assert!(stormy.evidence[1].starts_with("1 other ship was disturbed in the same hours"));
        // The same ship twice is one ship.
        let twice = seen(&alone, &[other(0, 9.0, far), other(0, 11.0, far)]);
        assert_eq!(twice.causes, stormy.causes);
        let three = [0, 1, 2].map(|ship| other(ship, 10.5, far));
        assert!(seen(&alone, &three).causes[0].probability > 0.99);
    }

    #[test]
    fn what_is_faint_is_certain_once_others_speak_for_it() {
        let faint = Change {
            confirmed: false,
            ..astray()
        };
        assert!(faint.is_weak_transient());
        assert!(seen(&faint, &[]).is_weak_transient());
        let stormy = seen(&faint, &[other(0, 9.0, place(55.0, 10.0))]);
        assert!(stormy.confirmed);
        assert_eq!(stormy.cause, Cause::MagneticStorm);
        let still_astray = Change {
            ended: None,
            ..faint
        };
        assert!(!seen(&still_astray, &[other(0, 9.0, place(55.0, 10.0))]).confirmed);
    }

    #[test]
    fn a_ship_in_company_or_at_another_time_elsewhere_tells_nothing() {
        let alone = astray();
        let company = other(0, 10.0, place(43.1, -4.1));
        let otherwise = other(1, 200.0, place(55.0, 10.0));
        assert_eq!(seen(&alone, &[company, otherwise]), alone);
    }

    #[test]
    fn what_others_met_at_the_same_place_speaks_for_the_place() {
        let mut long = astray();
        long.causes.reverse();
        for (known, probability) in long.causes.iter_mut().zip([0.7, 0.3]) {
            known.probability = probability;
        }
        long.cause = Cause::MagneticStorm;
        let there = other(0, -200.0, place(43.1, -4.1));
        let seen = seen(&long, &[there]);
        assert_eq!(seen.cause, Cause::LocalAnomaly);
        assert!(seen.evidence[1].contains("at this place at another time"));
    }

    #[test]
    fn what_is_the_ships_for_certain_stays_so_and_doubt_gives_way() {
        let mut struck = astray();
        struck.cause = Cause::LightningOrShock;
        struck.causes = vec![CauseProbability {
            cause: Cause::LightningOrShock,
            probability: 1.0,
        }];
        struck.deviation_change_deg = Some(4.0);
        let stormy = [0, 1, 2].map(|ship| other(ship, 10.0, place(55.0, 10.0)));
        assert_eq!(seen(&struck, &stormy), struck);
        struck.confirmed = false;
        let doubtful = seen(&struck, &stormy);
        assert_eq!(doubtful.cause, Cause::MagneticStorm);
        assert_eq!(doubtful.deviation_change_deg, None);
    }
}
