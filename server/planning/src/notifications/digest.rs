//! The letter of one notification, or the digest of several.

use super::notification::Notification;
use binnacle_platform::error::Result;
use binnacle_platform::mail::{Letter, LetterItem, header, one_line, wrapped};

/// Maximum number of notifications in full text; further ones get a line each.
const MAX_IN_FULL: usize = 20;
/// Maximum number of notifications in full text or as a line; the rest are counted.
const MAX_LISTED: usize = 60;

/// Returns the letter of some notifications as the outbox stores it; `None` without any.
pub(super) fn compose_letter(notifications: &[Notification]) -> Option<Result<String>> {
    let letter = match notifications {
        [] => return None,
        [one] => Letter {
            subject: header(&one.subject),
            text: one.text.clone(),
            items: Vec::new(),
            path: one.path.clone(),
            files: None,
            about: one.alert_id.map(|id| id.0).or(one.order_id.map(|id| id.0)),
        },
        several => compose_digest(several),
    };
    Some(serde_json::to_string(&letter).map_err(Into::into))
}

/// Returns one letter of several notifications, the latest first.
fn compose_digest(all: &[Notification]) -> Letter {
    let head = |one: &Notification| {
        let subject = one_line(&one.subject);
        format!("{subject} ({})", one.created_at.to_the_minute())
    };
    let latest_first = || all.iter().rev();
    let in_full = latest_first().take(MAX_IN_FULL).map(|one| LetterItem {
        head: head(one),
        text: one.text.clone(),
        path: one.path.clone(),
    });
    let listed = latest_first().take(MAX_LISTED).skip(MAX_IN_FULL);
    let mut lines: Vec<String> = listed.map(|one| wrapped("- ", &head(one))).collect();
    if all.len() > MAX_LISTED {
        lines.push(String::new());
        lines.push(format!("And {} more.", all.len() - MAX_LISTED));
    }
    if !lines.is_empty() {
        lines.push(String::new());
    }
    lines.push("All of them:".to_owned());
    let urgent = all.iter().any(|one| one.urgent);
    let prefix = if urgent { "Urgent: " } else { "" };
    Letter {
        subject: format!("{prefix}{} notifications from Binnacle", all.len()),
        text: lines.join("\n"),
        items: in_full.collect(),
        path: "/notifications".to_owned(),
        about: None,
        files: None,
    }
}
