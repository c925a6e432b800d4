//! Checks of a written reading against the model.

use super::card_check::CardCheck;
use super::cures::Refused;
use super::misreadings::{Misreading, find_misreadings};
use super::refusal::Refusal;
use super::vertical_check::{VerticalCheck, find_swapped_axes};
use crate::adjust::inputs::{BerthForm, FormError, ReadingForm};
use crate::adjust::needle_part::{lambda_without_needles, without_needles};
use crate::berth::{BerthEstimate, BerthReading};
use crate::binnacle::Binnacle;
use binnacle_compass::angle::Variation;
use binnacle_compass::model::Model;
use binnacle_compass::ship::{EarthField, WEAKEST_H_NT};

impl ReadingForm {
    /// Checks the reading against the model and determines λ, with the correctors in the
    /// binnacle's setting.
    ///
    /// # Errors
    /// The refusal, with single misreadings that explain it.
    pub fn check(
        &self,
        model: &Model,
        earth: EarthField,
        variation: Variation,
        binnacle: &Binnacle,
    ) -> Result<(BerthReading, BerthEstimate), Box<Refused>> {
        if earth.h_nt < WEAKEST_H_NT {
            let h_nt = earth.h_nt;
            return Err(Box::new(Refusal::FieldTooWeak { h_nt }.with_cures()));
        }
        let found = self.reading(variation).and_then(|reading| {
            let h_nt = model.reference_h_nt().unwrap_or(earth.h_nt);
            let estimate = lambda_without_needles(model, binnacle, h_nt, earth, &reading)?;
            self.shifted_reading(variation)?;
            Ok((reading, estimate))
        });
        let (reading, estimate) = found.map_err(|error| {
            let explain = self.explain(model, earth, variation, binnacle);
            Box::new(Refusal::from_berth_error(&error, explain).with_cures())
        })?;
        let card =
            |read_deg| CardCheck::new(read_deg, &reading, earth, binnacle, model.constant_deg);
        let card = self.compass_deg.map(card).filter(CardCheck::is_refused);
        if let Some(card) = card {
            return Err(Box::new(Refusal::CardDisagrees(card).with_cures()));
        }
        let vertical = self.vertical();
        let vertical = vertical.map(|read| VerticalCheck::new(read, earth, binnacle));
        match vertical.and_then(|vertical| vertical.refusal()) {
            Some(refusal) => Err(Box::new(refusal.with_cures())),
            None => Ok((reading, estimate)),
        }
    }

    fn explain(
        &self,
        model: &Model,
        earth: EarthField,
        variation: Variation,
        binnacle: &Binnacle,
    ) -> Vec<Misreading> {
        let Ok(magnetic) = self.magnetic(variation) else {
            return Vec::new();
        };
        let (field_nt, unit) = (self.field_nt(), self.unit);
        let (errors, alignment) = (self.errors(), self.alignment());
        let model = &without_needles(model, binnacle, earth);
        let mut found = find_misreadings(model, earth, magnetic, field_nt, unit, errors, alignment);
        let reading = BerthReading::new(magnetic, field_nt, errors, alignment);
        if let (Ok(reading), Some(vertical)) = (reading, self.vertical()) {
            found.extend(find_swapped_axes(
                model, earth, &reading, vertical, binnacle,
            ));
        }
        found
    }
}

impl BerthForm {
    /// Finds the misreadings that each make the reading fit the model.
    pub fn explain_misreadings(&self, model: &Model, binnacle: &Binnacle) -> Option<FormError> {
        self.reading.check_ranges().ok()?;
        let (earth, variation) = self.field().ok()?;
        let refused = self
            .reading
            .check(model, earth, variation, binnacle)
            .err()?;
        let misreadings = refused.refusal.misreadings();
        let mut fields: Vec<String> = Vec::new();
        for misreading in misreadings {
            let field = format!("reading.{}", misreading.field());
            if !fields.contains(&field) {
                fields.push(field);
            }
        }
        let each: Vec<String> = misreadings.iter().map(ToString::to_string).collect();
        let what = format!("it could be that {}", each.join(", or that "));
        (!misreadings.is_empty()).then(|| FormError::new(fields.join(" or "), what))
    }
}
