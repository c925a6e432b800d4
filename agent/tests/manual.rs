//! The manual pages of the Debian package.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

use std::collections::BTreeMap;
use std::path::Path;
use tempfile::TempDir;

/// The pages in a folder by the names of their files.
fn pages(folder: &Path) -> BTreeMap<String, String> {
    let files = std::fs::read_dir(folder).unwrap();
    let page = |path: &Path| {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        (name, std::fs::read_to_string(path).unwrap())
    };
    files.map(|file| page(&file.unwrap().path())).collect()
}

#[test]
fn the_manual_pages_are_of_these_commands() {
    let packaged = Path::new(env!("CARGO_MANIFEST_DIR")).join("../packaging/debian/man");
    let folder = TempDir::new().unwrap();
    let commands = binnacle_agent::commands::command_line();
    clap_mangen::generate_to(commands, folder.path()).unwrap();
    if pages(folder.path()) != pages(&packaged) {
        let made = folder.keep();
        let (made, packaged) = (made.display(), packaged.display());
        panic!("the commands have changed: cp {made}/* {packaged}");
    }
}
