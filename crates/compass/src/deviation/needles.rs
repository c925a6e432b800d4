//! The needles' part of D and E in another horizontal field than that of the fit.

use crate::model::{Model, NeedleInduction, Parameters};
use crate::ship::{EarthField, PARAMETERS};

impl Model {
    /// Returns the seven ratios at a place: those of the model, with the needles' part of D
    /// and E in this horizontal field (docs/science.md, eq. 18).
    pub fn parameters_at(&self, earth: EarthField) -> Parameters {
        let parameters = self.parameters_over_lambda;
        let Some(needles) = &self.needles else {
            return parameters;
        };
        let [.., chi11_minus_chi22, chi12, chi21] = needles.change(earth);
        Parameters {
            chi11_minus_chi22: parameters.chi11_minus_chi22 + chi11_minus_chi22,
            chi12: parameters.chi12 + chi12,
            chi21: parameters.chi21 + chi21,
            ..parameters
        }
    }
}

impl NeedleInduction {
    /// Returns the change of each parameter from the reference's horizontal field.
    pub(super) fn change(&self, earth: EarthField) -> [f64; PARAMETERS] {
        let by_field = 1.0 / earth.h_nt - 1.0 / self.reference_h_nt;
        let (d, e) = (self.d_nt * by_field, self.e_nt * by_field);
        [0.0, 0.0, 0.0, 0.0, 2.0 * d, e, e]
    }
}
