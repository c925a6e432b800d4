//! Mailing list for monthly reports: the letter, its recipients, and the files with it.

use binnacle_platform::db::{Db, Result, row};
use binnacle_platform::ids::OperatorId;
use binnacle_platform::mail::{Content, File, FileReference, Files, Letter, MailingList};
use futures_util::future::{BoxFuture, FutureExt};
use uuid::Uuid;

/// Mailing list for monthly reports.
pub const MAILING_LIST: MailingList = MailingList {
    subject: "monthly reports",
    page: "/reports",
    find_address,
    load_files,
};

/// Stored files of a report.
#[derive(sqlx::FromRow)]
struct StoredFiles {
    pdf: Vec<u8>,
    due_csv: String,
    deviation_csv: String,
    jobs_csv: String,
}

/// Returns the letter with the report of a month, which is stored under the month's name.
pub(super) fn letter(text: &str, operator: OperatorId, month: &str) -> Letter {
    Letter {
        subject: format!("Compass report of {month}"),
        text: text.to_owned(),
        items: Vec::new(),
        path: "/reports".to_owned(),
        about: None,
        files: Some(FileReference {
            operator,
            name: month.to_owned(),
        }),
    }
}

fn find_address(db: &Db, recipient: Uuid) -> BoxFuture<'_, Result<Option<String>>> {
    async move {
        let found = row!(
            db,
            (String,),
            "SELECT address FROM report_recipients WHERE id = $1 ORDER BY id",
            recipient
        )?;
        Ok(found.map(|(address,)| address))
    }
    .boxed()
}

fn load_files<'a>(db: &'a Db, of: &'a FileReference) -> BoxFuture<'a, Result<Option<Files>>> {
    async move {
        let found = row!(
            db,
            StoredFiles,
            "SELECT pdf, due_csv, deviation_csv, jobs_csv FROM monthly_reports
             WHERE operator_id = $1 AND month = $2
             ORDER BY month",
            of.operator,
            of.name.as_str()
        )?;
        Ok(found.map(|stored| stored.named(&of.name)))
    }
    .boxed()
}

impl StoredFiles {
    fn named(self, month: &str) -> Files {
        let table = |name: &str, text: String| File {
            name: format!("compass-{name}-{month}.csv"),
            media_type: "text/csv; charset=utf-8",
            content: Content::Text(text),
        };
        let report = File {
            name: format!("compass-report-{month}.pdf"),
            media_type: "application/pdf",
            content: Content::Binary(self.pdf),
        };
        vec![
            report,
            table("due", self.due_csv),
            table("deviation", self.deviation_csv),
            table("jobs", self.jobs_csv),
        ]
    }
}
