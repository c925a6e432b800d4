//! Deviation card as CSV.
//!
//! Invariant: every line names its status and its source, so that none passes for a certificate
//! when it is cut out.

use super::contents::Card;

const COLUMNS: [&str; 16] = [
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
    "work_order",
    "verified_at",
    "verified_headings",
];

/// Writes a line for each row of the card.
pub(super) fn csv(card: &Card) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    let verified = card.verified.as_ref();
    let verified = [
        verified
            .map(|by| by.order)
            .or(card.unverified_order)
            .map_or(String::new(), |order| order.to_string()),
        verified.map_or(String::new(), |by| by.verified_at.0.to_string()),
        verified.map_or(String::new(), |by| by.headings.to_string()),
    ];
    let (place, model) = (&card.place, &card.model);
    for row in &card.rows {
        let angle = |degrees: f64| format!("{degrees:.2}");
        let fields = [
            angle(row.compass_deg),
            angle(row.magnetic_deg),
            angle(row.deviation_deg),
            angle(row.band95_deg),
            row.residual_deg.map(angle).unwrap_or_default(),
            row.samples.to_string(),
            card.status.word().to_owned(),
            place.lat.to_string(),
            place.lon.to_string(),
            place.at.0.to_string(),
            angle(place.variation_deg),
            model.version.to_string(),
            model.input_hash.clone(),
        ];
        writer.write_record(fields.iter().chain(&verified))?;
    }
    writer
        .into_inner()
        .map_err(|error| error.into_error().into())
}
