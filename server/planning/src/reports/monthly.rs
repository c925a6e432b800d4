//! Monthly report by mail, after the end of each month.
//!
//! Invariants: the report of a month is made once, stored as mailed, and sent to those who were
//! recipients before the month ended. A server that was down sends the last month's on return.

use super::csv::{self, Table};
use super::load::load_report;
use super::mailing_list;
use super::report::Report;
use binnacle_compass::time::Timestamp;
use binnacle_platform::app::App;
use binnacle_platform::db::{Tx, execute, row, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{DeliveryId, OperatorId, RecipientId};
use binnacle_platform::outbox::{self, Kind, Message};
use binnacle_platform::time::Time;
use binnacle_platform::webhooks::{Audience, DeclaredKind};
use chrono::{DateTime, Datelike, Days, NaiveDate, NaiveTime, Timelike, Utc};
use std::time::Duration;
use tracing::error;

/// Monthly report by mail.
pub const MESSAGE_KIND: DeclaredKind = DeclaredKind::new(
    Kind::new("report"),
    Audience::Nobody,
    "The monthly report is sent.",
);

/// Interval between checks for the end of a month.
const POLL_INTERVAL: Duration = Duration::from_mins(10);
/// Hour of the first day of a month, UTC, from which reports are made: late batches of the night
/// have arrived.
const FIRST_HOUR: u32 = 6;

/// Makes monthly reports until the server stops.
pub async fn watch(app: App) {
    while !app.stopping.is_cancelled() {
        if let Err(error) = make_due_reports(&app).await {
            error!(?error, "cannot make monthly reports");
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(POLL_INTERVAL) => {}
        }
    }
}

/// Makes and queues the missing reports of the last month and returns their number.
pub async fn make_due_reports(app: &App) -> Result<usize> {
    let now: Time = app.clock.now().into();
    let Some((month, ended)) = last_month(now.0.to_chrono()) else {
        return Ok(0);
    };
    if !app.config.mail.is_set_up() {
        return Ok(0);
    }
    let due = rows!(
        &app.db,
        (OperatorId,),
        "SELECT DISTINCT r.operator_id FROM report_recipients r
         WHERE r.created_at < $1
           AND NOT EXISTS (SELECT 1 FROM monthly_reports m
                           WHERE m.operator_id = r.operator_id AND m.month = $2)
         ORDER BY r.operator_id",
        ended,
        month_name(month)
    )?;
    let mut made = 0;
    for (operator,) in due {
        match make_report(app, operator, month, ended).await {
            Ok(is_new) => made += usize::from(is_new),
            // The next check tries again; other operators' reports go on.
            Err(error) => error!(?error, %operator, "cannot make a monthly report"),
        }
    }
    Ok(made)
}

/// Makes and queues a report; false when another process was faster.
async fn make_report(
    app: &App,
    operator: OperatorId,
    month: NaiveDate,
    ended: Time,
) -> Result<bool> {
    let last = next_month(month) - Days::new(1);
    let before = find_last_report(app, operator, month).await?;
    let report = load_report(app, operator, month, last, before).await?;
    let letter = mailing_list::letter(&report.letter_text(), operator, &month_name(month));
    let tables = [Table::Due, Table::Deviation, Table::Jobs];
    let [due, deviation, jobs] = tables.map(|table| csv::render_table(&report, table));
    let (due, deviation, jobs) = (due?, deviation?, jobs?);
    let (made_at, pdf) = (report.made_at, report.into_pdf().await?);
    let mut tx = app.db.begin().await?;
    let inserted = execute!(
        &mut tx,
        "INSERT INTO monthly_reports (operator_id, month, made_at, pdf, due_csv, deviation_csv,
                                      jobs_csv)
         VALUES ($1, $2, $3, $4, $5, $6, $7)
         ON CONFLICT (operator_id, month) DO NOTHING",
        operator,
        month_name(month),
        made_at,
        pdf,
        due,
        deviation,
        jobs
    )?;
    if inserted == 0 {
        return Ok(false);
    }
    let body = serde_json::to_string(&letter)?;
    for (recipient,) in list_recipients(&mut tx, operator, ended).await? {
        let message = Message {
            id: DeliveryId::new(),
            kind: MESSAGE_KIND.kind,
            about: None,
            body: body.clone(),
        };
        outbox::queue(&mut tx, recipient.0, &message, made_at).await?;
    }
    tx.commit().await?;
    Ok(true)
}

/// Returns the time of the last report before a month's. Jobs entered after it belong to the next
/// report, whenever they were completed.
async fn find_last_report(
    app: &App,
    operator: OperatorId,
    month: NaiveDate,
) -> Result<Option<Time>> {
    let found = row!(
        &app.db,
        (Time,),
        "SELECT made_at FROM monthly_reports
         WHERE operator_id = $1 AND month < $2
         ORDER BY month DESC
         LIMIT 1",
        operator,
        month_name(month)
    )?;
    Ok(found.map(|(made_at,)| made_at))
}

/// Returns those who were recipients before the month ended.
async fn list_recipients(
    tx: &mut Tx,
    operator: OperatorId,
    ended: Time,
) -> Result<Vec<(RecipientId,)>> {
    Ok(rows!(
        in tx,
        (RecipientId,),
        "SELECT id FROM report_recipients
         WHERE operator_id = $1 AND created_at < $2
         ORDER BY id",
        operator,
        ended
    )?)
}

/// Returns the first day of the last complete month, and its end. `None` in the first hours of the
/// next month, when late samples may be in transit.
fn last_month(now: DateTime<Utc>) -> Option<(NaiveDate, Time)> {
    let today = now.date_naive();
    if today.day() == 1 && now.hour() < FIRST_HOUR {
        return None;
    }
    let first = today.with_day(1)?;
    let month = (first - Days::new(1)).with_day(1)?;
    let ended = first.and_time(NaiveTime::MIN).and_utc().timestamp_micros();
    Some((month, Time(Timestamp::from_micros(ended).ok()?)))
}

fn next_month(month: NaiveDate) -> NaiveDate {
    let next = month + Days::new(31);
    next.with_day(1).unwrap_or(next)
}

/// Returns the name of a month, such as `2026-11`.
fn month_name(month: NaiveDate) -> String {
    month.format("%Y-%m").to_string()
}

impl Report {
    /// Returns the text of the letter, one figure a line.
    fn letter_text(&self) -> String {
        let pressing = self.due.iter().filter(|due| due.is_pressing()).count();
        let largest = self.deviation.first().and_then(|one| {
            let size = binnacle_drawing::angles::east_west(one.deviation_deg?);
            Some(format!("{size} on {}", one.vessel_name))
        });
        let lines = [
            format!(
                "Fleet:              {} vessels, {} compasses",
                self.vessels, self.compasses
            ),
            format!("Due for adjustment: {pressing} soon or overdue"),
            format!(
                "Greatest deviation: {}",
                largest.as_deref().unwrap_or("unknown")
            ),
            format!("Adjusted:           {}", self.jobs.len()),
            format!(
                "Saved:              {:.0} euros, {:.1} hours",
                self.saved.saved_eur, self.saved.saved_h
            ),
        ];
        lines.join("\n") + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_month_is_over_from_six_on_the_first_of_the_next() {
        let of = |text: &str| {
            let now = Timestamp::parse(text).unwrap().to_chrono();
            last_month(now).map(|(month, ended)| (month_name(month), ended.0.to_string()))
        };
        let november = Some(("2026-11".to_owned(), "2026-12-01T00:00:00Z".to_owned()));
        assert_eq!(of("2026-12-01T05:59:59Z"), None);
        assert_eq!(of("2026-12-01T06:00:00Z"), november);
        assert_eq!(of("2026-12-31T23:59:59Z"), november);
        let december = Some(("2026-12".to_owned(), "2027-01-01T00:00:00Z".to_owned()));
        assert_eq!(of("2027-01-02T00:00:00Z"), december);
        assert_eq!(
            month_name(next_month(NaiveDate::from_ymd_opt(2026, 12, 1).unwrap())),
            "2027-01"
        );
        assert_eq!(
            month_name(next_month(NaiveDate::from_ymd_opt(2027, 2, 1).unwrap())),
            "2027-03"
        );
    }
}
