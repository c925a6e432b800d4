//! Converts a ship's part of the file to its plan.

use super::error::Source;
use super::event::event;
use super::raw::{Number, RawCompass, RawGyro, RawSatellite, RawShip};
use super::values::{Checked, PERMANENT_NT};
use super::{DisplayPlan, Event, GyroPlan, RoutePoint, SatellitePlan, ShipPlan};
use crate::earth::Chart;
use crate::poisson::{Field, Magnetism};
use binnacle_compass::time::Timestamp;
use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use std::sync::Arc;
use toml::Spanned;

pub(super) type Routes = BTreeMap<String, Arc<[RoutePoint]>>;

/// The least directive force, as a fraction of the earth's, with which a
/// compass can still be used.
const MIN_DIRECTIVE_FORCE: f64 = 0.2;

/// Limits of the angle between an instrument and the ship's axis.
const ALIGNMENTS_DEG: RangeInclusive<f64> = -30.0..=30.0;

pub(super) fn ship(
    source: &Source<'_>,
    raw: &RawShip,
    routes: &Routes,
    start: Timestamp,
) -> Checked<ShipPlan> {
    let name = raw.name.get_ref().trim();
    if name.is_empty() {
        return Err(source.error(raw.name.span(), "name", "a ship needs a name"));
    }
    let (route, start_point) = route(source, raw, routes)?;
    let waters = Waters {
        source,
        route: &route,
        start,
    };
    let iron = raw.magnetism.get_ref();
    let magnetism = Magnetism {
        b_nt: source.vector("magnetism.b_nt", &iron.b_nt, PERMANENT_NT)?,
        chi: source.matrix("magnetism.chi", &iron.chi)?,
    };
    waters.check_directive_force(&magnetism, raw.magnetism.span(), "magnetism")?;
    let gaussian = raw.gaussian_error_deg.as_ref();
    Ok(ShipPlan {
        name: name.to_owned(),
        imo_number: raw.imo_number.clone(),
        call_sign: raw.call_sign.clone(),
        flag: raw.flag.clone(),
        start_point,
        outbound: !raw.homeward.unwrap_or(false),
        speed_kn: source.number("speed_kn", &raw.speed_kn, 5.0..=40.0)?,
        turn_deg_min: source.or("turn_deg_min", raw.turn_deg_min.as_ref(), 12.0, 2.0..=120.0)?,
        sea: source.or("sea", raw.sea.as_ref(), 1.0, 0.0..=4.0)?,
        list_deg: source.or("list_deg", raw.list_deg.as_ref(), 0.0, -10.0..=10.0)?,
        traffic_per_day: source.or(
            "traffic_per_day",
            raw.traffic_per_day.as_ref(),
            8.0,
            0.0..=60.0,
        )?,
        alignment_deg: source.or(
            "alignment_deg",
            raw.alignment_deg.as_ref(),
            0.0,
            ALIGNMENTS_DEG,
        )?,
        compass: compass(source, raw.compass.as_ref())?,
        gaussian_error_deg: source.or("gaussian_error_deg", gaussian, 1.5, -10.0..=10.0)?,
        gyro: gyro(source, raw.gyro.as_ref())?,
        satellite: raw
            .satellite
            .as_ref()
            .map(|raw| satellite(source, raw))
            .transpose()?,
        events: events(source, raw, &magnetism, &waters)?,
        magnetism,
        route,
    })
}

fn route(
    source: &Source<'_>,
    raw: &RawShip,
    routes: &Routes,
) -> Checked<(Arc<[RoutePoint]>, usize)> {
    let Some(route) = routes.get(raw.route.get_ref()) else {
        let problem = format!("there is no route {:?}", raw.route.get_ref());
        return Err(source.error(raw.route.span(), "route", problem));
    };
    let Some(start) = &raw.start_point else {
        return Ok((Arc::clone(route), 0));
    };
    let start_point = *start.get_ref();
    if start_point < route.len() {
        return Ok((Arc::clone(route), start_point));
    }
    let problem = format!("{start_point} is not within 0 to {}", route.len() - 1);
    Err(source.error(start.span(), "start_point", problem))
}

fn gyro(source: &Source<'_>, raw: Option<&RawGyro>) -> Checked<GyroPlan> {
    let none = RawGyro::default();
    let raw = raw.unwrap_or(&none);
    let left = raw.speed_error_left.as_ref();
    Ok(GyroPlan {
        constant_deg: source.or("constant_deg", raw.constant_deg.as_ref(), 0.0, -5.0..=5.0)?,
        schuler_deg: source.or("schuler_deg", raw.schuler_deg.as_ref(), 0.35, 0.0..=5.0)?,
        slow_deg: source.or("slow_deg", raw.slow_deg.as_ref(), 0.3, 0.0..=5.0)?,
        speed_error_left: source.or("speed_error_left", left, 0.1, -1.0..=1.0)?,
        display: display(source, raw.lag_s.as_ref(), raw.resolution_deg.as_ref())?,
    })
}

fn satellite(source: &Source<'_>, raw: &RawSatellite) -> Checked<SatellitePlan> {
    let dropouts = raw.dropouts_per_day.as_ref();
    Ok(SatellitePlan {
        alignment_deg: source.or(
            "alignment_deg",
            raw.alignment_deg.as_ref(),
            0.0,
            ALIGNMENTS_DEG,
        )?,
        dropouts_per_day: source.or("dropouts_per_day", dropouts, 4.0, 0.0..=500.0)?,
        talker: talker(source, raw.talker.as_ref())?,
        display: display(source, raw.lag_s.as_ref(), raw.resolution_deg.as_ref())?,
    })
}

fn compass(source: &Source<'_>, raw: Option<&RawCompass>) -> Checked<DisplayPlan> {
    let none = RawCompass::default();
    let raw = raw.unwrap_or(&none);
    display(source, raw.lag_s.as_ref(), raw.resolution_deg.as_ref())
}

fn display(
    source: &Source<'_>,
    lag_s: Option<&Number>,
    resolution_deg: Option<&Number>,
) -> Checked<DisplayPlan> {
    Ok(DisplayPlan {
        lag_s: source.or("lag_s", lag_s, 0.0, 0.0..=300.0)?,
        resolution_deg: source.or("resolution_deg", resolution_deg, 0.0, 0.0..=5.0)?,
    })
}

fn talker(source: &Source<'_>, raw: Option<&Spanned<String>>) -> Checked<[u8; 2]> {
    let Some(raw) = raw else {
        return Ok(*b"GP");
    };
    match raw.get_ref().as_bytes() {
        &[first, second] if first.is_ascii_uppercase() && second.is_ascii_uppercase() => {
            Ok([first, second])
        }
        _ => {
            let problem = format!("{:?} is not two capital letters", raw.get_ref());
            Err(source.error(raw.span(), "talker", problem))
        }
    }
}

fn events(
    source: &Source<'_>,
    raw: &RawShip,
    magnetism: &Magnetism,
    waters: &Waters<'_>,
) -> Checked<Vec<Event>> {
    let mut events = Vec::new();
    for raw in &raw.events {
        let event = event(source, raw.span(), raw.get_ref())?;
        let more = match &event {
            Event::Lightning { b_nt, .. } => Magnetism {
                b_nt: *b_nt,
                chi: [[0.0; 3]; 3],
            },
            Event::Cargo { magnetism, .. } => *magnetism,
            Event::GyroFault { .. } => Magnetism {
                b_nt: [0.0; 3],
                chi: [[0.0; 3]; 3],
            },
        };
        waters.check_directive_force(&magnetism.plus(&more, 1.0), raw.span(), "events")?;
        events.push(event);
    }
    Ok(events)
}

/// The waters of a ship's route.
struct Waters<'a> {
    source: &'a Source<'a>,
    route: &'a [RoutePoint],
    start: Timestamp,
}

impl Waters<'_> {
    /// Refuses a magnetism that leaves the compass without directive force on
    /// some heading.
    fn check_directive_force(
        &self,
        magnetism: &Magnetism,
        span: Range<usize>,
        field: &str,
    ) -> Checked<()> {
        let mut chart = Chart::new(self.start).expect("the start was checked when it was read");
        for point in self.route {
            let earth = chart.field(point.position, self.start);
            let here = Field {
                h_nt: earth.h_nt(),
                z_nt: earth.z_nt,
            };
            let force = magnetism.least_directive_force(here);
            if force < MIN_DIRECTIVE_FORCE {
                let (lat, lon) = (point.position.lat_deg(), point.position.lon_deg());
                let problem = format!(
                    "at {lat}, {lon} the force on the card falls to {force:.2} of the earth's, \
                     less than {MIN_DIRECTIVE_FORCE}"
                );
                return Err(self.source.error(span, field, problem));
            }
        }
        Ok(())
    }
}
