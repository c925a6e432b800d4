//! A card as CSV.
//!
//! What always holds: every line says what it is worth and where it comes from, so
//! that none can be taken for a certificate's when it is cut out.

use super::contents::{Card, Status};

const COLUMNS: [&str; 13] = [
    "compass_deg",
    "magnetic_deg",
    "deviation_deg",
    "band95_deg",
    "residual_deg",
    "samples",
    "status",
    "lat",
    "lon",
    "at",
    "variation_deg",
    "model_version",
    "input_hash",
];

/// A line for each row of the card.
pub(super) fn csv(card: &Card) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    let status = match card.status {
        Status::Predicted => "predicted",
    };
    let (place, model) = (&card.place, &card.model);
    for row in &card.rows {
        let angle = |degrees: f64| format!("{degrees:.2}");
        writer.write_record([
            angle(row.compass_deg),
            angle(row.magnetic_deg),
            angle(row.deviation_deg),
            angle(row.band95_deg),
            row.residual_deg.map(angle).unwrap_or_default(),
            row.samples.to_string(),
            status.to_owned(),
            place.lat.to_string(),
            place.lon.to_string(),
            place.at.0.to_string(),
            angle(place.variation_deg),
            model.version.to_string(),
            model.input_hash.clone(),
        ])?;
    }
    writer
        .into_inner()
        .map_err(|error| error.into_error().into())
}
