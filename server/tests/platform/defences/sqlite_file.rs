//! The file of a SQLite database: its owner's alone, of one server, and whole.

use crate::run;
use crate::secrets::Program;
use binnacle_server_testing::program::good;
use std::fs::Permissions;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Output;

const FILE: &str = "binnacle.db";
/// Size of a page of the file, bytes.
const PAGE: usize = 4096;

fn mode(file: &Path) -> u32 {
    file.metadata().unwrap().permissions().mode() & 0o777
}

/// Returns the errors of a run that fails.
fn errors(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn the_file_is_its_owners_alone() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(FILE);
    good(&run(folder.path(), &["migrate"]));
    assert_eq!(mode(&file), 0o600);
    std::fs::set_permissions(&file, Permissions::from_mode(0o644)).unwrap();
    let program = Program::start(folder.path(), "info", &[]);
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        let path = entry.unwrap().path();
        assert_eq!(mode(&path), 0o600, "{}", path.display());
    }
    program.stop();
}

#[test]
fn a_second_server_on_the_file_is_refused_until_the_first_has_ended() {
    let folder = tempfile::tempdir().unwrap();
    let first = Program::start(folder.path(), "info", &[]);
    let second = ["serve", "--listen", "127.0.0.1:0"];
    let refused = errors(&run(folder.path(), &second));
    assert!(
        refused.contains("another binnacle-server serves binnacle.db"),
        "{refused}"
    );
    // Commands beside the server go on.
    good(&run(folder.path(), &["migrate"]));
    good(&run(
        folder.path(),
        &["admin", "create", "operator", "--name", "ada"],
    ));
    first.stop();
    Program::start(folder.path(), "info", &[]).stop();
}

#[test]
fn migrations_at_once_wait_for_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let runs: Vec<_> = (0..4)
        .map(|_| {
            let folder = folder.path().to_owned();
            std::thread::spawn(move || run(&folder, &["migrate"]))
        })
        .collect();
    for run in runs {
        good(&run.join().unwrap());
    }
    good(&run(
        folder.path(),
        &["admin", "create", "operator", "--name", "ada"],
    ));
}

#[test]
fn a_damaged_file_is_noticed_at_the_start_and_by_a_backup() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(FILE);
    good(&run(folder.path(), &["migrate"]));
    good(&run(folder.path(), &["backup", "whole.backup"]));
    let whole = std::fs::read(&file).unwrap();
    // In the schema, and in the last table, which is read only when it is used.
    for at in [40 * PAGE, whole.len() - 4 * PAGE] {
        let mut damaged = whole.clone();
        damaged[at..at + 3 * PAGE].fill(0xa5);
        std::fs::write(&file, damaged).unwrap();
        for arguments in [
            ["serve", "--listen", "127.0.0.1:0"].as_slice(),
            &["backup", "damaged.backup"],
        ] {
            let refused = errors(&run(folder.path(), arguments));
            assert!(refused.contains("binnacle.db is damaged"), "{refused}");
        }
        assert!(!folder.path().join("damaged.backup").exists());
    }
}
