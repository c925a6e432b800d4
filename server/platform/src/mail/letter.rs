//! Content of a letter: plain text, which every mail program shows alike.

use super::mailing_list::{FileReference, MailingList, TopicList};
use crate::severity::Severity;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// Width of wrapped text, columns.
const WIDTH: usize = 72;

/// Letter in the outbox.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Letter {
    /// Subject line.
    pub subject: String,
    /// The text.
    pub text: String,
    /// Items of a letter about several things, in order.
    #[serde(rename = "told", default, skip_serializing_if = "Vec::is_empty")]
    pub items: Vec<LetterItem>,
    /// Page of the dashboard to link to.
    pub path: String,
    /// Id of what the letter is about: mail programs group the letters about it.
    #[serde(alias = "alert")]
    pub about: Option<Uuid>,
    /// Files to attach.
    #[serde(rename = "report", default, skip_serializing_if = "Option::is_none")]
    pub files: Option<FileReference>,
}

/// Item of a letter about several things.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LetterItem {
    /// Heading, one line.
    pub head: String,
    /// The text.
    pub text: String,
    /// Page of the dashboard to link to.
    pub path: String,
}

impl LetterItem {
    fn text(&self, public_url: &str) -> String {
        let indented = |line: &str| format!("  {line}\n").trim_end().to_owned() + "\n";
        let lines: String = self.text.lines().map(indented).collect();
        let head = wrapped("- ", &self.head);
        format!("{head}\n\n{lines}\n  {public_url}{}\n\n", self.path)
    }
}

/// Reason for which a recipient gets a letter.
#[derive(Clone, Copy, Debug)]
pub(super) enum Reason {
    /// The recipient is on the company's list for topics of a minimum severity.
    Listed(TopicList, Severity),
    /// The recipient has an account and chose this notification.
    Person,
    /// The recipient is on another list of the company.
    MailingList(MailingList),
}

impl Letter {
    /// Returns the letter for a requested test.
    pub(super) fn test(list: TopicList) -> Letter {
        Letter {
            subject: "Test mail from Binnacle".to_owned(),
            text: format!("This is a test: {}.\n", list.promise),
            items: Vec::new(),
            path: "/mail".to_owned(),
            about: None,
            files: None,
        }
    }

    /// Returns the whole text, with a link and the reason why the recipient gets it.
    pub(super) fn text_for(&self, address: &str, reason: Reason, public_url: &str) -> String {
        let (reason, page) = match reason {
            Reason::Listed(list, least) => (
                format!(
                    "You get this because {address} is on your company's list for {} from {least} \
                     on. An administrator takes it off:",
                    list.subject
                ),
                "/mail",
            ),
            Reason::Person => (
                format!(
                    "You get this because of the notification settings of {address}. Change them:"
                ),
                "/settings",
            ),
            Reason::MailingList(list) => (
                format!(
                    "You get this because {address} is on your company's list for {}. \
                     An administrator takes it off:",
                    list.subject
                ),
                list.page,
            ),
        };
        let items: String = self
            .items
            .iter()
            .map(|item| item.text(public_url))
            .collect();
        format!(
            "{items}{}\n{public_url}{}\n\n{}\n{public_url}{page}\n",
            self.text,
            self.path,
            wrapped("", &reason)
        )
    }
}

/// Returns a subject for a header: text that looks like an encoded word (RFC 2047, section 2)
/// is broken up.
pub fn header(subject: &str) -> String {
    one_line(subject).replace("=?", "= ?")
}

/// Returns the text with every character that could end a line replaced by a blank.
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

/// Wraps text to 72 columns. The first line begins with `lead`, the others are indented to
/// match.
pub fn wrapped(lead: &str, text: &str) -> String {
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
