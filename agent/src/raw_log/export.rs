//! Export of the raw log as a table, also while the agent writes it.

use super::block::{BLOCK_BYTES, block_at, number_at};
use super::second::Second;
use anyhow::Context;
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// Time range of an export.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Span {
    /// First time, inclusive.
    pub(crate) from: Option<Timestamp>,
    /// Last time, exclusive.
    pub(crate) until: Option<Timestamp>,
}

impl Span {
    fn contains(self, time: Timestamp) -> bool {
        self.from.is_none_or(|from| time >= from) && self.until.is_none_or(|until| time < until)
    }
}

const COLUMNS: [&str; 9] = [
    "time",
    "lat",
    "lon",
    "compass_deg",
    "gyro_deg",
    "satellite_deg",
    "sog_kn",
    "rate_of_turn_deg_min",
    "roll_deg",
];

/// Writes the seconds of a raw log as CSV, in the order in which they were recorded. Returns their
/// number.
///
/// # Errors
/// Fails when there is no raw log, or the table cannot be written.
pub(crate) fn export(raw_log: &Path, span: Span, out: &mut dyn Write) -> anyhow::Result<u64> {
    let name = raw_log.display().to_string();
    let mut file = File::open(raw_log).with_context(|| format!("{name}: there is no raw log"))?;
    let slots = file.metadata().context(name.clone())?.len() / BLOCK_BYTES;
    let mut order = Vec::new();
    for slot in 0..slots {
        if let Some(number) = number_at(&mut file, slot).context(name.clone())? {
            order.push((number, slot));
        }
    }
    order.sort_unstable();
    let mut table = csv::Writer::from_writer(out);
    table.write_record(COLUMNS)?;
    let mut written = 0;
    for (number, slot) in order {
        let block = block_at(&mut file, slot).context(name.clone())?;
        // Overwritten meanwhile, or never finished.
        let Some(block) = block.filter(|block| block.number == number) else {
            continue;
        };
        let wanted = block.seconds.iter().filter(|s| span.contains(s.time));
        for second in wanted {
            table.write_record(row(second))?;
            written += 1;
        }
    }
    table.flush()?;
    Ok(written)
}

fn row(second: &Second) -> [String; 9] {
    let number = |value: Option<f64>, places: usize| {
        value.map_or(String::new(), |value| format!("{value:.places$}"))
    };
    [
        second.time.to_string(),
        number(second.position.map(Position::lat_deg), 7),
        number(second.position.map(Position::lon_deg), 7),
        number(second.compass.map(CompassHeading::degrees), 2),
        number(second.gyro.map(TrueHeading::degrees), 2),
        number(second.satellite.map(TrueHeading::degrees), 2),
        number(second.sog_kn, 2),
        number(second.rate_of_turn_deg_min, 1),
        number(second.roll_deg, 2),
    ]
}
