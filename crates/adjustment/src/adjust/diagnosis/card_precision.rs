//! How well a compass card is read, which friction limits where the field is weak.

/// A class A compass's friction, degrees where the horizontal field is 1 µT (ISO 25862).
const FRICTION_DEG_UT: f64 = 3.0;
/// How well two readings of a card tell its turn where friction is little, degrees.
const TURN_SD_DEG: f64 = 0.3;
/// Of a card's heading where friction is little, degrees.
const HEADING_SD_DEG: f64 = 0.5;

/// How far off a card may hang by friction, degrees, in a horizontal field of so many nT.
pub(crate) fn friction_deg(h_nt: f64) -> f64 {
    FRICTION_DEG_UT / (h_nt / 1e3)
}

/// How well two readings of the card tell its turn, one standard deviation, degrees.
pub(crate) fn turn_sd_deg(h_nt: f64) -> f64 {
    TURN_SD_DEG.max(2.0_f64.sqrt() * friction_sd_deg(h_nt))
}

/// How well the card tells the heading, one standard deviation, degrees.
pub(crate) fn heading_sd_deg(h_nt: f64) -> f64 {
    HEADING_SD_DEG.max(friction_sd_deg(h_nt))
}

/// A card that came to rest anywhere within its friction.
fn friction_sd_deg(h_nt: f64) -> f64 {
    friction_deg(h_nt) / 3.0_f64.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3° within which a card may hang in 1 µT: 1.7° of standard deviation, 2.4° for two.
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
