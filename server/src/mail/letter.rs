//! What a letter says: plain text, so that every program shows it the same.

use crate::alerts::{AlertChange, Severity};
use crate::ids::OperatorId;
use crate::outbox::Kind;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// Columns that text is wrapped to.
const WIDTH: usize = 72;

/// A letter as it waits to be sent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Letter {
    pub(super) subject: String,
    pub(super) text: String,
    /// What it tells of, one after the other, if that is several things.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) told: Vec<Told>,
    /// The page to look at, below the dashboard's address.
    pub(super) path: String,
    /// The alert or the order that it is about: mail programs show its letters together.
    #[serde(alias = "alert")]
    pub(super) about: Option<Uuid>,
    /// The report that goes with it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) report: Option<Attached>,
}

/// One of the things of which a letter tells.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Told {
    /// In a line.
    pub(super) head: String,
    pub(super) text: String,
    /// The page to look at, below the dashboard's address.
    pub(super) path: String,
}

impl Told {
    fn text(&self, public_url: &str) -> String {
        let indented = |line: &str| format!("  {line}\n").trim_end().to_owned() + "\n";
        let lines: String = self.text.lines().map(indented).collect();
        let head = wrapped("- ", &self.head);
        format!("{head}\n\n{lines}\n  {public_url}{}\n\n", self.path)
    }
}

/// A monthly report that goes with a letter.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Attached {
    pub(super) operator: OperatorId,
    pub(super) month: String,
}

/// Why somebody gets a letter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Why {
    /// Someone is on the company's list for alerts from a severity on.
    Listed(Severity),
    /// It is what a person with an account is told of.
    Person,
    /// Someone is on the company's list for monthly reports.
    Reports,
}

impl Letter {
    /// What is new about an alert.
    pub(super) fn of(news: &AlertChange) -> Letter {
        let alert = &news.alert;
        let (subject, text) = words_of(news);
        Letter {
            subject: header(&subject),
            text,
            told: Vec::new(),
            path: format!("/vessels/{}", alert.vessel_id),
            about: Some(alert.id.0),
            report: None,
        }
    }

    /// What somebody gets who asked for a test.
    pub(super) fn test() -> Letter {
        Letter {
            subject: "A test of Binnacle's mail".to_owned(),
            text: "This is a test: alerts of your fleet's compasses reach this address.\n"
                .to_owned(),
            told: Vec::new(),
            path: "/mail".to_owned(),
            about: None,
            report: None,
        }
    }

    /// The whole text, with where to look and why the recipient gets it.
    pub(super) fn text_for(&self, address: &str, why: Why, public_url: &str) -> String {
        let (why, page) = match why {
            Why::Listed(least) => (
                format!(
                    "You get this because {address} is on your company's list for alerts from {} \
                     on. An administrator takes it off:",
                    name(least)
                ),
                "/mail",
            ),
            Why::Person => (
                format!("You get this because of what {address} is to be told of. You choose it:"),
                "/settings",
            ),
            Why::Reports => (
                format!(
                    "You get this because {address} is on your company's list for monthly reports. \
                     An administrator takes it off:"
                ),
                "/reports",
            ),
        };
        let told: String = self.told.iter().map(|one| one.text(public_url)).collect();
        format!(
            "{told}{}\n{public_url}{}\n\n{}\n{public_url}{page}\n",
            self.text,
            self.path,
            wrapped("", &why)
        )
    }
}

/// What is new about an alert: in a line, and in full.
pub fn words_of(news: &AlertChange) -> (String, String) {
    let alert = &news.alert;
    let state = match (news.kind, news.was) {
        (Kind::AlertCleared, _) if alert.is_over() => "over".to_owned(),
        (Kind::AlertCleared, _) => "closed".to_owned(),
        (_, Some(was)) if was > alert.severity => format!("only {} now", name(alert.severity)),
        _ => name(alert.severity).to_owned(),
    };
    let subject = format!("{}: {state}, {}", alert.vessel_name, alert.cause.title());
    (one_line(&subject), text(news))
}

/// A subject as it goes into a header: a name that looks like an encoded word (RFC 2047,
/// section 2) is none.
pub(super) fn header(subject: &str) -> String {
    one_line(subject).replace("=?", "= ?")
}

fn text(news: &AlertChange) -> String {
    let AlertChange { alert, kind, .. } = news;
    let before = news.was.map(|was| format!(" ({} before)", name(was)));
    let mut lines = vec![
        format!("Vessel:   {}", one_line(&alert.vessel_name)),
        format!("Compass:  {}", one_line(&alert.compass_name)),
        format!(
            "Severity: {}{}",
            name(alert.severity),
            before.unwrap_or_default()
        ),
        format!("Since:    {}", alert.since.to_the_minute()),
    ];
    if let (Kind::AlertCleared, Some(cleared_at)) = (*kind, alert.cleared_at) {
        let word = if alert.is_over() {
            "Over:  "
        } else {
            "Closed:"
        };
        lines.push(format!("{word}   {}", cleared_at.to_the_minute()));
        let by = alert.cleared_by.as_deref().unwrap_or("Binnacle");
        let reason = alert.clearing_reason.as_deref().unwrap_or("it is over");
        let why = format!("Cleared by {by}: {reason}");
        lines.extend([String::new(), wrapped("", &why), String::new()]);
        lines.extend(["It said:".to_owned(), wrapped("  ", &alert.summary)]);
        return lines.join("\n") + "\n";
    }
    lines.extend([String::new(), wrapped("", &alert.summary), String::new()]);
    lines.extend(["What to do:".to_owned(), wrapped("  ", &alert.advice)]);
    if !alert.evidence.0.is_empty() {
        lines.extend([String::new(), "What shows it:".to_owned()]);
        let points = alert.evidence.0.iter();
        lines.extend(points.map(|point| wrapped("- ", point)));
    }
    lines.join("\n") + "\n"
}

fn name(severity: Severity) -> &'static str {
    match severity {
        Severity::Notice => "notice",
        Severity::Warning => "warning",
        Severity::Critical => "critical",
    }
}

/// Without anything that could end a line.
pub fn one_line(text: &str) -> String {
    let shown = |c: char| {
        if c.is_control() || "\u{2028}\u{2029}".contains(c) {
            ' '
        } else {
            c
        }
    };
    text.chars().map(shown).collect()
}

/// Lines of at most [`WIDTH`] columns, the first after `lead`, the others indented
/// alike.
pub(super) fn wrapped(lead: &str, text: &str) -> String {
    let mut lines = Vec::new();
    let mut line = lead.to_owned();
    let mut empty = true;
    for word in one_line(text).split_whitespace() {
        if !empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            lines.push(std::mem::replace(&mut line, " ".repeat(lead.len())));
            empty = true;
        }
        if !empty {
            line.push(' ');
        }
        line.push_str(word);
        empty = false;
    }
    lines.push(line);
    lines.join("\n")
}
