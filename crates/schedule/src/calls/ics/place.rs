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

/// Separators between the parts of a place.
const SEPARATORS: [char; 12] = [',', ';', '(', ')', '[', ']', '/', '|', ':', '\n', '–', '—'];

/// Returns the port of an event from its properties.
pub(super) fn find_port<'a>(
    begins: usize,
    find: &impl Fn(&str) -> Option<&'a Line>,
) -> Result<PortCode, FileError> {
    let property = |name: &str| find(name).filter(|line| !line.value.trim().is_empty());
    let summary = property("SUMMARY").map_or("", |line| line.value.as_str());
    if let Some(line) = property("X-UNLOCODE") {
        let wrong = |what| FileError::new(line.number, "X-UNLOCODE", what);
        let code = PortCode::parse(&line.value).map_err(|error| wrong(error.to_string()))?;
        return match ports::find(code) {
            Some(_) => Ok(code),
            None => Err(wrong(ports::describe_unknown(code))),
        };
    }
    match property("LOCATION") {
        Some(line) => port_of_location(&line.value, summary)
            .map_err(|what| FileError::new(line.number, "LOCATION", what)),
        None => port_of_summary(summary).map_err(|what| FileError::new(begins, "LOCATION", what)),
    }
}

fn port_of_location(text: &str, summary: &str) -> Result<PortCode, String> {
    let mut named = ports::called(text.split(',').next().unwrap_or_default());
    if named.is_empty() {
        named = ports::called(text.split(SEPARATORS).next().unwrap_or_default());
    }
    let lone = split_parts(text).filter_map(parse_lone_code);
    let codes = sorted_distinct(lone.chain(codes_beside_names(text)));
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
            let meant = find_codes(summary).filter(|code| {
                let mut called = named.iter();
                called.any(|port| port.code == *code)
            });
            match sorted_distinct(meant)[..] {
                [code] => Ok(code),
                _ => Err(ambiguous(&one.name.to_lowercase(), one.code, other.code)),
            }
        }
    }
}

fn port_of_summary(text: &str) -> Result<PortCode, String> {
    let behind_at = split_parts(text).filter_map(|part| {
        let (_, there) = part.rsplit_once(" at ")?;
        let capitals = there.split_whitespace().take_while(|word| is_capital(word));
        parse_lone_code(&capitals.collect::<Vec<_>>().join(" "))
    });
    let codes = sorted_distinct(behind_at.chain(codes_beside_names(text)));
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

fn sorted_distinct(codes: impl Iterator<Item = PortCode>) -> Vec<PortCode> {
    let mut codes: Vec<PortCode> = codes.collect();
    codes.sort_unstable();
    codes.dedup();
    codes
}

/// Splits a text into its parts between commas, brackets and dashes.
fn split_parts(text: &str) -> impl Iterator<Item = &str> {
    text.split(SEPARATORS)
        .flat_map(|part| part.split(" - "))
        .map(str::trim)
}

fn is_capital(word: &str) -> bool {
    !word.is_empty() && !word.chars().any(char::is_lowercase)
}

/// Returns the code, if the text is a code and nothing else, with or without its space.
fn parse_lone_code(text: &str) -> Option<PortCode> {
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

/// Returns the codes among the words in capitals and pairs of them.
fn find_codes(text: &str) -> impl Iterator<Item = PortCode> {
    let words: Vec<&str> = text
        .split(|letter: char| !letter.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    let pairs = words.windows(2).map(|pair| pair.join(" "));
    let single = words.iter().map(|word| (*word).to_owned());
    let codes: Vec<PortCode> = single
        .chain(pairs)
        .filter_map(|word| parse_lone_code(&word))
        .collect();
    codes.into_iter()
}

/// Returns the codes in a text that also contains their ports' names.
fn codes_beside_names(text: &str) -> impl Iterator<Item = PortCode> {
    let whole = format!(" {} ", normalize(text));
    find_codes(text).filter(move |code| {
        let port = ports::find(*code);
        let mut names = port.iter().flat_map(|port| plain_names(port));
        names.any(|name| whole.contains(&format!(" {name} ")))
    })
}

/// Returns true if the port of a code shares a name with another: Georgetown is also
/// Georgetown, Grand Cayman.
fn is_called(code: PortCode, other: &Port) -> bool {
    let Some(port) = ports::find(code) else {
        return false;
    };
    plain_names(port).any(|name| plain_names(other).any(|named| named == name))
}

/// Returns a port's normalized names: the whole name, and the part before a comma
/// or bracket.
fn plain_names(port: &Port) -> impl Iterator<Item = String> {
    let both = [&port.name, &port.plain_name].map(|name| {
        let first = name.split([',', '(']).next().unwrap_or_default();
        [normalize(name), normalize(first)]
    });
    both.into_iter().flatten().filter(|name| !name.is_empty())
}

/// Returns the text in lower case, with single blanks between words.
fn normalize(text: &str) -> String {
    let words = text.split(|letter: char| !letter.is_alphanumeric());
    let words: Vec<String> = words
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect();
    words.join(" ")
}
