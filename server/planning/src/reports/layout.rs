//! A report laid out on sheets of A4.

use super::report::{DueCompass, FeeFrom, Job, Report};
use binnacle_drawing::angles::{east_west, heading};
use binnacle_drawing::paper::{LEFT, LINE, Paper, RIGHT, SIZE};
use binnacle_drawing::{About, Face, Sheet, Style, cut, wrap};
use binnacle_platform::error::Result;
use binnacle_schedule::needs::Urgency;

/// Maximum number of deviations on paper; the CSV has all.
const MAX_DEVIATIONS: usize = 25;
/// Minimum number of lines below a title on its sheet.
const MIN_LINES: usize = 5;
/// Space between two columns, points.
const GAP: f32 = 6.0;

/// Title and left edge of a column.
type Column = (&'static str, f32);

const DUE: [Column; 5] = [
    ("Vessel", LEFT),
    ("Compass", 142.0),
    ("Due", 222.0),
    ("Why", 278.0),
    ("Order", 440.0),
];
const DEVIATION: [Column; 6] = [
    ("Vessel", LEFT),
    ("Compass", 172.0),
    ("On compass heading", 282.0),
    ("Deviation", 366.0),
    ("95 % band", 424.0),
    ("Samples until", 482.0),
];
const JOBS: [Column; 6] = [
    ("Vessel", LEFT),
    ("Compass", 152.0),
    ("Port", 232.0),
    ("Completed", 326.0),
    ("Firm", 388.0),
    ("Fee, euros", 492.0),
];

impl Report {
    /// Returns the report as PDF.
    pub(super) async fn into_pdf(self) -> Result<Vec<u8>> {
        let about = About {
            title: format!(
                "Compass report: {}, {} to {}",
                self.operator_name, self.from, self.to
            ),
            created: self.made_at.0,
        };
        let drawn = move || binnacle_drawing::pdf(&lay_out(&self), &about);
        Ok(tokio::task::spawn_blocking(drawn).await??)
    }
}

fn lay_out(report: &Report) -> Vec<Sheet> {
    let mut paper = Paper::new();
    put_head(&mut paper, report);
    put_due(&mut paper, report);
    put_deviations(&mut paper, report);
    put_jobs(&mut paper, report);
    put_saving(&mut paper, report);
    let made = format!("Made by Binnacle on {}.", report.made_at.to_the_minute());
    let predicted = "Deviations are predicted by each compass's model and are not a certificate.";
    paper.finish(&[format!("{made} {predicted}")])
}

fn put_head(paper: &mut Paper, report: &Report) {
    paper.put(LEFT, Style::bold(15.0), "Compass report");
    let time = format!("{} to {}", report.from, report.to);
    paper.put(RIGHT, Style::plain(9.0).end(), &time);
    paper.down(16.0);
    let name = cut(&report.operator_name, Face::Bold, 10.0, RIGHT - LEFT);
    paper.put(LEFT, Style::bold(10.0), &name);
    paper.down(LINE + 8.0);
    let count = |urgency| {
        report
            .due
            .iter()
            .filter(|due| due.urgency == urgency)
            .count()
    };
    paper.fact(
        "Fleet",
        &format!(
            "{} vessels with {} compasses",
            report.vessels, report.compasses
        ),
    );
    paper.fact(
        "Due for adjustment",
        &format!(
            "{} overdue, {} urgent, {} soon, {} without an adjustment on record",
            count(Urgency::Overdue),
            count(Urgency::Urgent),
            count(Urgency::Soon),
            count(Urgency::Unknown)
        ),
    );
    let unknown = report
        .deviation
        .iter()
        .filter(|one| one.deviation_deg.is_none());
    let largest = report.deviation.first().and_then(|one| {
        Some(format!(
            "{} on {}",
            east_west(one.deviation_deg?),
            one.vessel_name
        ))
    });
    paper.fact(
        "Greatest deviation",
        &largest.unwrap_or_else(|| "unknown".to_owned()),
    );
    let unknown = unknown.count();
    if unknown > 0 {
        paper.fact("Without a model", &format!("{unknown} compasses"));
    }
    paper.fact(
        "Adjusted",
        &format!(
            "{} compasses, {}",
            report.jobs.len(),
            summarise_saving(report)
        ),
    );
}

fn summarise_saving(report: &Report) -> String {
    let saved = &report.saved;
    format!(
        "{} euros and {} hours saved against swinging",
        format_euros(saved.saved_eur),
        format_hours(saved.saved_h)
    )
}

fn put_due(paper: &mut Paper, report: &Report) {
    paper.keep_together(MIN_LINES);
    paper.title("Overdue or due soon");
    let (now, later): (Vec<&DueCompass>, Vec<&DueCompass>) =
        report.due.iter().partition(|due| due.is_pressing());
    if now.is_empty() {
        paper.lines(LEFT, Style::plain(SIZE), "No compass.");
    } else {
        put_titles(paper, &DUE);
    }
    for due in now {
        let on = match due.urgency {
            Urgency::Overdue => Style::bold(SIZE),
            _ => Style::plain(SIZE),
        };
        let order = due.order.as_ref().map_or_else(
            || "none".to_owned(),
            |order| {
                let firm = order.firm.as_deref();
                let firm = firm.map_or_else(String::new, |firm| format!(", {firm}"));
                format!("{}, {}{firm}", order.planned_at.day(), order.port)
            },
        );
        let cells = [
            (due.vessel_name.clone(), Style::plain(SIZE)),
            (due.compass_name.clone(), Style::plain(SIZE)),
            (due.due_on.to_string(), on),
            (due.reason.clone(), Style::plain(SIZE)),
            (order, Style::plain(SIZE)),
        ];
        put_row(paper, &DUE, &cells);
    }
    if !later.is_empty() {
        let note = format!("{} more compasses are due later.", later.len());
        paper.lines(LEFT, Style::plain(SIZE).grey(90), &note);
    }
}

fn put_deviations(paper: &mut Paper, report: &Report) {
    paper.keep_together(MIN_LINES);
    paper.title("Greatest deviation");
    let known = report
        .deviation
        .iter()
        .filter(|one| one.deviation_deg.is_some());
    let (all, shown) = (known.clone().count(), known.take(MAX_DEVIATIONS));
    if all == 0 {
        paper.lines(LEFT, Style::plain(SIZE), "No compass has a model.");
    } else {
        put_titles(paper, &DEVIATION);
    }
    for one in shown {
        let band = one.band95_deg;
        let cells = [
            one.vessel_name.clone(),
            one.compass_name.clone(),
            one.compass_deg.map_or_else(String::new, heading),
            one.deviation_deg.map_or_else(String::new, east_west),
            band.map_or_else(|| "unknown".to_owned(), |band| format!("±{band:.1}°")),
            one.data_until
                .map_or_else(String::new, binnacle_platform::time::Time::day),
        ];
        put_row(
            paper,
            &DEVIATION,
            &cells.map(|cell| (cell, Style::plain(SIZE))),
        );
    }
    if all > MAX_DEVIATIONS {
        let note = format!(
            "{} more compasses have smaller deviations.",
            all - MAX_DEVIATIONS
        );
        paper.lines(LEFT, Style::plain(SIZE).grey(90), &note);
    }
}

fn put_jobs(paper: &mut Paper, report: &Report) {
    paper.keep_together(MIN_LINES);
    paper.title("Adjusted in this period");
    if report.jobs.is_empty() {
        paper.lines(LEFT, Style::plain(SIZE), "No compass.");
        return;
    }
    put_titles(paper, &JOBS);
    for job in &report.jobs {
        let cells = [
            job.vessel_name.clone(),
            job.compass_name.clone(),
            job.port.clone(),
            job.completed_at.day(),
            job.firm.clone().unwrap_or_default(),
            format_fee(job),
        ];
        put_row(paper, &JOBS, &cells.map(|cell| (cell, Style::plain(SIZE))));
    }
}

fn format_fee(job: &Job) -> String {
    match (job.fee_eur, job.fee_from) {
        (Some(eur), Some(FeeFrom::Terms)) => format!("{} (usual)", format_euros(eur)),
        (Some(eur), _) => format_euros(eur),
        (None, _) => "unknown".to_owned(),
    }
}

fn put_saving(paper: &mut Paper, report: &Report) {
    let saved = &report.saved;
    paper.keep_together(MIN_LINES);
    paper.title("Saved against swinging");
    let failed = report.jobs.len() - saved.jobs;
    let mut sentences = vec![format!(
        "Adjustments at the berth: {}. Swings avoided, one for all compasses of a vessel at a \
         visit: {}, at {} euros and {} hours each: {} euros. Less {} euros of fees: {} euros \
         saved, and {} hours of vessels' time.",
        saved.jobs,
        saved.swings,
        format_euros(saved.swing_eur),
        format_hours(saved.swing_h),
        format_euros(saved.swings as f64 * saved.swing_eur),
        format_euros(saved.fees_eur),
        format_euros(saved.saved_eur),
        format_hours(saved.saved_h)
    )];
    if failed > 0 {
        sentences.push(format!(
            "Not confirmed at sea, counted with their fees only: {failed}."
        ));
    }
    if saved.without_fee > 0 {
        sentences.push(format!("Jobs with unknown fees: {}.", saved.without_fee));
    }
    paper.lines(LEFT, Style::plain(SIZE), &sentences.join(" "));
}

fn put_titles(paper: &mut Paper, columns: &[Column]) {
    paper.keep_together(2);
    for (title, x) in columns {
        paper.put(*x, Style::plain(7.0).grey(90), title);
    }
    paper.down(LINE);
}

fn put_row(paper: &mut Paper, columns: &[Column], cells: &[(String, Style)]) {
    let wrapped: Vec<Vec<String>> = columns
        .iter()
        .zip(cells)
        .enumerate()
        .map(|(index, ((_, x), (text, style)))| {
            let end = columns.get(index + 1).map_or(RIGHT, |(_, next)| next - GAP);
            wrap(text, style.face, style.size, end - x)
        })
        .collect();
    let lines = wrapped.iter().map(Vec::len).max().unwrap_or(0).max(1);
    paper.keep_together(lines);
    for line in 0..lines {
        for (((_, x), (_, style)), cell) in columns.iter().zip(cells).zip(&wrapped) {
            if let Some(text) = cell.get(line) {
                paper.put(*x, *style, text);
            }
        }
        paper.down(LINE);
    }
}

/// Formats whole euros with digits in groups of three.
fn format_euros(eur: f64) -> String {
    let digits = format!("{:.0}", eur.abs());
    let groups = digits.as_bytes().rchunks(3).rev();
    let groups: Vec<String> = groups
        .map(|group| String::from_utf8_lossy(group).into_owned())
        .collect();
    let sign = if eur <= -0.5 { "−" } else { "" };
    format!("{sign}{}", groups.join(","))
}

fn format_hours(hours: f64) -> String {
    let text = format!("{hours:.1}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_reason_is_printed_whole() {
        let reason = "24 months after the adjustment of 2025-01-15 (ISO 25862:2019, Annex G), \
                      brought forward by welding near the compass";
        let plain = |text: &str| (text.to_owned(), Style::plain(SIZE));
        let cells = ["Nao", "Standard compass", "2026-12-20", reason, "none"].map(plain);
        let mut paper = Paper::new();
        put_row(&mut paper, &DUE, &cells);
        put_row(&mut paper, &DUE, &cells);
        let printed = binnacle_drawing::svg(&paper.finish(&[]), "");
        for word in reason.split_whitespace() {
            assert!(printed.contains(word), "{word}: {printed}");
        }
        assert!(!printed.contains('…'), "{printed}");
    }

    #[test]
    fn money_is_written_in_groups_with_its_sign() {
        let all = [0.0, 12.4, 999.6, 6000.0, 1_234_567.0, -4200.0].map(format_euros);
        assert_eq!(all, ["0", "12", "1,000", "6,000", "1,234,567", "−4,200"]);
        assert_eq!([3.0, 7.5].map(format_hours), ["3", "7.5"]);
    }
}
