//! Evidence from other ships: a disturbance of the same hours in other waters supports a
//! magnetic storm, one of other times at the same place supports a local cause.
//!
//! Invariants: a confirmed change of the ship itself or of a reference stays unchanged.
//! Without evidence, everything stays unchanged. Probabilities sum to one. No ship and no
//! place is identified.

use super::change::{Cause, CauseProbability, Change};
use crate::position::Position;
use crate::time::Timestamp;

/// Likelihood ratio per other disturbed ship: in the same hours for a storm, at the same
/// place for a local cause. Most ships under way in a storm show it; by chance, fewer than
/// one in twenty is disturbed at a given time.
const LIKELIHOOD_RATIO_PER_SHIP: f64 = 10.0;
/// Greatest number of ships that count: their errors may be common.
const MAX_SHIPS: i32 = 3;
/// Greatest distance of ships that may share a local cause, nautical miles.
const MAX_COMPANY_NM: f64 = 100.0;
/// Greatest size of a crustal anomaly or a port, nautical miles.
const MAX_PLACE_NM: f64 = 20.0;
/// Least overlap of two simultaneous disturbances, as a share of the shorter one.
const MIN_OVERLAP: f64 = 0.5;
/// Least separation in time of disturbances with a common local cause, seconds: a storm
/// lasts days.
const MIN_SEPARATION_S: f64 = 2.0 * 86_400.0;
/// Probability of a cause that is not in the list.
const UNLISTED_PROBABILITY: f64 = 0.002;

/// A transient disturbance of another ship's compass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FleetDisturbance {
    /// Anonymous identifier of the ship.
    pub ship: usize,
    /// Beginning of the disturbance.
    pub from: Timestamp,
    /// End of the disturbance, or its last observation.
    pub until: Timestamp,
    /// Approximate position of that ship.
    pub position: Position,
}

/// Duration of a disturbance.
#[derive(Clone, Copy)]
struct Span {
    from: Timestamp,
    until: Timestamp,
}

/// Reweighs the causes of a change by the disturbances of other ships. `position` is this
/// ship's approximate position; `until` is the last observation of a lasting change.
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
    let span = Span {
        from: change.from,
        until: change.ended.unwrap_or(until).max(change.from),
    };
    let apart_nm =
        |other: &FleetDisturbance| position.map(|here| nautical_miles(here, other.position));
    let at_once = count_ships(others, |other| {
        overlaps(span, other) && apart_nm(other).is_none_or(|nm| nm > MAX_COMPANY_NM)
    });
    let at_the_place = count_ships(others, |other| {
        is_separate_in_time(span, other) && apart_nm(other).is_some_and(|nm| nm < MAX_PLACE_NM)
    });
    if at_once + at_the_place == 0 {
        return change;
    }
    reweigh(&mut change.causes, |cause| match cause {
        Cause::MagneticStorm => LIKELIHOOD_RATIO_PER_SHIP.powi(at_once.min(MAX_SHIPS)),
        Cause::LocalAnomaly | Cause::BerthSteel => {
            LIKELIHOOD_RATIO_PER_SHIP.powi(at_the_place.min(MAX_SHIPS))
        }
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

/// Counts the different ships with such a disturbance.
fn count_ships(others: &[FleetDisturbance], matches: impl Fn(&FleetDisturbance) -> bool) -> i32 {
    let mut found: Vec<usize> = others
        .iter()
        .filter(|o| matches(o))
        .map(|o| o.ship)
        .collect();
    found.sort_unstable();
    found.dedup();
    i32::try_from(found.len()).unwrap_or(i32::MAX)
}

fn overlaps(span: Span, other: &FleetDisturbance) -> bool {
    let Span { from, until } = span;
    let shared_s = until.min(other.until).seconds_since(from.max(other.from));
    let shorter_s = until
        .seconds_since(from)
        .min(other.until.seconds_since(other.from));
    shared_s >= 0.0 && shared_s >= MIN_OVERLAP * shorter_s
}

fn is_separate_in_time(span: Span, other: &FleetDisturbance) -> bool {
    let Span { from, until } = span;
    from.seconds_since(other.until) > MIN_SEPARATION_S
        || other.from.seconds_since(until) > MIN_SEPARATION_S
}

/// Applies Bayes' rule with the likelihood of the evidence under each cause.
fn reweigh(causes: &mut Vec<CauseProbability>, likelihood: impl Fn(Cause) -> f64) {
    for cause in [Cause::MagneticStorm, Cause::LocalAnomaly] {
        if causes.iter().all(|known| known.cause != cause) {
            causes.push(CauseProbability {
                cause,
                probability: UNLISTED_PROBABILITY,
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

/// Approximates the distance of neighbouring places.
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

    /// A two-hour disturbance, by itself more likely a local anomaly than a storm.
    fn disturbance() -> Change {
        Change {
            from: at(10.0),
            from_earliest: at(9.8),
            from_latest: at(10.0),
            detected_at: at(10.5),
            confirmed: true,
            position: None,
            disturbed_deg: None,
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
        let alone = disturbance();
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
    fn a_weak_transient_is_certain_once_others_speak_for_it() {
        let weak = Change {
            confirmed: false,
            ..disturbance()
        };
        assert!(weak.is_weak_transient());
        assert!(seen(&weak, &[]).is_weak_transient());
        let stormy = seen(&weak, &[other(0, 9.0, place(55.0, 10.0))]);
        assert!(stormy.confirmed);
        assert_eq!(stormy.cause, Cause::MagneticStorm);
        let unfinished = Change {
            ended: None,
            ..weak
        };
        assert!(!seen(&unfinished, &[other(0, 9.0, place(55.0, 10.0))]).confirmed);
    }

    #[test]
    fn a_ship_in_company_or_at_another_time_elsewhere_is_no_evidence() {
        let alone = disturbance();
        let company = other(0, 10.0, place(43.1, -4.1));
        let otherwise = other(1, 200.0, place(55.0, 10.0));
        assert_eq!(seen(&alone, &[company, otherwise]), alone);
    }

    #[test]
    fn a_disturbance_of_others_at_the_same_place_speaks_for_the_place() {
        let mut long = disturbance();
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
    fn a_confirmed_change_of_the_ship_stays_and_an_unconfirmed_one_is_reweighed() {
        let mut struck = disturbance();
        struck.cause = Cause::LightningOrShock;
        struck.causes = vec![CauseProbability {
            cause: Cause::LightningOrShock,
            probability: 1.0,
        }];
        struck.deviation_change_deg = Some(4.0);
        let stormy = [0, 1, 2].map(|ship| other(ship, 10.0, place(55.0, 10.0)));
        assert_eq!(seen(&struck, &stormy), struck);
        struck.confirmed = false;
        let reweighed = seen(&struck, &stormy);
        assert_eq!(reweighed.cause, Cause::MagneticStorm);
        assert_eq!(reweighed.deviation_change_deg, None);
    }
}
