//! Text of an announced alert: letter, webhook message and notice.

use super::alert::Alert;
use super::change::{AlertChange, ChangeKind};
use binnacle_platform::ids::{DeliveryId, OperatorId};
use binnacle_platform::mail::{Announcement, Letter, Phase, TopicList, header, one_line, wrapped};
use binnacle_platform::notices::{DeclaredKind, DefaultMail, Notice, NoticesPublished, Readers};
use binnacle_platform::outbox::{Kind, Message};
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;
use binnacle_platform::webhooks::Words;
use serde::Serialize;
use serde_json::json;
use utoipa::ToSchema;

/// An alert of severity warning or worse is raised, becomes critical, sinks to a notice, or is
/// over. Critical alerts are sent at once.
pub const NOTICE_KIND: DeclaredKind =
    DeclaredKind::new("alert", Readers::Operators, DefaultMail::Recipients);

/// List of those who get mail about alerts.
pub const TOPIC_LIST: TopicList = TopicList {
    subject: "alerts",
    promise: "alerts of your fleet's compasses reach this address",
};

/// Message of an alert for webhooks.
#[derive(Serialize, ToSchema)]
pub struct AlertMessage<'a> {
    /// Id of the message: the same in each attempt.
    id: DeliveryId,
    /// Kind.
    kind: Kind,
    /// Time of the event.
    at: Time,
    /// The message in words.
    words: Words,
    /// The alert at that moment.
    alert: &'a Alert,
}

/// Returns the message for webhooks.
pub(super) fn message(change: &AlertChange, now: Time) -> Message {
    let AlertChange {
        id, kind, alert, ..
    } = change;
    let kind = kind.message_kind();
    Message {
        id: *id,
        kind,
        about: None,
        body: json!(AlertMessage {
            id: *id,
            kind,
            at: now,
            words: Words {
                headline: words_of(change).0,
                text: alert.summary.clone(),
                path: format!("/alerts#{}", alert.id),
            },
            alert,
        })
        .to_string(),
    }
}

/// Returns the announcement for those who get mail about alerts, if the change is announced.
pub(super) fn announcement(change: &AlertChange) -> Option<Announcement> {
    let phase = match change.kind {
        ChangeKind::Raised => Phase::Started,
        ChangeKind::Updated => Phase::Updated,
        ChangeKind::Cleared => Phase::Ended,
        ChangeKind::Acknowledged => return None,
    };
    let alert = &change.alert;
    let (subject, text) = words_of(change);
    Some(Announcement {
        id: change.id,
        kind: change.kind.message_kind(),
        phase,
        topic: alert.id.0,
        series: series(alert),
        severity: alert.severity,
        letter: Letter {
            subject: header(&subject),
            text,
            items: Vec::new(),
            path: format!("/vessels/{}", alert.vessel_id),
            about: Some(alert.id.0),
            files: None,
        },
    })
}

/// Names the series of alerts with the same compass and cause.
fn series(alert: &Alert) -> String {
    format!("{}: {:?}", alert.compass_id, alert.cause)
}

/// Returns the notices for the operator's people.
pub(super) fn notices(
    operator: OperatorId,
    changes: &[AlertChange],
    now: Time,
) -> NoticesPublished {
    NoticesPublished {
        tenant: operator.into(),
        notices: changes.iter().filter_map(notice).collect(),
        by: None,
        at: now,
    }
}

fn notice(change: &AlertChange) -> Option<Notice> {
    let alert = &change.alert;
    let critical = alert.severity == Severity::Critical;
    let is_urgent = alert.severity >= Severity::Warning;
    let was_urgent = change.was.is_some_and(|was| was >= Severity::Warning);
    let is_announced = match change.kind {
        ChangeKind::Raised | ChangeKind::Cleared => is_urgent,
        // People who were notified hear once that it is less urgent, now or when it is over.
        ChangeKind::Updated => critical || is_urgent != was_urgent,
        ChangeKind::Acknowledged => false,
    };
    let (subject, text) = words_of(change);
    is_announced.then(|| Notice {
        kind: NOTICE_KIND,
        urgent: critical && change.kind != ChangeKind::Cleared,
        subject,
        text,
        path: format!("/vessels/{}", alert.vessel_id),
        vessel: Some(alert.vessel_id),
        about: Some(alert.id.0),
    })
}

/// Returns a change of an alert in a line, and in full.
fn words_of(change: &AlertChange) -> (String, String) {
    let alert = &change.alert;
    let state = match (change.kind, change.was) {
        (ChangeKind::Cleared, _) if alert.is_over() => "over".to_owned(),
        (ChangeKind::Cleared, _) => "closed".to_owned(),
        (_, Some(was)) if was > alert.severity => format!("only {} now", alert.severity),
        _ => alert.severity.to_string(),
    };
    let subject = format!("{}: {state}, {}", alert.vessel_name, alert.cause.title());
    (one_line(&subject), text(change))
}

fn text(change: &AlertChange) -> String {
    let AlertChange { alert, kind, .. } = change;
    let before = change.was.map(|was| format!(" ({was} before)"));
    let mut lines = vec![
        format!("Vessel:   {}", one_line(&alert.vessel_name)),
        format!("Compass:  {}", one_line(&alert.compass_name)),
        format!("Severity: {}{}", alert.severity, before.unwrap_or_default()),
        format!("Since:    {}", alert.since.to_the_minute()),
    ];
    if let (ChangeKind::Cleared, Some(cleared_at)) = (*kind, alert.cleared_at) {
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
