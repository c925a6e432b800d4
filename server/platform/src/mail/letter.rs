//! The content of a letter: plain text, so that every mail program shows it the same.

use super::mailing_list::{FileReference, MailingList};
use crate::severity::Severity;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// Columns that text is wrapped to.
const WIDTH: usize = 72;

/// A letter as it waits to be sent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Letter {
    /// Subject line.
    pub subject: String,
    /// The text.
    pub text: String,
    /// Items of a letter about several things, in order.
    #[serde(rename = "told", default, skip_serializing_if = "Vec::is_empty")]
    pub items: Vec<LetterItem>,
    /// The page to look at, below the dashboard's address.
    pub path: String,
    /// The alert or the order that it is about: mail programs show its letters together.
    #[serde(alias = "alert")]
    pub about: Option<Uuid>,
    /// Files that go with it.
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
    /// The page to look at, below the dashboard's address.
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
pub(super) enum Why {
    /// Someone is on the company's list for alerts from a severity on.
    Listed(Severity),
    /// Someone with an account chose this notification.
    Person,
    /// Someone is on another list of the company.
    MailingList(MailingList),
}

impl Letter {
    /// Returns the letter for a requested test.
    pub(super) fn test() -> Letter {
        Letter {
            subject: "Test mail from Binnacle".to_owned(),
            text: "This is a test: alerts of your fleet's compasses reach this address.\n"
                .to_owned(),
            items: Vec::new(),
            path: "/mail".to_owned(),
            about: None,
            files: None,
        }
    }

    /// The whole text, with where to look and why the recipient gets it.
    pub(super) fn text_for(&self, address: &str, why: Why, public_url: &str) -> String {
        let (why, page) = match why {
            Why::Listed(least) => (
                format!(
                    "You get this because {address} is on your company's list for alerts from {least} \
                     on. An administrator takes it off:"
                ),
                "/mail",
            ),
            Why::Person => (
                format!(
                    "You get this because of the notification settings of {address}. Change them:"
                ),
                "/settings",
            ),
            Why::MailingList(list) => (
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
            wrapped("", &why)
        )
    }
}

/// A subject as it goes into a header: a name that looks like an encoded word (RFC 2047,
/// section 2) is none.
pub fn header(subject: &str) -> String {
    one_line(subject).replace("=?", "= ?")
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

/// Lines of at most 72 columns, the first after `lead`, the others indented
/// alike.
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
