//! Ships, voyages and instruments that speak NMEA.
fn main() {}
