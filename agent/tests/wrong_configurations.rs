//! Wrong configurations and the real agent: each is refused in one line that names the file, the
//! line and the field.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

use std::collections::BTreeSet;
use std::fs;
use std::process::Stdio;
use std::time::Duration;
use tempfile::TempDir;
use tokio::process::Command;
use tokio::time::timeout;

const PATIENCE: Duration = Duration::from_mins(1);

/// A configuration that is right, line by line.
const RIGHT: &str = r#"data_dir = "state"
spool_mb = 64
ring_mb = 64
[inputs.bridge]
tcp = "127.0.0.1:10110"
[inputs.gyro]
serial = { path = "/dev/ttyUSB0", baud = 38400 }
[inputs.log]
udp = "0.0.0.0:10112"
[inputs.ecdis]
multicast = "239.192.0.4:60004"
[inputs.sk]
signalk = "ws://127.0.0.1:3000/signalk/v1/stream"
[inputs.n2k]
actisense = { serial = "/dev/ttyUSB2", baud = 115200 }
[roles]
compass = [{ input = "bridge", talker = "HC", sentence = "HDG" }]
gyro = [
    { input = "gyro", talker = "HE", sentence = "THS" },
    { input = "gyro", talker = "HE", sentence = "HDT" },
]
satellite = [{ input = "bridge", talker = "GP", sentence = "THS" }]
position = [{ input = "bridge", talker = "GP", sentence = "RMC" }]
rate_of_turn = [{ input = "bridge", sentence = "ROT" }]
log = [{ input = "log", sentence = "VHW" }]
roll = [{ input = "bridge", sentence = "XDR" }]
temperature = [{ input = "bridge", sentence = "MTA" }]
[output]
tcp_server = "127.0.0.1:10111"
udp = "127.0.0.1:10113"
serial = { path = "/dev/ttyUSB1", baud = 38400 }
multicast = "239.192.0.5:60005"
interval_s = 1
talker = "II"
hdg = true
[page]
listen = "127.0.0.1:8090"
[uplink]
profile = "standard"
retry_min_s = 30
retry_max_s = 3600
[alert]
difference_deg = 10
[silence]
stale_s = 15
"#;

/// A mistake: text of the right configuration, the text in its place, line and field of the mistake,
/// and a part of the problem's description.
#[derive(Debug, PartialEq)]
struct Mistake {
    right: String,
    wrong: String,
    line: usize,
    field: String,
    problem: String,
}

/// Reads mistakes, each a line of `right => wrong | line field: problem`; `\n` is a new line.
fn mistakes(table: &str) -> Vec<Mistake> {
    let read = |row: &str| {
        let (right, rest) = row.split_once(" => ")?;
        let (wrong, rest) = rest.split_once(" | ")?;
        let (line, rest) = rest.split_once(' ')?;
        let (field, problem) = rest.split_once(": ")?;
        Some(Mistake {
            right: right.replace("\\n", "\n"),
            wrong: wrong.replace("\\n", "\n"),
            line: line.parse().ok()?,
            field: field.to_owned(),
            problem: problem.to_owned(),
        })
    };
    let rows = table.lines().filter(|row| !row.is_empty());
    rows.map(|row| read(row).unwrap_or_else(|| panic!("{row}")))
        .collect()
}

/// Values of the wrong type, and values out of their range.
const VALUES: &str = r#"
"state" => 7 | 1 data_dir: expected path string
"state" => "" | 1 data_dir: names no directory
spool_mb = 64 => spool_mb = 1 | 2 spool_mb: 1 is not from 4 to 100000 megabytes
spool_mb = 64 => spool_mb = "big" | 2 spool_mb: invalid type: string "big"
ring_mb = 64 => ring_mb = -1 | 3 ring_mb: -1 is neither 0 nor from 1
interval_s = 1 => interval_s = 0 | 33 interval_s: 0 is not from 0.01 to 3600 seconds
interval_s = 1 => interval_s = nan | 33 interval_s: is not from 0.01 to 3600
hdg = true => hdg = 5 | 35 hdg: expected true, false or
hdg = true => hdg = { interval_s = 0.001 } | 35 hdg: expected true, false or
profile = "standard" => profile = "cheap" | 39 profile: `very-metered`
profile = "standard" => day_kb = 1 | 39 day_kb: 1 is not from 3 to 1000000
retry_min_s = 30 => retry_min_s = true | 40 retry_min_s: invalid type: boolean
difference_deg = 10 => difference_deg = 200 | 43 difference_deg: from 1 to 90 degrees
difference_deg = 10 => gyro_error_deg = 0.1 | 43 gyro_error_deg: from 0.5 to 30 degrees
difference_deg = 10 => settled_s = -5 | 43 settled_s: -5 is not from 0.01
stale_s = 15 => stale_s = 0 | 45 stale_s: 0 is not from 0.01
baud = 115200 => baud = 9 | 15 baud: 9 is not from 300 to 4000000 bits
[inputs.gyro]\nserial = { path = "/dev/ttyUSB0", baud = 38400 } => [inputs.gyro]\nserial = { path = "/dev/ttyUSB0", baud = 0 } | 7 baud: 0 is not from 300
"#;

/// Talkers, sentences and keys of sources.
const SOURCES: &str = r#"
talker = "HC" => talker = "COMPASS" | 17 talker: two capital letters
talker = "HC" => talker = 5 | 17 talker: invalid type: integer `5`
sentence = "HDG" => sentence = "HDM" | 17 compass: raw = true
sentence = "HDG" => sentence = "ROT" | 17 compass: ROT cannot serve here
talker = "HE", sentence = "THS" => talker = "he" | 19 talker: "he" is not
sentence = "HDT" => sentence = "THS" | 20 gyro: stands here twice
sentence = "HDT" => sentence = "HDM" | 18 gyro: HDM cannot serve here
satellite = [{ input = "bridge", talker = "GP" => satellite = [{ input = "gyro", talker = "HE" | 22 satellite: that of gyro as well
sentence = "RMC" => sentence = "ZDA" | 23 position: use RMC, GGA or GLL
{ input = "bridge", sentence = "ROT" } => "ROT" | 24 rate_of_turn: expected struct
input = "log" => input = "logg" | 25 input: there is no input named "logg"
sentence = "XDR" => n2k_address = 300 | 26 n2k_address: from 0 to 251
sentence = "XDR" => n2k_name = "abc" | 26 n2k_name: 16 hexadecimal digits
sentence = "XDR" => source = "n2k.4" | 26 source: never names a source
sentence = "XDR" => sender = "10.0.0.2" | 26 sender: never names a sender
sentence = "XDR" => sender = "bridge" | 26 sender: invalid IP address
sentence = "MTA" => sfi = "" | 27 sfi: names nothing
sentence = "MTA" => senttence = "MTA" | 27 senttence: unknown field `senttence`
"#;

/// Inputs, outputs and what two settings share.
const PLACES: &str = r#"
tcp = "127.0.0.1:10110" => tcp = "127.0.0.1" | 5 tcp: not a host and a port
tcp = "127.0.0.1:10110" => tcp = "127.0.0.1:99999" | 5 tcp: not a host and a port
tcp = "127.0.0.1:10110" =>  | 4 bridge: this one has none
udp = "0.0.0.0:10112" => udp = "0.0.0.0:10112"\nfile = "a" | 8 log: has udp and file
udp = "0.0.0.0:10112" => udp = "10112" | 9 udp: invalid socket address
udp = "0.0.0.0:10112" => udp = "0.0.0.0:0" | 9 udp: at port 0
"239.192.0.4:60004" => "192.168.1.4:60004" | 11 multicast: not a multicast address
"ws://127.0.0.1:3000/signalk/v1/stream" => "http://127.0.0.1:3000" | 13 signalk: wss://
[inputs.n2k]\nactisense = { serial = "/dev/ttyUSB2", baud = 115200 } => [inputs.n2k]\nactisense = { tcp = "10.0.0.5:2000", baud = 115200 } | 15 actisense: baud is of a serial
"/dev/ttyUSB2" => "/dev/ttyUSB0" | 15 serial: used by inputs.gyro.serial.path as well
[inputs.bridge] => [inputs.bridge]\nspeed = 3 | 5 speed: unknown field `speed`
"127.0.0.1:10111" => "10111" | 29 tcp_server: invalid socket address
"127.0.0.1:10113" => "127.0.0.1:0" | 30 udp: sent to port 0
"127.0.0.1:10113" => ["10.0.0.1:1", "10.0.0.1:1"] | 30 udp: used by output.udp as well
"/dev/ttyUSB1" => "/dev/ttyUSB0" | 31 serial: used by inputs.gyro.serial.path as well
"239.192.0.5:60005" => { group = "239.192.0.5:60005", sfi = "II1" } | 32 sfi: "II1"
"127.0.0.1:8090" => "0.0.0.0:10111" | 37 listen: used by output.tcp_server as well
"127.0.0.1:8090" => "localhost" | 37 listen: invalid socket address
"#;

/// Sections, syntax, and settings that exclude each other.
const STRUCTURE: &str = r#"
data_dir = "state"\n =>  | 1 data_dir: missing field `data_dir`
ring_mb = 64 => ring_mb = 64\nring_mb = 64 | 4 ring_mb: duplicate key
ring_mb = 64 => ring_mb = | 3 ring_mb: string values must be quoted
"state" => "state | 1 data_dir: invalid basic string
[page] => [pages] | 36 pages: unknown field `pages`
[page] => [page | 36 page: unclosed table
[inputs.log] => [inputs.gyro] | 8 gyro: duplicate key
listen = "127.0.0.1:8090"\n =>  | 36 listen: missing field `listen`
compass = [ => compas = [ | 17 compas: unknown field `compas`
"standard" => "short-burst" | 39 profile: short-burst needs a [modem]
[silence] => [modem]\ndirectory = "sat"\n[silence] | 45 directory: short-burst
retry_max_s = 3600 => retry_max_s = 10 | 40 retry_min_s: 30 is more than retry_max_s, 10
interval_s = 1 => interval_s = 0.02 | 31 baud: 38400 baud carry 3840 bytes a second
"127.0.0.1:10113" => { address = "10.0.0.1:1", sentences = ["ALR"] } | 30 sentences: ALR is not switched on in [output]
"127.0.0.1:10113" => { address = "10.0.0.1:1", sentences = [] } | 30 sentences: sends nothing
"127.0.0.1:10113" => { address = "10.0.0.1:1", sentences = ["HDM"] } | 30 sentences: unknown variant `HDM`
stale_s = 15 => stale_s = 15\n[silence.gyro]\nsteering_s = 5 | 47 steering_s: unknown field
"#;

/// Files and directories; the folder has `empty.pem`, `text.pem`, and no other file.
const FILES: &str = r#"
profile = "standard" => pinned_ca = "ca.pem" | 39 pinned_ca: ca.pem cannot be read
profile = "standard" => pinned_ca = "text.pem" | 39 pinned_ca: text.pem is not a PEM
profile = "standard" => pinned_ca = "empty.pem" | 39 pinned_ca: empty.pem has no certificate
"ws://127.0.0.1:3000/signalk/v1/stream" => { url = "wss://127.0.0.1:3000", ca = "ca.pem" } | 13 ca: ca.pem: 
"ws://127.0.0.1:3000/signalk/v1/stream" => { url = "ws://127.0.0.1:3000", ca = "ca.pem" } | 13 signalk: ca is of wss
udp = "0.0.0.0:10112" => file = "none.nmea" | 9 file: No such file
"state" => "text.pem" | 1 data_dir: exists
profile = "standard"\nretry_min_s = 30\nretry_max_s = 3600\n => profile = "short-burst"\n[modem]\ndirectory = "text.pem"\n | 41 directory: directory
"#;

/// Runs the agent by a configuration, in a folder with two files. Returns what it says.
async fn refusal(configuration: &str) -> String {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("empty.pem"), "").unwrap();
    fs::write(
        folder.path().join("text.pem"),
        "-----BEGIN CERTIFICATE-----\nnone\n-----END CERTIFICATE-----\n",
    )
    .unwrap();
    fs::write(folder.path().join("agent.toml"), configuration).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_binnacle-agent"));
    command
        .args(["run", "--config", "agent.toml"])
        .current_dir(folder.path())
        .stdin(Stdio::null())
        .kill_on_drop(true)
        .env_remove("BINNACLE_LOG");
    let done = timeout(PATIENCE, command.output()).await;
    let done = done.expect("it runs with a wrong configuration").unwrap();
    let said = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(2), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    said
}

async fn each_is_named(table: &str) {
    let mut failures = Vec::new();
    for mistake in mistakes(table) {
        assert_eq!(RIGHT.matches(&mistake.right).count(), 1, "{mistake:?}");
        let said = refusal(&RIGHT.replace(&mistake.right, &mistake.wrong)).await;
        let Mistake {
            line,
            field,
            problem,
            ..
        } = &mistake;
        // A field that is missing has no line of its own: the problem names it.
        let place = format!("binnacle-agent: agent.toml:{line}: ");
        let is_placed = said.strip_prefix(&place).is_some_and(|rest| {
            rest.starts_with(&format!("{field}: "))
                || rest.contains(&format!("missing field `{field}`"))
        });
        if !is_placed || !said.contains(problem) {
            failures.push(format!("{mistake:?}\n  {said}"));
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[tokio::test]
async fn a_wrong_value_is_named_by_file_line_and_field() {
    each_is_named(VALUES).await;
}

#[tokio::test]
async fn a_wrong_source_of_a_role_is_named_by_file_line_and_field() {
    each_is_named(SOURCES).await;
}

#[tokio::test]
async fn a_wrong_input_or_output_is_named_by_file_line_and_field() {
    each_is_named(PLACES).await;
}

#[tokio::test]
async fn a_wrong_structure_is_named_by_file_line_and_field() {
    each_is_named(STRUCTURE).await;
}

#[tokio::test]
async fn a_file_that_cannot_be_used_is_named_by_file_line_and_field() {
    each_is_named(FILES).await;
}

#[test]
fn more_than_seventy_different_mistakes_are_tried() {
    let all = mistakes(&[VALUES, SOURCES, PLACES, STRUCTURE, FILES].concat());
    let texts = all.iter().map(|mistake| (&mistake.right, &mistake.wrong));
    let different: BTreeSet<_> = texts.collect();
    assert_eq!(different.len(), all.len());
    assert!(all.len() > 70, "{}", all.len());
}
