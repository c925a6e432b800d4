//! Rebuilds the platform when a migration that it embeds has changed.

fn main() {
    println!("cargo:rerun-if-changed=../../migrations");
}
