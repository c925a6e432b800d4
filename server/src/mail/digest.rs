//! The letter of one notification, or of several together.

use super::letter::{Letter, header, one_line, wrapped};
use crate::error::Result;
use crate::notifications::Notification;

/// More than so many are counted and not told one by one.
const MOST_TOLD: usize = 60;

/// The letter that tells of them, as it waits to be sent; none of none.
pub fn letter_of(told: &[Notification]) -> Option<Result<String>> {
    let letter = match told {
        [] => return None,
        [one] => Letter {
            subject: header(&one.subject),
            text: one.text.clone(),
            path: one.path.clone(),
            report: None,
            about: one.alert_id.map(|id| id.0).or(one.order_id.map(|id| id.0)),
        },
        all => together(all),
    };
    Some(serde_json::to_string(&letter).map_err(Into::into))
}

/// The last first: what came of a thing stands before how it began.
fn together(all: &[Notification]) -> Letter {
    let mut lines = Vec::new();
    for one in all.iter().rev().take(MOST_TOLD) {
        let subject = one_line(&one.subject);
        lines.push(wrapped(
            "- ",
            &format!("{subject} ({})", one.created_at.to_the_minute()),
        ));
    }
    if all.len() > MOST_TOLD {
        lines.push(String::new());
        lines.push(format!("And {} more.", all.len() - MOST_TOLD));
    }
    let urgent = all.iter().any(|one| one.urgent);
    let first = if urgent { "Urgent: " } else { "" };
    Letter {
        subject: format!("{first}{} notifications from Binnacle", all.len()),
        text: lines.join("\n") + "\n",
        path: "/notifications".to_owned(),
        about: None,
        report: None,
    }
}
