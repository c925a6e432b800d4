//! The program's commands, outputs and exit codes.

use std::io::{BufRead, BufReader, Read};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_binnacle-simulator"))
}

fn small() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/small.toml")
}

fn voyage(scenario: &Path, more: &[&str]) -> Output {
    let mut command = program();
    command
        .arg("voyage")
        .arg("--scenario")
        .arg(scenario)
        .args(more);
    command.output().expect("the program was built")
}

#[test]
fn a_voyage_is_written_whole_with_its_truth_beside() {
    let folder = tempfile::tempdir().unwrap();
    let (out, truth) = (folder.path().join("v.nmea"), folder.path().join("t.json"));
    let (out_text, truth_text) = (out.to_str().unwrap(), truth.to_str().unwrap());
    let more = [
        "--seed", "4", "--out", out_text, "--truth", truth_text, "--days", "0.5",
    ];
    let first = voyage(&small(), &more);
    assert!(first.status.success(), "{first:?}");
    let bytes = std::fs::read(&out).unwrap();
    assert!(bytes.starts_with(b"$GPRMC,") && bytes.ends_with(b"\r\n"));
    let truth: serde_json::Value = serde_json::from_slice(&std::fs::read(&truth).unwrap()).unwrap();
    assert_eq!(truth["vessel"], "Estrella del Sur");
    assert_eq!(truth["at_the_end"]["rows"].as_array().unwrap().len(), 36);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    assert!(voyage(&small(), &more).status.success());
    assert!(
        bytes == std::fs::read(&out).unwrap(),
        "the same seed gives the same bytes"
    );
}

#[test]
fn bad_input_ends_with_2_and_one_line_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("v.nmea");
    let out = out.to_str().unwrap();
    let noise = folder.path().join("noise.toml");
    std::fs::write(&noise, [0xff_u8, 0, 0x80, 7]).unwrap();
    let absent = folder.path().join("absent.toml");
    for (scenario, more) in [
        (noise.as_path(), vec!["--out", out]),
        (absent.as_path(), vec!["--out", out]),
        (small().as_path(), vec!["--out", out, "--days", "nan"]),
        (
            small().as_path(),
            vec!["--out", out, "--start", "1850-01-01T00:00:00Z"],
        ),
        (small().as_path(), vec!["--out", out, "--ship", "Titanic"]),
        (small().as_path(), vec!["--out", "/nowhere/v.nmea"]),
    ] {
        let ended = voyage(scenario, &more);
        assert_eq!(ended.status.code(), Some(2), "{more:?} {ended:?}");
        assert_eq!(
            String::from_utf8_lossy(&ended.stderr).lines().count(),
            1,
            "{ended:?}"
        );
    }
    assert!(!Path::new(out).exists());
}

/// A fleet that only serves; ended when dropped.
struct Serving(Child);

impl Drop for Serving {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

#[test]
fn a_ship_waits_for_her_client_and_sails_on_for_the_next() {
    let mut command = program();
    command.args([
        "fleet",
        "--serve-only",
        "--days",
        "3",
        "--until",
        "2026-03-10T00:00:00Z",
    ]);
    command.arg("--scenario").arg(small());
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut serving = Serving(child);
    let mut said = BufReader::new(serving.0.stdout.take().unwrap()).lines();
    let first: serde_json::Value = serde_json::from_str(&said.next().unwrap().unwrap()).unwrap();
    let address = |ship: usize| first["ships"][ship]["address"].as_str().unwrap().to_owned();
    let second_ship = std::thread::spawn({
        let address = address(1);
        move || reaches_the_end(&mut TcpStream::connect(address).unwrap())
    });
    // The first client reads a little and disconnects.
    let mut client = TcpStream::connect(address(0)).unwrap();
    let mut bytes = vec![0; 10_000];
    client.read_exact(&mut bytes).unwrap();
    assert!(bytes.starts_with(b"$GPRMC,"));
    drop(client);
    let mut next = TcpStream::connect(address(0)).unwrap();
    assert!(reaches_the_end(&mut next), "the next client gets the rest");
    assert!(second_ship.join().unwrap());
    let last: serde_json::Value = serde_json::from_str(&said.next().unwrap().unwrap()).unwrap();
    assert_eq!(last["sailed"], true);
}

/// Reads until a position of the last minute arrives.
fn reaches_the_end(client: &mut TcpStream) -> bool {
    let mut lines = BufReader::new(client).split(b'\n');
    lines.any(|line| {
        let line = line.expect("the line stays open");
        line.starts_with(b"$GPRMC,2359") && line.windows(8).any(|part| part == b",090326,")
    })
}
