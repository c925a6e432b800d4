//! Alerts of bridge alert management (IEC 62923-2): identity, state and commands, and the sentences
//! ALF, ALC and ARC, which are only written.
//!
//! No sentence is longer than the 82 bytes of IEC 61162-1: texts are cut, and an alert list is
//! spread over several sentences.

pub use crate::sentence::{AlertCommand, AlertId};

use crate::checksum;
use crate::print;
use crate::time::TimeOfDay;

/// Longest sentence, with its line end.
pub const MAX_ALERT_SENTENCE_BYTES: usize = 82;
/// Longest title of an alert.
pub const MAX_TITLE_BYTES: usize = 16;
/// Bytes from `*` to the line end.
const END_BYTES: usize = 5;
/// Alerts in one ALC sentence: three of the longest would not fit.
const ENTRIES_PER_SENTENCE: usize = 2;
/// Characters with a meaning of their own in a sentence.
const RESERVED: &[u8] = b"$*,!\\^~";

/// Priority of an alert.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlertPriority {
    /// E.
    Emergency,
    /// A.
    Alarm,
    /// W.
    Warning,
    /// C.
    Caution,
}

/// Category of an alert.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlertCategory {
    /// A: can only be judged at the equipment that raises it.
    A,
    /// B: needs nothing beyond its text.
    B,
    /// C: cannot be acknowledged on the bridge.
    C,
}

/// State of an alert.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlertState {
    /// N: neither active nor waiting for an acknowledgement.
    #[default]
    Normal,
    /// V: active, unacknowledged.
    Unacknowledged,
    /// S: active, silenced.
    Silenced,
    /// A: active, acknowledged.
    Acknowledged,
    /// O: active, responsibility transferred.
    Transferred,
    /// U: no longer active, unacknowledged.
    Rectified,
}

impl AlertState {
    /// The letter in the sentence.
    pub fn letter(self) -> u8 {
        match self {
            AlertState::Normal => b'N',
            AlertState::Unacknowledged => b'V',
            AlertState::Silenced => b'S',
            AlertState::Acknowledged => b'A',
            AlertState::Transferred => b'O',
            AlertState::Rectified => b'U',
        }
    }
}

/// Contents of an alert's ALF sentences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Alert<'a> {
    /// Identity.
    pub id: AlertId,
    /// Time of the last change, UTC.
    pub changed: Option<TimeOfDay>,
    /// Category.
    pub category: AlertCategory,
    /// Priority.
    pub priority: AlertPriority,
    /// State.
    pub state: AlertState,
    /// Revision counter, 1 to 99.
    pub revision: u8,
    /// Escalation counter, 0 to 9.
    pub escalation: u8,
    /// Title, at most [`MAX_TITLE_BYTES`].
    pub title: &'a str,
    /// Description, in a second sentence; empty for none.
    pub description: &'a str,
}

/// Appends an alert's ALF sentences; `message` counts 0 to 9.
pub fn write_alf(talker: [u8; 2], alert: &Alert<'_>, message: u8, out: &mut Vec<u8>) {
    let total = if alert.description.is_empty() { 1 } else { 2 };
    for number in 1..=total {
        let start = begin(talker, *b"ALF", out);
        for count in [total, number, message % 10] {
            print::integer(out, Some(u32::from(count)), 1);
        }
        if number == 1 {
            print::time(out, alert.changed);
            print::text(out, &[category_letter(alert.category)]);
            print::text(out, &[priority_letter(alert.priority)]);
            print::text(out, &[alert.state.letter()]);
        } else {
            print::empty(out, 4);
        }
        identity(alert.id, out);
        print::integer(out, Some(u32::from(alert.revision)), 1);
        print::integer(out, Some(u32::from(alert.escalation)), 1);
        out.push(b',');
        let room = (MAX_ALERT_SENTENCE_BYTES - END_BYTES).saturating_sub(out.len() - start);
        if number == 1 {
            words(alert.title, room.min(MAX_TITLE_BYTES), out);
        } else {
            words(alert.description, room, out);
        }
        end(start, out);
    }
}

/// Appends the ALC sentences of all alerts that are not normal, each with its revision counter;
/// `message` counts 0 to 99.
pub fn write_alc(talker: [u8; 2], alerts: &[(AlertId, u8)], message: u8, out: &mut Vec<u8>) {
    let total = alerts.len().div_ceil(ENTRIES_PER_SENTENCE).clamp(1, 99);
    for number in 1..=total {
        let first = (number - 1) * ENTRIES_PER_SENTENCE;
        let entries = alerts.iter().skip(first).take(ENTRIES_PER_SENTENCE);
        let start = begin(talker, *b"ALC", out);
        for count in [total as u32, number as u32, u32::from(message % 100)] {
            print::integer(out, Some(count), 2);
        }
        print::integer(out, Some(entries.len() as u32), 1);
        for (id, revision) in entries {
            identity(*id, out);
            print::integer(out, Some(u32::from(*revision)), 1);
        }
        end(start, out);
    }
}

/// Appends an ARC sentence: the refusal of a command at `time`.
pub fn write_arc(
    talker: [u8; 2],
    time: Option<TimeOfDay>,
    id: AlertId,
    refused: AlertCommand,
    out: &mut Vec<u8>,
) {
    let start = begin(talker, *b"ARC", out);
    print::time(out, time);
    identity(id, out);
    print::text(out, &[refused.letter()]);
    end(start, out);
}

/// Manufacturer, identifier and instance.
pub(crate) fn identity(id: AlertId, out: &mut Vec<u8>) {
    match &id.manufacturer {
        Some(mnemonic) => print::text(out, mnemonic),
        None => print::empty(out, 1),
    }
    print::integer(out, Some(id.number), 1);
    print::integer(out, id.instance, 1);
}

/// Appends the address and returns where the sentence starts.
fn begin(talker: [u8; 2], code: [u8; 3], out: &mut Vec<u8>) -> usize {
    let start = out.len();
    out.push(b'$');
    out.extend_from_slice(&talker);
    out.extend_from_slice(&code);
    start
}

fn end(start: usize, out: &mut Vec<u8>) {
    let sum = checksum::compute(&out[start + 1..]);
    checksum::append(sum, out);
    out.extend_from_slice(b"\r\n");
}

/// Appends at most `most` bytes of a text, with spaces for what a sentence cannot carry.
fn words(text: &str, most: usize, out: &mut Vec<u8>) {
    let carried = |letter: char| match u8::try_from(letter) {
        Ok(byte) if (b' '..=b'~').contains(&byte) && !RESERVED.contains(&byte) => byte,
        _ => b' ',
    };
    out.extend(text.chars().map(carried).take(most));
}

fn category_letter(category: AlertCategory) -> u8 {
    match category {
        AlertCategory::A => b'A',
        AlertCategory::B => b'B',
        AlertCategory::C => b'C',
    }
}

fn priority_letter(priority: AlertPriority) -> u8 {
    match priority {
        AlertPriority::Emergency => b'E',
        AlertPriority::Alarm => b'A',
        AlertPriority::Warning => b'W',
        AlertPriority::Caution => b'C',
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checksum::checked;

    const ALERT: Alert<'_> = Alert {
        id: AlertId {
            manufacturer: Some(*b"XYZ"),
            number: 10_512,
            instance: Some(1),
        },
        changed: None,
        category: AlertCategory::B,
        priority: AlertPriority::Alarm,
        state: AlertState::Silenced,
        revision: 2,
        escalation: 0,
        title: "HEADING LOST",
        description: "",
    };

    /// Lines without checksum, which is checked.
    fn bodies(out: &[u8]) -> Vec<String> {
        let lines = out.split_inclusive(|byte| *byte == b'\n');
        let body = |line: &[u8]| {
            assert!(line.len() <= MAX_ALERT_SENTENCE_BYTES, "{}", line.len());
            let line = line.strip_suffix(b"\r\n").expect("a line end");
            let body = checked(line.strip_prefix(b"$").expect("a start"));
            String::from_utf8(body.expect("a right checksum").to_vec()).unwrap()
        };
        lines.map(body).collect()
    }

    #[test]
    fn an_alert_has_its_fields_in_their_order() {
        let mut out = Vec::new();
        let alert = Alert {
            changed: TimeOfDay::new(8, 19, 50, 100_000),
            description: "NO SYSTEM HEADING, AVAILABLE*",
            ..ALERT
        };
        write_alf(*b"IN", &alert, 11, &mut out);
        assert_eq!(
            bodies(&out),
            [
                "INALF,2,1,1,081950.10,B,A,S,XYZ,10512,1,2,0,HEADING LOST",
                "INALF,2,2,1,,,,,XYZ,10512,1,2,0,NO SYSTEM HEADING  AVAILABLE ",
            ]
        );
    }

    #[test]
    fn an_alert_of_the_standards_has_no_manufacturer() {
        let alert = Alert {
            id: AlertId {
                manufacturer: None,
                number: 192,
                instance: Some(1),
            },
            changed: TimeOfDay::new(12, 43, 4, 500_000),
            category: AlertCategory::A,
            priority: AlertPriority::Warning,
            state: AlertState::Acknowledged,
            revision: 1,
            title: "LOST TARGET",
            ..ALERT
        };
        let mut out = Vec::new();
        write_alf(*b"VR", &alert, 0, &mut out);
        assert_eq!(
            bodies(&out),
            ["VRALF,1,1,0,124304.50,A,W,A,,192,1,1,0,LOST TARGET"]
        );
    }

    #[test]
    fn texts_are_cut_to_the_longest_sentence() {
        let long = "X".repeat(200);
        let alert = Alert {
            changed: TimeOfDay::new(23, 59, 60, 0),
            id: AlertId {
                manufacturer: Some(*b"XYZ"),
                number: 9_999_999,
                instance: Some(999_999),
            },
            revision: 99,
            escalation: 9,
            title: &long,
            description: &long,
            ..ALERT
        };
        let mut out = Vec::new();
        write_alf(*b"II", &alert, 0, &mut out);
        let [title, description] = &bodies(&out)[..] else {
            panic!("{}", out.escape_ascii())
        };
        assert!(title.ends_with(&format!(",{}", &long[..MAX_TITLE_BYTES])));
        assert_eq!(description.len(), MAX_ALERT_SENTENCE_BYTES - 1 - END_BYTES);
    }

    #[test]
    fn a_list_without_alerts_says_so_and_a_long_one_is_spread() {
        let mut out = Vec::new();
        write_alc(*b"II", &[], 0, &mut out);
        assert_eq!(bodies(&out), ["IIALC,01,01,00,0"]);
        let longest = AlertId {
            manufacturer: Some(*b"XYZ"),
            number: 9_999_999,
            instance: Some(999_999),
        };
        out.clear();
        write_alc(
            *b"II",
            &[(longest, 99), (longest, 1), (ALERT.id, 7)],
            105,
            &mut out,
        );
        assert_eq!(
            bodies(&out),
            [
                "IIALC,02,01,05,2,XYZ,9999999,999999,99,XYZ,9999999,999999,1",
                "IIALC,02,02,05,1,XYZ,10512,1,7",
            ]
        );
    }

    #[test]
    fn a_refusal_names_the_alert_and_the_command() {
        let mut out = Vec::new();
        let time = TimeOfDay::new(1, 2, 3, 0);
        write_arc(*b"II", time, ALERT.id, AlertCommand::Transfer, &mut out);
        let unnumbered = AlertId {
            manufacturer: None,
            number: 192,
            instance: None,
        };
        write_arc(
            *b"II",
            None,
            unnumbered,
            AlertCommand::Acknowledge,
            &mut out,
        );
        assert_eq!(
            bodies(&out),
            ["IIARC,010203.00,XYZ,10512,1,O", "IIARC,,,192,,A"]
        );
    }

    #[test]
    fn each_command_has_its_letter() {
        for letter in b'A'..=b'Z' {
            if let Some(command) = AlertCommand::from_letter(letter) {
                assert_eq!(command.letter(), letter);
            }
        }
    }
}
