//! `deviation`: prints the deviation that a model predicts on every heading at one place.

use super::{BadInput, input, json, print_result, table};
use crate::cli::Deviation;
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use binnacle_fleet::deviation::{DeviationRow, table as predict};
use serde_json::json;
use std::process::ExitCode;

/// Prints the rows, as a table or as JSON.
///
/// # Errors
/// Fails when standard output cannot be written.
pub fn deviation(arguments: &Deviation) -> anyhow::Result<ExitCode> {
    print_result(find(arguments).map(|rows| {
        if arguments.json {
            json(&json!({ "rows": rows }))
        } else {
            describe(&rows)
        }
    }))
}

fn find(arguments: &Deviation) -> Result<Vec<DeviationRow>, BadInput> {
    if !(0.1..=360.0).contains(&arguments.step_deg) {
        let what = format!("{} is outside 0.1 to 360", arguments.step_deg);
        return Err(BadInput::option("--step-deg", what));
    }
    let model: Model = input::json_file(&arguments.model)?;
    let file = arguments.model.display();
    model
        .check()
        .map_err(|error| BadInput(format!("{file}: {error}")))?;
    let earth = earth(arguments)?;
    predict(&model, earth, arguments.step_deg).map_err(|error| match error {
        DeviationError::FieldTooWeak { .. } => {
            let by_place = arguments.h_nt.is_none();
            BadInput::option(if by_place { "--lat" } else { "--h-nt" }, error)
        }
        _ => BadInput(format!("{file}: {error}")),
    })
}

fn earth(arguments: &Deviation) -> Result<EarthField, BadInput> {
    if let (Some(h_nt), Some(z_nt)) = (arguments.h_nt, arguments.z_nt) {
        if !(h_nt > 0.0 && h_nt <= 1e6) {
            return Err(BadInput::option(
                "--h-nt",
                format!("{h_nt} is outside 0 to 1000000"),
            ));
        }
        if !(-1e6..=1e6).contains(&z_nt) {
            let what = format!("{z_nt} is outside -1000000 to 1000000");
            return Err(BadInput::option("--z-nt", what));
        }
        return Ok(EarthField { h_nt, z_nt });
    }
    let (Some(lat), Some(lon), Some(date)) = (arguments.lat, arguments.lon, &arguments.date) else {
        return Err(BadInput(
            "give --lat, --lon and --date, or --h-nt and --z-nt".to_owned(),
        ));
    };
    let found = field(
        FieldModel::Igrf14,
        input::position(lat, lon)?,
        0.0,
        input::date(date)?,
    );
    Ok(found
        .map_err(|error| BadInput::option("--date", error))?
        .for_ship())
}

fn describe(rows: &[DeviationRow]) -> String {
    let rows: Vec<[String; 4]> = rows
        .iter()
        .map(|row| {
            let size = format!("{:.1}", row.deviation_deg.abs());
            let side = match row.deviation_deg {
                _ if size == "0.0" => "",
                west if west < 0.0 => " W",
                _ => " E",
            };
            [
                format!("{:.1}", row.compass_deg),
                format!("{:.1}", row.magnetic_deg),
                size + side,
                row.band95_deg
                    .map_or(String::new(), |band| format!("{band:.1}")),
            ]
        })
        .collect();
    table::render(["compass", "magnetic", "deviation", "95 % ±"], &rows)
}
