//! Looks at a model: the share of headings whose band holds the truth.

use crate::voyages::fleet::State;
use crate::voyages::{Truth, predicted, true_deviation};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::field::{FieldAt, FieldModel};
use binnacle_compass::model::Model;
use binnacle_compass::position::Position;
use binnacle_compass::result::Analysis;

/// Headings of one look.
pub(crate) const HEADINGS: u32 = 36;
/// Latitude between own and far place, degrees.
const FAR_DEG: f64 = 40.0;

/// Headings looked at, and those in whose band the truth lay.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Held {
    pub(crate) headings: u32,
    pub(crate) covered: u32,
}

impl Held {
    pub(crate) fn merge(&mut self, other: Held) {
        self.headings += other.headings;
        self.covered += other.covered;
    }

    /// Part of the headings in per cent.
    pub(crate) fn percent(self) -> f64 {
        100.0 * f64::from(self.covered) / f64::from(self.headings)
    }
}

/// Band of the current model at the ship's place and far from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    pub(crate) own: Held,
    pub(crate) far: Held,
}

/// Looks at the current model, if there is one, while the ship is in a state. The truth is
/// the ship with her habits at that time, at both places.
pub(crate) fn look(analysis: &Analysis, state: &State) -> Option<Look> {
    let model = analysis.current_epoch()?.model.as_ref()?;
    model.covariance?;
    Some(Look {
        own: held(model, &state.truth),
        far: held(model, &far(state)),
    })
}

fn held(model: &Model, truth: &Truth) -> Held {
    let mut held = Held::default();
    for k in 0..HEADINGS {
        let compass_deg = 10.0 * f64::from(k);
        let true_deg = true_deviation(truth, compass_deg, truth.h_nt, truth.z_nt);
        let (deviation, se) = predicted(model, compass_deg, truth.h_nt, truth.z_nt);
        held.headings += 1;
        held.covered += u32::from(wrap_180(deviation - true_deg).abs() <= 1.96 * se);
    }
    held
}

/// Returns the ship forty degrees of latitude away, across the equator from the nearer pole.
fn far(state: &State) -> Truth {
    let (lat, lon) = (state.position.lat_deg(), state.position.lon_deg());
    let there = Position::new(lat - FAR_DEG * lat.signum(), lon).unwrap();
    let field = FieldAt::from_time(FieldModel::Igrf14, state.time).unwrap();
    let field = field.at(there, 0.0).unwrap();
    Truth {
        h_nt: field.h_nt(),
        z_nt: field.z_nt,
        ..state.truth
    }
}
