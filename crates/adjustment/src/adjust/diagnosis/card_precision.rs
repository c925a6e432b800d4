//! Reading precision of a compass card, limited by friction in a weak field.

/// Friction of a class A compass in a horizontal field of 1 µT, degrees (ISO 25862).
const FRICTION_DEG_UT: f64 = 3.0;
/// Standard deviation of the turn between two readings with little friction, degrees.
const TURN_SD_DEG: f64 = 0.3;
/// Standard deviation of a heading with little friction, degrees.
const HEADING_SD_DEG: f64 = 0.5;

/// Returns the greatest offset by friction in a horizontal field, degrees.
pub(crate) fn friction_deg(h_nt: f64) -> f64 {
    FRICTION_DEG_UT / (h_nt / 1e3)
}

/// Returns the standard deviation of the turn between two readings, degrees.
pub(crate) fn turn_sd_deg(h_nt: f64) -> f64 {
    TURN_SD_DEG.max(2.0_f64.sqrt() * friction_sd_deg(h_nt))
}

/// Returns the standard deviation of a heading, degrees.
pub(crate) fn heading_sd_deg(h_nt: f64) -> f64 {
    HEADING_SD_DEG.max(friction_sd_deg(h_nt))
}

/// Returns the standard deviation of a card at rest anywhere within its friction.
fn friction_sd_deg(h_nt: f64) -> f64 {
    friction_deg(h_nt) / 3.0_f64.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With 3° of friction in 1 µT, the standard deviation is 1.7°, and 2.4° for two
    /// readings.
    #[test]
    fn friction_counts_where_the_field_is_weak_and_only_there() {
        assert!((friction_deg(1_000.0) - 3.0).abs() < 1e-12);
        assert!((turn_sd_deg(1_000.0) - 6.0_f64.sqrt()).abs() < 1e-12);
        assert!((heading_sd_deg(1_000.0) - 3.0_f64.sqrt()).abs() < 1e-12);
        for h_nt in [10_000.0, 18_000.0, 40_000.0] {
            assert!((turn_sd_deg(h_nt) - 0.3).abs() < 1e-12);
            assert!((heading_sd_deg(h_nt) - 0.5).abs() < 1e-12);
        }
    }
}
