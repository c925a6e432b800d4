//! Rebuilds the server when what it embeds has changed.

fn main() {
    println!("cargo:rerun-if-changed=../web/dist");
}
