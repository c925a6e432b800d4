//! The letter with a month's report, and what is attached to it.

use super::letter::{Attached, Letter};
use crate::db::{Db, Result, row};
use crate::ids::OperatorId;

/// A report's files as they were kept.
#[derive(sqlx::FromRow)]
pub(super) struct Files {
    pub(super) pdf: Vec<u8>,
    pub(super) due_csv: String,
    pub(super) deviation_csv: String,
    pub(super) jobs_csv: String,
}

/// The letter with the report of a month, which is kept under the month's name.
pub fn monthly_letter(words: &str, operator: OperatorId, month: &str) -> Letter {
    Letter {
        subject: format!("Compass report of {month}"),
        text: words.to_owned(),
        told: Vec::new(),
        path: "/reports".to_owned(),
        about: None,
        report: Some(Attached {
            operator,
            month: month.to_owned(),
        }),
    }
}

/// The files of a report that was made.
pub(super) async fn files(db: &Db, report: &Attached) -> Result<Option<Files>> {
    row!(
        db,
        Files,
        "SELECT pdf, due_csv, deviation_csv, jobs_csv FROM monthly_reports
         WHERE operator_id = $1 AND month = $2
         ORDER BY month",
        report.operator,
        report.month.as_str()
    )
}
