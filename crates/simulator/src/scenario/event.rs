//! Reads a ship's events.

use super::Event;
use super::error::Source;
use super::raw::{Number, RawEvent};
use super::values::{Checked, PERMANENT_NT};
use crate::poisson::Magnetism;
use std::ops::Range;

/// The last day of a scenario, after ten years.
pub(super) const MAX_DAY: f64 = 3650.0;

pub(super) fn event(source: &Source<'_>, span: Range<usize>, raw: &RawEvent) -> Checked<Event> {
    let b_nt = match &raw.b_nt {
        Some(b_nt) => source.vector("b_nt", b_nt, PERMANENT_NT)?,
        None => [0.0; 3],
    };
    let reader = EventReader { source, span, raw };
    match raw.kind.get_ref().as_str() {
        "lightning" => Ok(Event::Lightning {
            day: reader.day("day", raw.day.as_ref())?,
            b_nt,
            returning: source.or("returning", raw.returning.as_ref(), 0.0, 0.0..=1.0)?,
            return_days: source.or("return_days", raw.return_days.as_ref(), 30.0, 0.01..=1000.0)?,
        }),
        "cargo" => {
            let (from_day, to_day) = reader.span_of_days()?;
            let chi = match &raw.chi {
                Some(chi) => source.matrix("chi", chi)?,
                None => [[0.0; 3]; 3],
            };
            let magnetism = Magnetism { b_nt, chi };
            Ok(Event::Cargo {
                from_day,
                to_day,
                magnetism,
            })
        }
        "gyro_fault" => {
            let (from_day, to_day) = reader.span_of_days()?;
            let (offset, drift) = (raw.offset_deg.as_ref(), raw.drift_deg_per_h.as_ref());
            Ok(Event::GyroFault {
                from_day,
                to_day,
                offset_deg: source.or("offset_deg", offset, 0.0, -180.0..=180.0)?,
                drift_deg_per_h: source.or("drift_deg_per_h", drift, 0.0, -60.0..=60.0)?,
            })
        }
        other => Err(source.error(
            raw.kind.span(),
            "kind",
            format!("{other:?} is not one of lightning, cargo, gyro_fault"),
        )),
    }
}

struct EventReader<'a> {
    source: &'a Source<'a>,
    span: Range<usize>,
    raw: &'a RawEvent,
}

impl EventReader<'_> {
    fn day(&self, field: &str, value: Option<&Number>) -> Checked<f64> {
        let Some(value) = value else {
            let problem = format!("missing in an event of kind {:?}", self.raw.kind.get_ref());
            return Err(self.source.error(self.span.clone(), field, problem));
        };
        self.source.number(field, value, 0.0..=MAX_DAY)
    }

    fn span_of_days(&self) -> Checked<(f64, f64)> {
        let from_day = self.day("from_day", self.raw.from_day.as_ref())?;
        let to_day = self.day("to_day", self.raw.to_day.as_ref())?;
        if from_day < to_day {
            return Ok((from_day, to_day));
        }
        let problem = format!("{to_day} is not after from_day, {from_day}");
        Err(self.source.error(self.span.clone(), "to_day", problem))
    }
}
