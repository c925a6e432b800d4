//! The server's program, run as a user runs it.

use crate::ship::passage;
use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Output};

pub fn command(program: &str, folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(program);
    command
        .args(arguments)
        .current_dir(folder)
        .env_remove("BINNACLE_DATABASE_URL");
    command
}

pub fn run(program: &str, folder: &Path, arguments: &[&str]) -> Output {
    command(program, folder, arguments).output().unwrap()
}

pub fn good(output: &Output) -> String {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Checks for exit code 2, no standard output, and one error line with all the words.
pub fn assert_refused(output: &Output, words: &[&str]) {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(output.stdout.is_empty());
    assert_eq!(errors.trim_end().lines().count(), 1, "{errors}");
    for word in words {
        assert!(errors.contains(word), "{word:?} is not in {errors:?}");
    }
}

pub fn samples_csv(folder: &Path) {
    let mut text = "time,lat,lon,compass_deg,gyro_deg,windows\n".to_owned();
    for sample in passage("2026-11-15T00:00:00Z", 300) {
        let gyro = sample.gyro.unwrap().degrees();
        writeln!(
            text,
            "{},{},{},{},{gyro},60",
            sample.time,
            sample.position.lat_deg(),
            sample.position.lon_deg(),
            sample.compass.degrees(),
        )
        .unwrap();
    }
    std::fs::write(folder.join("samples.csv"), text).unwrap();
}
