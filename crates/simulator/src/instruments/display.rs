//! Display of an instrument: it follows its sensor with a lag, and shows no digits beyond
//! its own.

use crate::scenario::DisplayPlan;
use binnacle_compass::angle::wrap_180;

#[derive(Clone, Debug)]
pub(crate) struct Display {
    plan: DisplayPlan,
    shown_deg: Option<f64>,
}

impl Display {
    pub(crate) fn new(plan: DisplayPlan) -> Display {
        Display {
            plan,
            shown_deg: None,
        }
    }

    /// Returns the reading after `dt` seconds on a heading of the sensor, degrees, not
    /// wrapped.
    pub(crate) fn show(&mut self, dt: f64, heading_deg: f64) -> f64 {
        let shown_deg = self.follow(dt, heading_deg);
        self.shown_deg = Some(shown_deg);
        let step_deg = self.plan.resolution_deg;
        if step_deg > 0.0 {
            (shown_deg / step_deg).round() * step_deg
        } else {
            shown_deg
        }
    }

    fn follow(&self, dt: f64, heading_deg: f64) -> f64 {
        match self.shown_deg {
            Some(shown_deg) if self.plan.lag_s > 0.0 => {
                let left = (-dt / self.plan.lag_s).exp();
                heading_deg - wrap_180(heading_deg - shown_deg) * left
            }
            _ => heading_deg,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn display(lag_s: f64, resolution_deg: f64) -> Display {
        Display::new(DisplayPlan {
            lag_s,
            resolution_deg,
        })
    }

    #[test]
    fn without_settings_it_shows_its_sensor_to_the_bit() {
        let mut plain = display(0.0, 0.0);
        for heading in [0.1 + 0.2, -0.3, 725.015_625, 359.9] {
            assert_eq!(plain.show(1.0, heading).to_bits(), heading.to_bits());
        }
    }

    #[test]
    fn a_lag_leaves_a_third_of_a_turn_after_its_time_also_through_north() {
        let mut slow = display(10.0, 0.0);
        slow.show(1.0, 350.0);
        for _ in 0..9 {
            slow.show(1.0, 370.0);
        }
        let left = 370.0 - slow.show(1.0, 370.0);
        assert!((left - 20.0 * (-1.0_f64).exp()).abs() < 1e-9, "{left}");
        // The sensor's heading may be wrapped.
        let left = 10.0 - slow.show(1.0, 10.0);
        assert!((left - 20.0 * (-1.1_f64).exp()).abs() < 1e-9, "{left}");
    }

    #[test]
    fn whole_degrees_are_the_nearest() {
        for (resolution_deg, sensor, shown) in
            [(1.0, 359.6, 360.0), (1.0, -0.4, 0.0), (0.5, 12.3, 12.5)]
        {
            let off = display(0.0, resolution_deg).show(1.0, sensor) - shown;
            assert!(off.abs() < 1e-12, "{sensor}");
        }
    }
}
