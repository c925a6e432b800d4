//! The shipboard agent.
fn main() {}
