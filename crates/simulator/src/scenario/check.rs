//! From what stands in the file to what can be sailed.

use super::error::Source;
use super::raw::{Matrix, Number, RawEvent, RawPoint, RawScenario, RawShip, Vector};
use super::{
    Anomaly, Event, GyroPlan, LineFaults, RoutePoint, SatellitePlan, Scenario, ScenarioError,
    ShipPlan, Storm, Timing,
};
use crate::earth::Chart;
use crate::poisson::{Field, Magnetism};
use binnacle_magnetics::position::Position;
use binnacle_magnetics::time::Timestamp;
use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use std::sync::Arc;

type Checked<T> = Result<T, ScenarioError>;
type Routes = BTreeMap<String, Arc<[RoutePoint]>>;

const LATEST_DAY: f64 = 3650.0;
const PERMANENT_NT: RangeInclusive<f64> = -60_000.0..=60_000.0;
const INDUCED: RangeInclusive<f64> = -0.8..=0.8;
/// A card that is pulled north by less than this share of the earth's force on
/// some heading is of no use there.
const LEAST_DIRECTIVE_FORCE: f64 = 0.2;

pub(super) fn scenario(source: &Source<'_>, raw: &RawScenario) -> Checked<Scenario> {
    let start = start(source, raw)?;
    let mut routes = Routes::new();
    for (name, points) in &raw.routes {
        let field = format!("routes.{name}");
        routes.insert(name.clone(), route(source, &field, points)?);
    }
    let ships = raw.ships.get_ref();
    if ships.is_empty() {
        return Err(source.error(raw.ships.span(), "ships", "there is no ship"));
    }
    let ships = ships
        .iter()
        .map(|raw| ship(source, raw, &routes, start))
        .collect::<Checked<Vec<_>>>()?;
    for (index, ship) in ships.iter().enumerate() {
        if ships[..index].iter().any(|earlier| earlier.name == ship.name) {
            let name = &raw.ships.get_ref()[index].name;
            return Err(source.error(name.span(), "name", "another ship has this name"));
        }
    }
    let optional = |field, value, default, range| or(source, field, value, default, range);
    Ok(Scenario {
        name: raw.name.clone(),
        seed: raw.seed.unwrap_or(1),
        start,
        days: optional("days", &raw.days, 30.0, 0.01..=LATEST_DAY)?,
        timing: Timing {
            interval_s: optional("interval_s", &raw.interval_s, 1.0, 0.1..=10.0)?,
            position_interval_s: optional(
                "position_interval_s",
                &raw.position_interval_s,
                1.0,
                0.1..=10.0,
            )?,
            moored_interval_s: optional(
                "moored_interval_s",
                &raw.moored_interval_s,
                60.0,
                0.1..=600.0,
            )?,
        },
        faults: LineFaults {
            wrong_checksum: optional(
                "wrong_checksum_rate",
                &raw.wrong_checksum_rate,
                1e-4,
                0.0..=0.5,
            )?,
            garbage: optional("garbage_rate", &raw.garbage_rate, 5e-5, 0.0..=0.5)?,
        },
        storms: raw.storms.iter().map(|storm| {
            Ok(Storm {
                day: number(source, "storms.day", &storm.day, 0.0..=LATEST_DAY)?,
                hours: number(source, "storms.hours", &storm.hours, 0.1..=240.0)?,
                strength_nt: number(source, "storms.strength_nt", &storm.strength_nt, 0.0..=5e3)?,
            })
        })
        .collect::<Checked<Vec<_>>>()?,
        anomalies: raw.anomalies.iter().map(|anomaly| {
            Ok(Anomaly {
                name: anomaly.name.clone(),
                position: position(source, &anomaly.lat, &anomaly.lon)?,
                radius_nm: number(source, "anomalies.radius_nm", &anomaly.radius_nm, 0.5..=100.0)?,
                field_nt: vector(source, "anomalies.field_nt", &anomaly.field_nt, -20e3..=20e3)?,
            })
        })
        .collect::<Checked<Vec<_>>>()?,
        ships,
    })
}

fn start(source: &Source<'_>, raw: &RawScenario) -> Checked<Timestamp> {
    let Some(text) = &raw.start else {
        return Ok(Timestamp::parse("2026-01-01T00:00:00Z").expect("this is RFC 3339"));
    };
    let start = Timestamp::parse(text.get_ref())
        .map_err(|error| source.error(text.span(), "start", error.to_string()))?;
    match Chart::new(start) {
        Ok(_) => Ok(start),
        Err(error) => Err(source.error(text.span(), "start", error.to_string())),
    }
}

fn route(
    source: &Source<'_>,
    field: &str,
    raw: &toml::Spanned<Vec<RawPoint>>,
) -> Checked<Arc<[RoutePoint]>> {
    let points = raw
        .get_ref()
        .iter()
        .map(|point| {
            Ok(RoutePoint {
                position: position(source, &point.lat, &point.lon)?,
                port: point.port.clone(),
                stay_h: or(source, "stay_h", &point.stay_h, 24.0, 0.0..=2000.0)?,
                wait_h: or(source, "wait_h", &point.wait_h, 0.0, 0.0..=2000.0)?,
                wait_nm: or(source, "wait_nm", &point.wait_nm, 12.0, 1.0..=200.0)?,
            })
        })
        .collect::<Checked<Vec<_>>>()?;
    let [first, .., last] = points.as_slice() else {
        return Err(source.error(raw.span(), field, "a route needs two points or more"));
    };
    if first.port.is_none() || last.port.is_none() {
        return Err(source.error(raw.span(), field, "the first and the last point must be ports"));
    }
    Ok(points.into())
}

fn ship(
    source: &Source<'_>,
    raw: &RawShip,
    routes: &Routes,
    start: Timestamp,
) -> Checked<ShipPlan> {
    let name = raw.name.get_ref().trim();
    if name.is_empty() {
        return Err(source.error(raw.name.span(), "name", "a ship needs a name"));
    }
    let Some(route) = routes.get(raw.route.get_ref()) else {
        let problem = format!("there is no route {:?}", raw.route.get_ref());
        return Err(source.error(raw.route.span(), "route", problem));
    };
    let start_point = raw.start_point.as_ref().map_or(0, |point| *point.get_ref());
    if start_point >= route.len() {
        let span = raw.start_point.as_ref().map_or(raw.route.span(), toml::Spanned::span);
        let problem = format!("{start_point} is not a point of a route of {}", route.len());
        return Err(source.error(span, "start_point", problem));
    }
    let magnetism = Magnetism {
        b_nt: vector(source, "magnetism.b_nt", &raw.magnetism.get_ref().b_nt, PERMANENT_NT)?,
        chi: matrix(source, "magnetism.chi", &raw.magnetism.get_ref().chi)?,
    };
    can_be_steered_by(source, raw.magnetism.span(), "magnetism", &magnetism, route, start)?;
    let optional = |field, value, default, range| or(source, field, value, default, range);
    let gyro = raw.gyro.as_ref();
    let gyro_field = |of: fn(&super::raw::RawGyro) -> &Option<Number>, field, default, range| {
        gyro.map_or(Ok(default), |raw| or(source, field, of(raw), default, range))
    };
    let mut events = Vec::new();
    for raw in &raw.events {
        let event = event(source, raw.span(), raw.get_ref())?;
        if let Event::Lightning { b_nt, .. } = &event {
            let struck = Magnetism { b_nt: *b_nt, chi: [[0.0; 3]; 3] };
            let after = magnetism.plus(&struck, 1.0);
            can_be_steered_by(source, raw.span(), "events", &after, route, start)?;
        }
        if let Event::Cargo { magnetism: cargo, .. } = &event {
            let loaded = magnetism.plus(cargo, 1.0);
            can_be_steered_by(source, raw.span(), "events", &loaded, route, start)?;
        }
        events.push(event);
    }
    Ok(ShipPlan {
        name: name.to_owned(),
        imo_number: raw.imo_number.clone(),
        call_sign: raw.call_sign.clone(),
        flag: raw.flag.clone(),
        route: Arc::clone(route),
        start_point,
        outbound: !raw.homeward.unwrap_or(false),
        speed_kn: number(source, "speed_kn", &raw.speed_kn, 5.0..=40.0)?,
        turn_deg_min: optional("turn_deg_min", &raw.turn_deg_min, 12.0, 2.0..=120.0)?,
        sea: optional("sea", &raw.sea, 1.0, 0.0..=4.0)?,
        list_deg: optional("list_deg", &raw.list_deg, 0.0, -10.0..=10.0)?,
        traffic_per_day: optional("traffic_per_day", &raw.traffic_per_day, 8.0, 0.0..=60.0)?,
        magnetism,
        alignment_deg: optional("alignment_deg", &raw.alignment_deg, 0.0, -10.0..=10.0)?,
        gaussian_error_deg: optional(
            "gaussian_error_deg",
            &raw.gaussian_error_deg,
            1.5,
            -10.0..=10.0,
        )?,
        gyro: GyroPlan {
            constant_deg: gyro_field(|g| &g.constant_deg, "constant_deg", 0.0, -5.0..=5.0)?,
            schuler_deg: gyro_field(|g| &g.schuler_deg, "schuler_deg", 0.35, 0.0..=5.0)?,
            slow_deg: gyro_field(|g| &g.slow_deg, "slow_deg", 0.3, 0.0..=5.0)?,
            speed_error_left: gyro_field(
                |g| &g.speed_error_left,
                "speed_error_left",
                0.1,
                -1.0..=1.0,
            )?,
        },
        satellite: raw
            .satellite
            .as_ref()
            .map(|raw| {
                Ok(SatellitePlan {
                    alignment_deg: optional("alignment_deg", &raw.alignment_deg, 0.0, -5.0..=5.0)?,
                    dropouts_per_day: optional(
                        "dropouts_per_day",
                        &raw.dropouts_per_day,
                        4.0,
                        0.0..=500.0,
                    )?,
                })
            })
            .transpose()?,
        events,
    })
}

fn event(source: &Source<'_>, span: Range<usize>, raw: &RawEvent) -> Checked<Event> {
    let missing = |field: &str| {
        let problem = format!("a {} needs it", raw.kind.get_ref());
        source.error(span.clone(), &format!("events.{field}"), problem)
    };
    let day = |field: &str, value: &Option<Number>| {
        let value = value.as_ref().ok_or_else(|| missing(field))?;
        number(source, field, value, 0.0..=LATEST_DAY)
    };
    let from_to = || {
        let (from_day, to_day) = (day("from_day", &raw.from_day)?, day("to_day", &raw.to_day)?);
        if from_day < to_day {
            return Ok((from_day, to_day));
        }
        Err(source.error(span.clone(), "events.to_day", "it must come after from_day"))
    };
    let b_nt = || match &raw.b_nt {
        Some(b_nt) => vector(source, "b_nt", b_nt, PERMANENT_NT),
        None => Ok([0.0; 3]),
    };
    match raw.kind.get_ref().as_str() {
        "lightning" => Ok(Event::Lightning {
            day: day("day", &raw.day)?,
            b_nt: b_nt()?,
            returning: or(source, "returning", &raw.returning, 0.0, 0.0..=1.0)?,
            return_days: or(source, "return_days", &raw.return_days, 30.0, 0.01..=1000.0)?,
        }),
        "cargo" => {
            let (from_day, to_day) = from_to()?;
            let chi = match &raw.chi {
                Some(chi) => matrix(source, "chi", chi)?,
                None => [[0.0; 3]; 3],
            };
            let magnetism = Magnetism { b_nt: b_nt()?, chi };
            Ok(Event::Cargo { from_day, to_day, magnetism })
        }
        "gyro_fault" => {
            let (from_day, to_day) = from_to()?;
            let drift = &raw.drift_deg_per_h;
            Ok(Event::GyroFault {
                from_day,
                to_day,
                offset_deg: or(source, "offset_deg", &raw.offset_deg, 0.0, -180.0..=180.0)?,
                drift_deg_per_h: or(source, "drift_deg_per_h", drift, 0.0, -60.0..=60.0)?,
            })
        }
        other => Err(source.error(
            raw.kind.span(),
            "events.kind",
            format!("{other:?} is none of lightning, cargo, gyro_fault"),
        )),
    }
}

/// Refuses a ship whose compass would point nowhere on some heading of her route.
fn can_be_steered_by(
    source: &Source<'_>,
    span: Range<usize>,
    field: &str,
    magnetism: &Magnetism,
    route: &[RoutePoint],
    start: Timestamp,
) -> Checked<()> {
    let mut chart = Chart::new(start).expect("the start was checked when it was read");
    for point in route {
        let earth = chart.field(point.position, start);
        let here = Field { h_nt: earth.h_nt(), z_nt: earth.z_nt };
        let force = magnetism.least_directive_force(here);
        if force < LEAST_DIRECTIVE_FORCE {
            let (lat, lon) = (point.position.lat_deg(), point.position.lon_deg());
            let problem = format!(
                "at {lat}, {lon} the force on the card falls to {force:.2} of the earth's, \
                 less than {LEAST_DIRECTIVE_FORCE}"
            );
            return Err(source.error(span, field, problem));
        }
    }
    Ok(())
}

fn position(source: &Source<'_>, lat: &Number, lon: &Number) -> Checked<Position> {
    // Polar waters are left out: a rhumb line and a magnetic compass end there.
    let lat = number(source, "lat", lat, -78.0..=78.0)?;
    let span = lon.span();
    let lon = number(source, "lon", lon, -180.0..=180.0)?;
    Position::new(lat, lon).map_err(|error| source.error(span, "lon", error.to_string()))
}

fn vector(
    source: &Source<'_>,
    field: &str,
    raw: &Vector,
    range: RangeInclusive<f64>,
) -> Checked<[f64; 3]> {
    let mut vector = [0.0; 3];
    for (value, raw) in vector.iter_mut().zip(raw) {
        *value = number(source, field, raw, range.clone())?;
    }
    Ok(vector)
}

fn matrix(source: &Source<'_>, field: &str, raw: &Matrix) -> Checked<[[f64; 3]; 3]> {
    let mut matrix = [[0.0; 3]; 3];
    for (row, raw) in matrix.iter_mut().zip(raw) {
        *row = vector(source, field, raw, INDUCED)?;
    }
    Ok(matrix)
}

fn or(
    source: &Source<'_>,
    field: &str,
    value: &Option<Number>,
    default: f64,
    range: RangeInclusive<f64>,
) -> Checked<f64> {
    value.as_ref().map_or(Ok(default), |value| number(source, field, value, range))
}

/// NaN and infinity lie in no range.
fn number(
    source: &Source<'_>,
    field: &str,
    value: &Number,
    range: RangeInclusive<f64>,
) -> Checked<f64> {
    let found = *value.get_ref();
    if range.contains(&found) {
        return Ok(found);
    }
    let problem = format!("{found} is not within {} to {}", range.start(), range.end());
    Err(source.error(value.span(), field, problem))
}
