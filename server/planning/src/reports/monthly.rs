//! The report of each month by mail, after its end.
//!
//! What always holds: the report of a month is made once, kept as it was mailed, and sent
//! to those who were on the list before the month ended; a server that was away sends the
//! last month's when it is back.

use super::gather::gather;
use super::mailing_list;
use super::report::Report;
use super::{Table, csv};
use binnacle_compass::time::Timestamp;
use binnacle_platform::app::App;
use binnacle_platform::db::{Tx, execute, row, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{DeliveryId, OperatorId, RecipientId};
use binnacle_platform::outbox::{self, Kind, Message};
use binnacle_platform::time::Time;
use chrono::{DateTime, Datelike, Days, NaiveDate, NaiveTime, Timelike, Utc};
use std::time::Duration;
use tracing::error;

/// Interval between checks for the end of a month.
const LOOK_EVERY: Duration = Duration::from_mins(10);
/// On the first day of a month not before this hour, UTC: late batches of the night before
/// have come, and nobody is woken in Europe.
const FIRST_HOUR: u32 = 6;

/// Makes monthly reports until the server stops.
pub async fn watch(app: App) {
    while !app.stopping.is_cancelled() {
        if let Err(error) = look(&app).await {
            error!(?error, "monthly reports cannot be made");
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(LOOK_EVERY) => {}
        }
    }
}

/// Makes and queues the reports of the month that is over, where that is not done; how many.
pub async fn look(app: &App) -> Result<usize> {
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
        name(month)
    )?;
    let mut made = 0;
    for (operator,) in due {
        match make(app, operator, month, ended).await {
            Ok(is_new) => made += usize::from(is_new),
            // It is tried again at the next look, and holds up no other operator's.
            Err(error) => error!(?error, %operator, "a monthly report cannot be made"),
        }
    }
    Ok(made)
}

/// False when another process was faster.
async fn make(app: &App, operator: OperatorId, month: NaiveDate, ended: Time) -> Result<bool> {
    let last = month_after(month) - Days::new(1);
    let before = last_made(app, operator, month).await?;
    let report = gather(app, operator, (month, last), before).await?;
    let letter = mailing_list::letter(&report.words(), operator, &name(month));
    let tables = [Table::Due, Table::Deviation, Table::Jobs];
    let [due, deviation, jobs] = tables.map(|table| csv::table(&report, table));
    let (due, deviation, jobs) = (due?, deviation?, jobs?);
    let (made_at, pdf) = (report.made_at, report.printed().await?);
    let mut tx = app.db.begin().await?;
    let kept = execute!(
        &mut tx,
        "INSERT INTO monthly_reports (operator_id, month, made_at, pdf, due_csv, deviation_csv,
                                      jobs_csv)
         VALUES ($1, $2, $3, $4, $5, $6, $7)
         ON CONFLICT (operator_id, month) DO NOTHING",
        operator,
        name(month),
        made_at,
        pdf,
        due,
        deviation,
        jobs
    )?;
    if kept == 0 {
        return Ok(false);
    }
    let body = serde_json::to_string(&letter)?;
    for (recipient,) in recipients(&mut tx, operator, ended).await? {
        let message = Message {
            id: DeliveryId::new(),
            kind: Kind::Report,
            order: None,
            body: body.clone(),
        };
        outbox::queue(&mut tx, recipient.0, &message, made_at).await?;
    }
    tx.commit().await?;
    Ok(true)
}

/// Returns the time of the last report before a month's. Jobs entered after it belong to the next
/// report, even when they were done earlier.
async fn last_made(app: &App, operator: OperatorId, month: NaiveDate) -> Result<Option<Time>> {
    let found = row!(
        &app.db,
        (Time,),
        "SELECT made_at FROM monthly_reports
         WHERE operator_id = $1 AND month < $2
         ORDER BY month DESC
         LIMIT 1",
        operator,
        name(month)
    )?;
    Ok(found.map(|(made_at,)| made_at))
}

/// Those who were on the list before the month ended, in the order of their ids.
async fn recipients(tx: &mut Tx, operator: OperatorId, ended: Time) -> Result<Vec<(RecipientId,)>> {
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

/// The first day of the last month that is over, and when it ended; none on the first hours
/// of the next one, when its last samples may be on their way.
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

fn month_after(month: NaiveDate) -> NaiveDate {
    let next = month + Days::new(31);
    next.with_day(1).unwrap_or(next)
}

/// As people and the database name a month: `2026-11`.
fn name(month: NaiveDate) -> String {
    month.format("%Y-%m").to_string()
}

impl Report {
    /// Returns the text of the letter, a fact on each line.
    fn words(&self) -> String {
        let pressing = self.due.iter().filter(|due| due.presses()).count();
        let largest = self.deviation.first().and_then(|one| {
            let size = binnacle_drawing::words::east_west(one.deviation_deg?);
            Some(format!("{size} on {}", one.vessel_name))
        });
        let lines = [
            format!(
                "Fleet:              {} vessels, {} compasses",
                self.vessels, self.compasses
            ),
            format!("To be adjusted:     {pressing} soon, or overdue"),
            format!(
                "Greatest deviation: {}",
                largest.as_deref().unwrap_or("not known")
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
    fn a_month_is_over_on_the_first_of_the_next_from_six_on() {
        let of = |text: &str| {
            let now = Timestamp::parse(text).unwrap().to_chrono();
            last_month(now).map(|(month, ended)| (name(month), ended.0.to_string()))
        };
        let november = Some(("2026-11".to_owned(), "2026-12-01T00:00:00Z".to_owned()));
        assert_eq!(of("2026-12-01T05:59:59Z"), None);
        assert_eq!(of("2026-12-01T06:00:00Z"), november);
        assert_eq!(of("2026-12-31T23:59:59Z"), november);
        let december = Some(("2026-12".to_owned(), "2027-01-01T00:00:00Z".to_owned()));
        assert_eq!(of("2027-01-02T00:00:00Z"), december);
        assert_eq!(
            name(month_after(NaiveDate::from_ymd_opt(2026, 12, 1).unwrap())),
            "2027-01"
        );
        assert_eq!(
            name(month_after(NaiveDate::from_ymd_opt(2027, 2, 1).unwrap())),
            "2027-03"
        );
    }
}
