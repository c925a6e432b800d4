//! The shore server.
fn main() {}
