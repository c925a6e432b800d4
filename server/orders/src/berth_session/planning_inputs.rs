//! Inputs of a plan: model, field, binnacle and waters at the time of the reading.

use crate::berth_session::previous_lambda;
use crate::work_orders::events::OrderEvent;
use crate::work_orders::log::entry::Entry;
use crate::work_orders::payload::plan_basis::{Basis, ModelUsed};
use crate::work_orders::state::State;
use crate::work_orders::store;
use binnacle_adjustment::adjust::{Adjustment, Circumstances, Limits, ReadingForm, Water};
use binnacle_adjustment::berth::BerthReading;
use binnacle_adjustment::binnacle::{Binnacle, Setting};
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::position::Position;
use binnacle_compass::result::SampleDiagnostic;
use binnacle_compass::ship::EarthField;
use binnacle_fleet::analysis;
use binnacle_fleet::binnacles;
use binnacle_fleet::logbook;
use binnacle_fleet::models::{self, StoredModel};
use binnacle_platform::app::App;
use binnacle_platform::db::row;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{CompassId, OrderId, VesselId};
use binnacle_platform::time::Time;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// Input of the planner, with everything that it borrows.
pub(crate) struct PlanRequest {
    /// Basis of the plan.
    pub basis: Basis,
    /// Reading, as the planner takes it.
    pub reading: BerthReading,
    /// Reading on another heading of the berth, if it was sent.
    pub shifted: Option<BerthReading>,
    /// Reading, as it was sent.
    pub given: ReadingForm,
    /// Binnacle, with the strengths found so far.
    pub binnacle: Binnacle,
    /// Present setting of the correctors, if they were moved since the reading.
    pub moved_to: Option<Setting>,
    /// Last reading of the compass with that setting, degrees.
    pub compass_deg: Option<f64>,
    /// Limits of the order.
    pub limits: Limits,
}

impl Basis {
    /// Loads the basis for a reading.
    pub(crate) async fn load(
        app: &App,
        vessel: VesselId,
        compass: CompassId,
        given: &ReadingForm,
    ) -> Result<Basis> {
        let model = models::must_have(app, vessel, compass).await?;
        let binnacle = binnacles::current(&app.db, vessel, compass).await?;
        let binnacle = binnacle.ok_or(Error::WrongState(
            "the compass has no binnacle yet: enter it first".to_owned(),
        ))?;
        let position = Position::new(given.lat, given.lon).map_err(|error| Error::Invalid {
            field: "lat, lon",
            detail: error.to_string(),
        })?;
        let earth =
            field(FieldModel::Igrf14, position, 0.0, given.at).map_err(|error| Error::Invalid {
                field: "at",
                detail: error.to_string(),
            })?;
        let logbook = logbook::of_compass(&app.db, vessel, compass).await?;
        let cargo = logbook.iter().any(|entry| {
            entry.kind == LogbookKind::MagneticCargo
                && entry.from <= given.at
                && entry.to.is_none_or(|to| to > given.at)
        });
        Ok(Basis {
            variation_deg: earth.declination().degrees_east(),
            h_nt: earth.h_nt(),
            z_nt: earth.for_ship().z_nt,
            field_model: FieldModel::Igrf14.name().to_owned(),
            binnacle_revision: binnacle.revision,
            binnacle: binnacle.binnacle.0,
            waters: waters(app, vessel, compass, earth.for_ship()).await?,
            cargo_on_board: cargo || given.cargo_on_board,
            earlier: previous_lambda::find_for_compass(app, vessel, compass, given.at, &logbook)
                .await?,
            is_updated_here: false,
            model: ModelUsed {
                headings_until: headings_until(app, vessel, &model).await?,
                ..ModelUsed::from(model)
            },
        })
    }
}

impl From<StoredModel> for ModelUsed {
    fn from(stored: StoredModel) -> ModelUsed {
        ModelUsed {
            id: stored.id,
            version: stored.version,
            input_hash: stored.input_hash,
            estimator: stored.estimator,
            data_until: stored.data_until,
            headings_until: None,
            model: stored.model.0,
        }
    }
}

impl PlanRequest {
    /// Borrows the planner's input.
    pub(crate) fn adjustment(&self) -> Adjustment<'_> {
        let model = &self.basis.model;
        let until = model.headings_until.unwrap_or(model.data_until);
        let age_s = self.given.at.seconds_since(until.0);
        let earlier = self.basis.earlier.as_ref();
        Adjustment {
            model: &self.basis.model.model,
            earth: self.basis.earth(),
            reading: &self.reading,
            scale_sd: self.given.scale_sd(),
            compass_deg: self.compass_deg,
            vertical: self.given.vertical(),
            binnacle: &self.binnacle,
            now: self.moved_to.as_ref(),
            waters: &self.basis.waters,
            circumstances: Circumstances {
                model_age_days: Some((age_s / 86_400.0).max(0.0)),
                cargo_on_board: self.basis.cargo_on_board,
                earlier_lambda: earlier.and_then(|earlier| earlier.set_as(&self.binnacle)),
                is_updated_here: self.basis.is_updated_here,
                shifted: self.shifted,
            },
            limits: self.limits,
        }
    }
}

/// Time of the last heading behind a model that an order predicted, unless headings at sea
/// confirmed it. A prediction is no fresher than its own data.
async fn headings_until(app: &App, vessel: VesselId, model: &StoredModel) -> Result<Option<Time>> {
    let Some(order) = model.foretold_by else {
        return Ok(None);
    };
    let state = row!(
        &app.db,
        (State,),
        "SELECT state FROM work_orders WHERE vessel_id = $1 AND id = $2",
        vessel,
        order
    )?;
    if state.is_some_and(|(state,)| state == State::Verified) {
        return Ok(None);
    }
    let Some(record) = store::find_record(&app.db, vessel, order).await? else {
        return headings_of_cancelled(app, vessel, order).await;
    };
    let record: Value = serde_json::from_str(&record)?;
    let data = &record["data"];
    let until = [&data["headings_until"], &data["until"]];
    let until = until.into_iter().find(|until| !until.is_null());
    Ok(until.map(Time::deserialize).transpose()?)
}

/// Time of the last heading behind the model that a cancelled order left: that of its reading.
async fn headings_of_cancelled(
    app: &App,
    vessel: VesselId,
    order: OrderId,
) -> Result<Option<Time>> {
    let mut until = None;
    for line in store::list_lines(&app.db, vessel, order, None, i64::MAX).await? {
        let entry: Entry = serde_json::from_str(&line.line)?;
        if let OrderEvent::BerthReading(read) = &entry.content
            && let Some(basis) = &read.basis
        {
            until = Some(basis.model.headings_until.unwrap_or(basis.model.data_until));
        }
    }
    Ok(until)
}

/// Cells of the horizontal and the vertical field, nT: within one a compass behaves alike.
const CELL_NT: (f64, f64) = (3_000.0, 6_000.0);
/// Most waters of a plan; those with the most samples are kept.
const MAX_WATERS: usize = 5;

/// Magnetic waters in which the vessel sailed; the berth where nothing is known.
async fn waters(
    app: &App,
    vessel: VesselId,
    compass: CompassId,
    berth: EarthField,
) -> Result<Vec<Water>> {
    let samples = analysis::samples(&app.db, vessel, compass, None, None).await?;
    let read = tokio::task::spawn_blocking(move || {
        let mut cells: BTreeMap<(i64, i64), Vec<SampleDiagnostic>> = BTreeMap::new();
        for sample in samples {
            if let (Some(h_nt), Some(z_nt)) = (sample.h_nt, sample.z_nt) {
                let cell = |value: f64, size: f64| (value / size).round() as i64;
                let key = (cell(h_nt, CELL_NT.0), cell(z_nt, CELL_NT.1));
                cells.entry(key).or_default().push(sample);
            }
        }
        cells.values().filter_map(|found| water(found)).collect()
    });
    let mut waters: Vec<Water> = read.await?;
    waters.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    waters.truncate(MAX_WATERS);
    disambiguate_names(&mut waters);
    if waters.is_empty() {
        waters.push(Water {
            name: "the berth's waters".to_owned(),
            h_nt: berth.h_nt,
            z_nt: berth.z_nt,
            weight: 1.0,
        });
    }
    let whole: f64 = waters.iter().map(|water| water.weight).sum();
    for water in &mut waters {
        water.weight = (1000.0 * water.weight / whole).round() / 1000.0;
    }
    Ok(waters)
}

/// Weighted mean of a cell's samples.
fn water(samples: &[SampleDiagnostic]) -> Option<Water> {
    let weight = |found: &SampleDiagnostic| f64::from(found.sample.windows.max(1));
    let whole: f64 = samples.iter().map(weight).sum();
    let mean = |value: fn(&SampleDiagnostic) -> Option<f64>| {
        let sum = samples
            .iter()
            .filter_map(|found| Some(weight(found) * value(found)?));
        (whole > 0.0).then(|| sum.sum::<f64>() / whole)
    };
    let middle = &samples[samples.len() / 2].sample.position;
    Some(Water {
        name: place(middle.lat_deg(), middle.lon_deg()),
        h_nt: mean(|found| found.h_nt)?,
        z_nt: mean(|found| found.z_nt)?,
        weight: whole,
    })
}

/// Appends the field to the names of waters that share one.
fn disambiguate_names(waters: &mut [Water]) {
    let names: Vec<String> = waters.iter().map(|water| water.name.clone()).collect();
    for water in waters {
        if names.iter().filter(|name| **name == water.name).count() > 1 {
            let (h_ut, z_ut) = (water.h_nt / 1e3, water.z_nt / 1e3);
            let field = format!(" (H {h_ut:.0}, Z {z_ut:.0} µT)").replace('-', "−");
            water.name.push_str(&field);
        }
    }
}

fn place(lat: f64, lon: f64) -> String {
    let side = |value: f64, positive, negative| if value < 0.0 { negative } else { positive };
    format!(
        "about {:.0}°{} {:.0}°{}",
        lat.abs(),
        side(lat, 'N', 'S'),
        lon.abs(),
        side(lon, 'E', 'W')
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waters_of_one_name_are_distinguished_by_their_field() {
        let water = |name: &str, z_nt: f64| Water {
            name: name.to_owned(),
            h_nt: 29_400.0,
            z_nt,
            weight: 1.0,
        };
        let (here, there) = ("about 32°N 32°E", "about 4°S 12°W");
        let mut waters = [
            water(here, 31_000.0),
            water(there, 0.0),
            water(here, -8_000.0),
        ];
        disambiguate_names(&mut waters);
        let names = waters.map(|water| water.name);
        assert_eq!(names[0], format!("{here} (H 29, Z 31 µT)"));
        assert_eq!(names[1], there);
        assert_eq!(names[2], format!("{here} (H 29, Z −8 µT)"));
    }
}
