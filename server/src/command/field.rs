//! `field`: prints the earth's field at a place and time.

use super::{BadInput, input, json, print_result};
use crate::cli::{Field, FieldModel};
use binnacle_compass::field::{FieldModel as Model, field as evaluate};
use serde::Serialize;
use std::process::ExitCode;

#[derive(Serialize)]
struct FieldOutput {
    declination_deg: f64,
    h_nt: f64,
    z_nt: f64,
    x_nt: f64,
    y_nt: f64,
    inclination_deg: f64,
    model: &'static str,
}

/// Prints the field as JSON.
///
/// # Errors
/// Fails when standard output cannot be written.
pub fn field(arguments: &Field) -> anyhow::Result<ExitCode> {
    print_result(find(arguments).map(|found| json(&found)))
}

fn find(arguments: &Field) -> Result<FieldOutput, BadInput> {
    let position = input::position(arguments.lat, arguments.lon)?;
    let time = input::date(&arguments.date)?;
    let model = match arguments.model {
        FieldModel::Igrf14 => Model::Igrf14,
        FieldModel::Wmm2025 => Model::Wmm2025,
    };
    let field = evaluate(model, position, arguments.altitude_m, time).map_err(|error| {
        let option = match error {
            binnacle_compass::field::FieldError::DateOutside { .. } => "--date",
            binnacle_compass::field::FieldError::Altitude(_) => "--altitude-m",
        };
        BadInput::option(option, error)
    })?;
    Ok(FieldOutput {
        declination_deg: field.declination().degrees_east(),
        h_nt: field.h_nt(),
        z_nt: field.z_nt,
        x_nt: field.x_nt,
        y_nt: field.y_nt,
        inclination_deg: field.inclination_deg(),
        model: model.name(),
    })
}
