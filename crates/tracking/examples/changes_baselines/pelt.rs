//! PELT, by the Python package `ruptures`: hours go out and alarms come back as CSV.

use crate::ship::Ship;
use std::path::Path;
use std::process::Command;

const PROGRAM: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/changes/pelt.py");

/// Alarms of one fleet, ship by ship.
pub(crate) type Alarms = Vec<Vec<usize>>;

/// The penalty that was set on the first fleet, and the alarms of all fleets.
pub(crate) fn alarms(python: &str, fleets: &[&[Ship]]) -> (f64, Vec<Alarms>) {
    let folder = std::env::temp_dir().join(format!("changes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    write(&folder.join("hours.csv"), fleets);
    let allowed = crate::FALSE_ALARMS_A_YEAR * fleets[0].iter().map(Ship::years).sum::<f64>();
    let status = Command::new(python)
        .args([PROGRAM, folder.to_str().unwrap(), &allowed.to_string()])
        .args([crate::score::UNHEARD_S.to_string()])
        .status()
        .expect("a Python to run");
    assert!(status.success(), "{PROGRAM} failed");
    let mut found: Vec<Alarms> = fleets.iter().map(|f| vec![Vec::new(); f.len()]).collect();
    let mut reader = csv::Reader::from_path(folder.join("alarms.csv")).unwrap();
    for record in reader.deserialize() {
        let (fleet, ship, row): (usize, usize, usize) = record.unwrap();
        found[fleet][ship].push(row);
    }
    let penalty = std::fs::read_to_string(folder.join("penalty")).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    (penalty.trim().parse().unwrap(), found)
}

fn write(path: &Path, fleets: &[&[Ship]]) {
    let mut writer = csv::Writer::from_path(path).unwrap();
    let head = ["fleet", "ship", "row", "time_s", "watched"];
    let values = ["residual", "by_bx", "by_by"];
    writer.write_record(head.iter().chain(&values)).unwrap();
    for (fleet, ships) in fleets.iter().enumerate() {
        for (number, ship) in ships.iter().enumerate() {
            let usual = ship.usual_hour_deg();
            for hour in &ship.hours {
                let time_s = ship.rows[hour.last].time.micros() / 1_000_000;
                let watched = u8::from(hour.last >= ship.watched);
                let [by_bx, by_by] = hour.deg_per_ut;
                let residual = hour.mean_deg / usual;
                let place = (fleet, number, hour.last, time_s, watched);
                writer.serialize((place, residual, by_bx, by_by)).unwrap();
            }
        }
    }
    writer.flush().unwrap();
}
