//! Tables of a report as CSV: columns named as in JSON, a line for each compass or job.

use super::report::{DueCompass, Job, Report, Saving, WorstDeviation};
use binnacle_platform::error::{Error, Result};
use serde::Deserialize;
use serde_json::Value;
use utoipa::ToSchema;

/// First characters by which a spreadsheet recognises a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// Table of a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ReportTable)]
pub(super) enum Table {
    /// Due dates of the compasses, the earliest first.
    #[default]
    Due,
    /// Greatest deviation of each compass, the largest first.
    Deviation,
    /// Completed jobs.
    Jobs,
}

impl Table {
    /// Returns the name of the table, for a file.
    pub(super) fn name(self) -> &'static str {
        match self {
            Table::Due => "due",
            Table::Deviation => "deviation",
            Table::Jobs => "jobs",
        }
    }
}

/// Returns a table of a report as CSV.
pub(super) fn render_table(report: &Report, table: Table) -> Result<String> {
    match table {
        Table::Due => {
            let columns = [
                "vessel_name",
                "compass_name",
                "due_on",
                "urgency",
                "reason",
                "adjusted_on",
                "order_state",
                "order_port",
                "order_planned_at",
                "order_firm",
                "vessel_id",
                "compass_id",
            ];
            write_rows(&columns, report.due.iter().map(due_row))
        }
        Table::Deviation => {
            let columns = [
                "vessel_name",
                "compass_name",
                "compass_deg",
                "deviation_deg",
                "band95_deg",
                "data_until",
                "vessel_id",
                "compass_id",
            ];
            write_rows(&columns, report.deviation.iter().map(deviation_row))
        }
        Table::Jobs => {
            let columns = [
                "vessel_name",
                "compass_name",
                "port",
                "completed_at",
                "firm",
                "state",
                "fee_eur",
                "fee_from",
                "swing_eur",
                "swing_h",
                "order_id",
                "vessel_id",
                "compass_id",
                "spared_swing",
            ];
            let rows = report.jobs.iter().map(|one| job_row(one, &report.saved));
            write_rows(&columns, rows)
        }
    }
}

fn due_row(due: &DueCompass) -> Result<Value> {
    let mut fields = serde_json::to_value(due)?;
    let order = fields["order"].take();
    for field in ["state", "port", "planned_at", "firm"] {
        fields[format!("order_{field}")] = order[field].clone();
    }
    Ok(fields)
}

fn deviation_row(deviation: &WorstDeviation) -> Result<Value> {
    Ok(serde_json::to_value(deviation)?)
}

fn job_row(job: &Job, saving: &Saving) -> Result<Value> {
    let mut fields = serde_json::to_value(job)?;
    fields["swing_eur"] = saving.swing_eur.into();
    fields["swing_h"] = saving.swing_h.into();
    Ok(fields)
}

fn write_rows(columns: &[&str], rows: impl Iterator<Item = Result<Value>>) -> Result<String> {
    let internal = |error: csv::Error| Error::Internal(error.into());
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns).map_err(internal)?;
    for row in rows {
        let row = row?;
        let record = columns.iter().map(|column| cell(column, &row[*column]));
        writer.write_record(record).map_err(internal)?;
    }
    let written = writer.into_inner();
    let bytes = written.map_err(|error| Error::Internal(error.into_error().into()))?;
    String::from_utf8(bytes).map_err(|error| Error::Internal(error.into()))
}

fn cell(column: &str, value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        // A quote keeps spreadsheets from reading a name as a formula.
        Value::String(text) if text.starts_with(FORMULA) => format!("'{text}"),
        Value::String(text) => text.clone(),
        number if column.ends_with("_deg") => number
            .as_f64()
            .map_or_else(String::new, |degrees| format!("{degrees:.1}")),
        other => other.to_string(),
    }
}
