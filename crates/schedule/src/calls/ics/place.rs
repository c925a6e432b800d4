//! Finds the port of a calendar's event.
//!
//! Invariants: `X-UNLOCODE` takes precedence over `LOCATION`. Where either is
//! given, `SUMMARY` cannot name another port: ships' names and parts of ports'
//! names can look like codes. A word counts as a code only where it stands
//! alone between commas or brackets of `LOCATION`, beside the port's own name,
//! or in `SUMMARY` behind "at". An ambiguous port is refused.

use super::line::Line;
use crate::calls::FileError;
use crate::ports::{self, Port, PortCode};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

/// Separators between the parts of a place.
const BETWEEN: [char; 12] = [',', ';', '(', ')', '[', ']', '/', '|', ':', '\n', '–', '—'];

/// Returns the port of an event from its properties.
pub(super) fn port<'a>(
    begins: usize,
    find: &impl Fn(&str) -> Option<&'a Line>,
) -> Result<PortCode, FileError> {
    let said = |name: &str| find(name).filter(|line| !line.value.trim().is_empty());
    let summary = said("SUMMARY").map_or("", |line| line.value.as_str());
    if let Some(line) = said("X-UNLOCODE") {
        let wrong = |what| FileError::new(line.number, "X-UNLOCODE", what);
        let code = PortCode::parse(&line.value).map_err(|error| wrong(error.to_string()))?;
        return match ports::find(code) {
            Some(_) => Ok(code),
            None => Err(wrong(ports::unknown(code))),
        };
    }
    match said("LOCATION") {
        Some(line) => port_of_location(&line.value, summary)
            .map_err(|what| FileError::new(line.number, "LOCATION", what)),
        None => port_of_summary(summary).map_err(|what| FileError::new(begins, "LOCATION", what)),
    }
}

fn port_of_location(text: &str, summary: &str) -> Result<PortCode, String> {
    let mut named = named(text.split(',').next().unwrap_or_default());
    if named.is_empty() {
        named = self::named(text.split(BETWEEN).next().unwrap_or_default());
    }
    let alone = parts(text).filter_map(alone);
    let codes = distinct(alone.chain(beside_their_names(text)));
    match (&codes[..], named) {
        ([code], []) => Ok(*code),
        ([code], named) if named.iter().any(|port| is_called(*code, port)) => Ok(*code),
        ([code], [port, ..]) => Err(format!(
            "{text:?} has the code {code} and the name of {} ({}); use only one of them",
            port.name, port.code
        )),
        ([one, other, ..], _) => Err(ambiguous(text, *one, *other)),
        ([], [port]) => Ok(port.code),
        ([], []) => Err(format!("{text:?} is not a known port; write the UN/LOCODE")),
        // The summary may choose among ports of the same name.
        ([], [one, other, ..]) => {
            let meant = words_as_codes(summary).filter(|code| {
                let mut called = named.iter();
                called.any(|port| port.code == *code)
            });
            match distinct(meant)[..] {
                [code] => Ok(code),
                _ => Err(ambiguous(&one.name.to_lowercase(), one.code, other.code)),
            }
        }
    }
}

fn port_of_summary(text: &str) -> Result<PortCode, String> {
    let behind_at = parts(text).filter_map(|part| {
        let (_, there) = part.rsplit_once(" at ")?;
        let capitals = there.split_whitespace().take_while(|word| is_capital(word));
        alone(&capitals.collect::<Vec<_>>().join(" "))
    });
    let codes = distinct(behind_at.chain(beside_their_names(text)));
    match codes[..] {
        [code] => Ok(code),
        [] => Err(
            "is missing in the event, and SUMMARY has no UN/LOCODE behind \"at\" or beside its \
             port's name"
                .to_owned(),
        ),
        [one, other, ..] => Err(ambiguous(text, one, other)),
    }
}

fn ambiguous(what: &str, one: PortCode, other: PortCode) -> String {
    format!("{what:?} may be {one} or {other}; write the UN/LOCODE")
}

fn distinct(codes: impl Iterator<Item = PortCode>) -> Vec<PortCode> {
    let mut codes: Vec<PortCode> = codes.collect();
    codes.sort_unstable();
    codes.dedup();
    codes
}

/// The parts between commas, brackets and dashes.
fn parts(text: &str) -> impl Iterator<Item = &str> {
    text.split(BETWEEN)
        .flat_map(|part| part.split(" - "))
        .map(str::trim)
}

fn is_capital(word: &str) -> bool {
    !word.is_empty() && !word.chars().any(char::is_lowercase)
}

/// The code, if the text is a code and nothing else, with or without its space.
fn alone(text: &str) -> Option<PortCode> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let fits = match words[..] {
        [word] => word.len() == 5,
        [country, place] => country.len() == 2 && place.len() == 3,
        _ => false,
    };
    if !fits || !is_capital(text) {
        return None;
    }
    let code = PortCode::parse(&words.concat()).ok()?;
    ports::find(code).map(|_| code)
}

/// Codes among the words in capitals and pairs of them.
fn words_as_codes(text: &str) -> impl Iterator<Item = PortCode> {
    let words: Vec<&str> = text
        .split(|letter: char| !letter.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    let pairs = words.windows(2).map(|pair| pair.join(" "));
    let single = words.iter().map(|word| (*word).to_owned());
    let codes: Vec<PortCode> = single
        .chain(pairs)
        .filter_map(|word| alone(&word))
        .collect();
    codes.into_iter()
}

/// Codes in a text that also contains their ports' names.
fn beside_their_names(text: &str) -> impl Iterator<Item = PortCode> {
    let whole = format!(" {} ", plain(text));
    words_as_codes(text).filter(move |code| {
        let port = ports::find(*code);
        let mut names = port.iter().flat_map(|port| names(port));
        names.any(|name| whole.contains(&format!(" {name} ")))
    })
}

/// Ports of exactly this name.
fn named(name: &str) -> &'static [&'static Port] {
    // A calendar has thousands of places, and the table thousands of ports.
    static NAMED: OnceLock<BTreeMap<String, Vec<&'static Port>>> = OnceLock::new();
    let named = NAMED.get_or_init(|| {
        let mut named: BTreeMap<String, Vec<&'static Port>> = BTreeMap::new();
        for port in ports::all() {
            let names: BTreeSet<String> = [port.name, port.plain_name]
                .map(str::to_lowercase)
                .into_iter()
                .collect();
            for name in names {
                named.entry(name).or_default().push(port);
            }
        }
        named
    });
    let found = named.get(&name.trim().to_lowercase());
    found.map_or(&[], Vec::as_slice)
}

/// True if the port of a code shares a name with another: Georgetown is also
/// Georgetown, Grand Cayman.
fn is_called(code: PortCode, other: &Port) -> bool {
    let Some(port) = ports::find(code) else {
        return false;
    };
    names(port).any(|name| names(other).any(|named| named == name))
}

/// A port's names in plain words: the whole name, and the part before a comma
/// or bracket.
fn names(port: &Port) -> impl Iterator<Item = String> {
    let both = [&port.name, &port.plain_name].map(|name| {
        let first = name.split([',', '(']).next().unwrap_or_default();
        [plain(name), plain(first)]
    });
    both.into_iter().flatten().filter(|name| !name.is_empty())
}

/// The text in lower case, with single blanks between words.
fn plain(text: &str) -> String {
    let words = text.split(|letter: char| !letter.is_alphanumeric());
    let words: Vec<String> = words
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect();
    words.join(" ")
}
