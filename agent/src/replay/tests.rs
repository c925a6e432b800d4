//! Recordings replayed together.

use super::*;
use std::fmt::Write;
use std::path::Path;
use tempfile::TempDir;

/// Seconds of a voyage on one heading, and the first of them.
const SECONDS: i64 = 2_400;
const NOON: &str = "2026-01-02T12:00:00Z";

fn at(text: &str) -> Timestamp {
    Timestamp::parse(text).unwrap()
}

fn sentence(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}")
}

/// Time of day and date of a second, `%H%M%S` and `%d%m%y`.
fn clock(second: i64) -> (String, String) {
    let time = at(NOON).plus_seconds(second as f64).to_chrono();
    (
        time.format("%H%M%S").to_string(),
        time.format("%d%m%y").to_string(),
    )
}

fn rmc(second: i64) -> String {
    rmc_off(second, 0.0)
}

/// A fix some minutes of latitude north of where the ship is.
fn rmc_off(second: i64, north_min: f64) -> String {
    let (_, date) = clock(second);
    rmc_on(&date, second, north_min)
}

/// Fix of a date, some minutes of latitude north of where the ship is.
fn rmc_on(date: &str, second: i64, north_min: f64) -> String {
    let (time, _) = clock(second);
    let miles = 12.0 * second as f64 / 3_600.0;
    let (sin, cos) = 47.0_f64.to_radians().sin_cos();
    let north = 30.0 + miles * cos + north_min;
    let west = 15.0 - miles * sin / 43.5_f64.to_radians().cos();
    sentence(&format!(
        "GPRMC,{time},A,43{north:07.4},N,005{west:07.4},W,12.0,47.0,{date},,"
    ))
}

/// The compass has noise of its own, part of which lasts for twenty seconds.
fn compass(second: i64) -> String {
    let sign = if second % 2 == 0 { 1.0 } else { -1.0 };
    let noise = 0.2 * (share(second / 20) - 0.5 + sign * share(second / 2));
    sentence(&format!("HCHDG,{:.3},,,,", 42.5 + yaw(second) + noise))
}

/// A share of one that looks random.
fn share(number: i64) -> f64 {
    let hash = (number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    ((hash ^ (hash >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40) as f64 / (1_u64 << 24) as f64
}

fn yaw(second: i64) -> f64 {
    0.8 * (std::f64::consts::TAU * second as f64 / 10.0).sin()
}

fn gyro(second: i64) -> String {
    sentence(&format!("HETHS,{:.3},A", 45.0 + yaw(second)))
}

/// Writes a recording of one line for each second.
fn record(folder: &TempDir, name: &str, line: impl Fn(i64) -> String) -> PathBuf {
    let path = folder.path().join(name);
    let mut text = String::new();
    for second in 0..SECONDS {
        writeln!(text, "{}", line(second)).unwrap();
    }
    std::fs::write(&path, text).unwrap();
    path
}

/// A line with the time of the logger.
fn stamped(second: i64, hours_ahead: i64, content: &str) -> String {
    let time = at(NOON).plus_seconds((second + 3_600 * hours_ahead) as f64);
    format!(
        "{},{content}",
        time.to_chrono().format("%m/%d/%Y,%H:%M:%S%.3f")
    )
}

fn run(files: &[PathBuf]) -> anyhow::Result<Replayed> {
    replay(&Recordings {
        files,
        roles: &RolesConfig::usual(),
        silence: &SilenceConfig::default(),
        roll_overs: 0,
        now: at("2026-02-01T00:00:00Z"),
    })
}

fn all(folder: &TempDir, name: &str) -> PathBuf {
    record(folder, name, |second| {
        [rmc(second), compass(second), gyro(second)].join("\n")
    })
}

#[test]
fn samples_under_interference_are_marked_in_the_table() {
    let folder = TempDir::new().unwrap();
    let spoofed = record(&folder, "spoofed", |second| {
        let north_min = if second < 1_500 { 0.0 } else { 20.0 };
        [rmc_off(second, north_min), compass(second), gyro(second)].join("\n")
    });
    let replayed = run(&[spoofed]).unwrap();
    let table = String::from_utf8(replayed.csv().unwrap()).unwrap();
    let (mut trusted, mut reckoned) = (0, 0);
    for row in table.lines().skip(1) {
        let columns: Vec<&str> = row.split(',').collect();
        let spoofed_since = at(NOON).plus_seconds(1_500.0).to_string();
        let is_spoofed = columns[0] >= spoofed_since.as_str();
        assert_eq!(columns[16], is_spoofed.to_string(), "{row}");
        *if is_spoofed {
            &mut reckoned
        } else {
            &mut trusted
        } += 1;
    }
    assert!(trusted > 0 && reckoned > 0, "{table}");
    let notes = replayed.notes.join("\n");
    assert!(
        notes.contains(&format!("{reckoned} samples under GNSS interference")),
        "{notes}"
    );
}

#[test]
fn files_of_one_instrument_each_give_the_samples_of_one_file() {
    let folder = TempDir::new().unwrap();
    let whole = run(&[all(&folder, "all.log")]).unwrap();
    assert!(!whole.samples.is_empty(), "{:?}", whole.notes);
    assert_eq!(whole.notes, Vec::<String>::new());
    for hours_ahead in [0, 2, -5] {
        let instrument = |name, sentence: fn(i64) -> String| {
            record(&folder, name, |second| {
                stamped(second, hours_ahead, &sentence(second))
            })
        };
        let files = [
            instrument("gyro.raw", gyro),
            instrument("hdg.raw", compass),
            instrument("gps.raw", rmc),
        ];
        let merged = run(&files).unwrap();
        assert_eq!(merged.samples, whole.samples, "{:?}", merged.notes);
        let is_noted = merged
            .notes
            .iter()
            .any(|note| note.contains("the times of its lines"));
        assert_eq!(is_noted, hours_ahead != 0, "{:?}", merged.notes);
    }
}

#[test]
fn a_time_of_day_is_enough_beside_a_file_with_the_date() {
    let folder = TempDir::new().unwrap();
    let whole = run(&[all(&folder, "all.log")]).unwrap();
    let timed = |second, content: String| {
        let (time, _) = clock(second);
        format!("{}:{}:{} {content}", &time[..2], &time[2..4], &time[4..])
    };
    let files = [
        record(&folder, "gps.log", rmc),
        record(&folder, "hdg.log", |second| timed(second, compass(second))),
        record(&folder, "gyro.log", |second| timed(second, gyro(second))),
    ];
    assert_eq!(run(&files).unwrap().samples, whole.samples);
}

#[test]
fn a_file_without_any_time_is_left_out_and_named() {
    let folder = TempDir::new().unwrap();
    let files = [record(&folder, "gyro.log", gyro), all(&folder, "all.log")];
    let replayed = run(&files).unwrap();
    assert!(!replayed.samples.is_empty());
    assert!(
        replayed.notes[0].contains("gyro.log: not used"),
        "{:?}",
        replayed.notes
    );
}

/// Returns the notes on a recording that gives no samples.
fn notes_of(path: &Path) -> String {
    let replayed = run(&[path.to_owned()]).unwrap();
    assert_eq!(replayed.samples, []);
    replayed.notes.join("\n")
}

#[test]
fn the_reason_for_no_samples_is_said() {
    let folder = TempDir::new().unwrap();
    let said = notes_of(&record(&folder, "a", gyro));
    assert!(said.contains("no date in the recording"), "{said}");
    assert!(
        said.contains("no compass heading in the recording (HDG, HDM)"),
        "{said}"
    );
    assert!(said.contains("no whole window"), "{said}");
    let said = notes_of(&record(&folder, "a", |second| {
        rmc(second) + "\n" + &compass(second)
    }));
    assert!(said.contains("no reference: no true heading"), "{said}");
    assert!(said.contains("239 windows"), "{said}");
    let unused = |second| {
        let heading = sentence("SDHDG,42.0,,,,");
        [rmc(second), heading, gyro(second)].join("\n")
    };
    let said = notes_of(&record(&folder, "a", unused));
    assert!(
        said.contains("no role uses the headings of SDHDG"),
        "{said}"
    );
    let empty = |second| [rmc(second), sentence("HCHDG,,,,,"), gyro(second)].join("\n");
    let said = notes_of(&record(&folder, "a", empty));
    assert!(said.contains("2400 HDG without a valid value"), "{said}");
}

#[test]
fn dates_older_than_a_roll_over_are_questioned_and_corrected_on_demand() {
    let folder = TempDir::new().unwrap();
    let whole = run(&[all(&folder, "all.log")]).unwrap();
    // 7,168 days before.
    let rolled_over =
        |second| [rmc_on("190506", second, 0.0), compass(second), gyro(second)].join("\n");
    let path = record(&folder, "old.log", rolled_over);
    let replay_with = |roll_overs| {
        let replayed = replay(&Recordings {
            files: std::slice::from_ref(&path),
            roles: &RolesConfig::usual(),
            silence: &SilenceConfig::default(),
            roll_overs,
            now: at("2026-02-01T00:00:00Z"),
        });
        replayed.unwrap()
    };
    let notes = replay_with(0).notes.join("\n");
    assert!(notes.contains("--roll-over 1"), "{notes}");
    let corrected = replay_with(1);
    assert_eq!(corrected.samples, whole.samples);
    let notes = corrected.notes.join("\n");
    assert!(
        notes.contains("2006-05-19T12:00:00Z is read as 2026-01-02T12:00:00Z"),
        "{notes}"
    );
}

#[test]
fn nothing_readable_is_an_error_and_unused_sentences_are_none() {
    let folder = TempDir::new().unwrap();
    let text = record(&folder, "diary.txt", |_| "Dear diary,".to_owned());
    let error = run(&[text]).unwrap_err().to_string();
    assert!(
        error.contains("diary.txt") && error.contains("Dear diary"),
        "{error}"
    );
    let ais = record(&folder, "ais.log", |_| {
        sentence("GPGSV,1,1,00").replace('$', "!")
    });
    assert!(run(&[ais]).is_ok());
}
