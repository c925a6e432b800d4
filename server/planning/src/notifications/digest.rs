//! The letter of one notification, or of several together.

use super::Notification;
use binnacle_platform::error::Result;
use binnacle_platform::mail::{Letter, LetterItem, header, one_line, wrapped};

/// Notifications that a letter gives in full; further ones get a line each up to `MOST_LISTED`,
/// and the rest are only counted.
const MOST_IN_FULL: usize = 20;
const MOST_LISTED: usize = 60;

/// The letter that tells of them, as it waits to be sent; none of none.
pub(super) fn letter_of(told: &[Notification]) -> Option<Result<String>> {
    let letter = match told {
        [] => return None,
        [one] => Letter {
            subject: header(&one.subject),
            text: one.text.clone(),
            items: Vec::new(),
            path: one.path.clone(),
            files: None,
            about: one.alert_id.map(|id| id.0).or(one.order_id.map(|id| id.0)),
        },
        all => together(all),
    };
    Some(serde_json::to_string(&letter).map_err(Into::into))
}

/// The last first: what came of a thing stands before how it began.
fn together(all: &[Notification]) -> Letter {
    let head = |one: &Notification| {
        let subject = one_line(&one.subject);
        format!("{subject} ({})", one.created_at.to_the_minute())
    };
    let last_first = || all.iter().rev();
    let told = last_first().take(MOST_IN_FULL).map(|one| LetterItem {
        head: head(one),
        text: one.text.clone(),
        path: one.path.clone(),
    });
    let in_a_line = last_first().take(MOST_LISTED).skip(MOST_IN_FULL);
    let mut lines: Vec<String> = in_a_line.map(|one| wrapped("- ", &head(one))).collect();
    if all.len() > MOST_LISTED {
        lines.push(String::new());
        lines.push(format!("And {} more.", all.len() - MOST_LISTED));
    }
    if !lines.is_empty() {
        lines.push(String::new());
    }
    lines.push("All of them:".to_owned());
    let urgent = all.iter().any(|one| one.urgent);
    let first = if urgent { "Urgent: " } else { "" };
    Letter {
        subject: format!("{first}{} notifications from Binnacle", all.len()),
        text: lines.join("\n"),
        items: told.collect(),
        path: "/notifications".to_owned(),
        about: None,
        files: None,
    }
}
