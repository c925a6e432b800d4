//! Converts the raw scenario of a file to a checked one.

use super::error::Source;
use super::event::MAX_DAY;
use super::raw::{RawAnomaly, RawPoint, RawScenario, RawShip, RawStorm};
use super::ship::{Routes, ship};
use super::values::Checked;
use super::{Anomaly, LineFaults, RoutePoint, Scenario, ShipPlan, Storm, Timing};
use crate::earth::Chart;
use binnacle_compass::time::Timestamp;
use std::sync::Arc;
use toml::Spanned;

pub(super) fn scenario(source: &Source<'_>, raw: &RawScenario) -> Checked<Scenario> {
    let start = start(source, raw.start.as_ref())?;
    let mut routes = Routes::new();
    for (name, points) in &raw.routes {
        let field = format!("routes.{name}");
        routes.insert(name.clone(), route(source, &field, points)?);
    }
    Ok(Scenario {
        name: raw.name.clone(),
        seed: raw.seed.unwrap_or(1),
        start,
        days: source.or("days", raw.days.as_ref(), 30.0, 0.01..=MAX_DAY)?,
        timing: timing(source, raw)?,
        faults: faults(source, raw)?,
        storms: raw
            .storms
            .iter()
            .map(|raw| storm(source, raw))
            .collect::<Checked<_>>()?,
        anomalies: raw
            .anomalies
            .iter()
            .map(|raw| anomaly(source, raw))
            .collect::<Checked<_>>()?,
        ships: ships(source, &raw.ships, &routes, start)?,
    })
}

fn start(source: &Source<'_>, text: Option<&Spanned<String>>) -> Checked<Timestamp> {
    let Some(text) = text else {
        return Ok(Timestamp::parse("2026-01-01T00:00:00Z").expect("this is RFC 3339"));
    };
    let problem = |problem: String| source.error(text.span(), "start", problem);
    let start = Timestamp::parse(text.get_ref()).map_err(|error| problem(error.to_string()))?;
    match Chart::new(start) {
        Ok(_) => Ok(start),
        Err(error) => Err(problem(error.to_string())),
    }
}

fn timing(source: &Source<'_>, raw: &RawScenario) -> Checked<Timing> {
    let interval_s = source.or("interval_s", raw.interval_s.as_ref(), 1.0, 0.1..=10.0)?;
    let position = raw.position_interval_s.as_ref();
    let moored = raw.moored_interval_s.as_ref();
    Ok(Timing {
        interval_s,
        position_interval_s: source.or("position_interval_s", position, interval_s, 0.1..=10.0)?,
        moored_interval_s: source.or("moored_interval_s", moored, 60.0, 0.1..=600.0)?,
    })
}

fn faults(source: &Source<'_>, raw: &RawScenario) -> Checked<LineFaults> {
    let wrong = raw.wrong_checksum_rate.as_ref();
    let garbage = raw.garbage_rate.as_ref();
    Ok(LineFaults {
        wrong_checksum: source.or("wrong_checksum_rate", wrong, 1e-4, 0.0..=0.5)?,
        garbage: source.or("garbage_rate", garbage, 5e-5, 0.0..=0.5)?,
    })
}

fn storm(source: &Source<'_>, raw: &RawStorm) -> Checked<Storm> {
    Ok(Storm {
        day: source.number("day", &raw.day, 0.0..=MAX_DAY)?,
        hours: source.number("hours", &raw.hours, 0.1..=240.0)?,
        strength_nt: source.number("strength_nt", &raw.strength_nt, 0.0..=5_000.0)?,
    })
}

fn anomaly(source: &Source<'_>, raw: &RawAnomaly) -> Checked<Anomaly> {
    Ok(Anomaly {
        name: raw.name.clone(),
        position: source.position(&raw.lat, &raw.lon)?,
        radius_nm: source.number("radius_nm", &raw.radius_nm, 0.5..=100.0)?,
        field_nt: source.vector("field_nt", &raw.field_nt, -20_000.0..=20_000.0)?,
    })
}

fn route(
    source: &Source<'_>,
    field: &str,
    raw: &Spanned<Vec<RawPoint>>,
) -> Checked<Arc<[RoutePoint]>> {
    let points = raw
        .get_ref()
        .iter()
        .map(|raw| point(source, raw))
        .collect::<Checked<Vec<_>>>()?;
    let [first, .., last] = points.as_slice() else {
        return Err(source.error(raw.span(), field, "a route needs at least two points"));
    };
    if first.port.is_none() || last.port.is_none() {
        return Err(source.error(
            raw.span(),
            field,
            "the first and the last point must be ports",
        ));
    }
    Ok(points.into())
}

fn point(source: &Source<'_>, raw: &RawPoint) -> Checked<RoutePoint> {
    Ok(RoutePoint {
        position: source.position(&raw.lat, &raw.lon)?,
        port: raw.port.clone(),
        stay_h: source.or("stay_h", raw.stay_h.as_ref(), 24.0, 0.0..=2000.0)?,
        wait_h: source.or("wait_h", raw.wait_h.as_ref(), 0.0, 0.0..=2000.0)?,
        wait_nm: source.or("wait_nm", raw.wait_nm.as_ref(), 12.0, 1.0..=200.0)?,
    })
}

fn ships(
    source: &Source<'_>,
    raw: &Spanned<Vec<RawShip>>,
    routes: &Routes,
    start: Timestamp,
) -> Checked<Vec<ShipPlan>> {
    let mut ships: Vec<ShipPlan> = Vec::new();
    for raw in raw.get_ref() {
        let next = ship(source, raw, routes, start)?;
        if ships.iter().any(|ship| ship.name == next.name) {
            return Err(source.error(
                raw.name.span(),
                "name",
                "the name is already taken by another ship",
            ));
        }
        ships.push(next);
    }
    if ships.is_empty() {
        return Err(source.error(raw.span(), "ships", "at least one ship is required"));
    }
    Ok(ships)
}
