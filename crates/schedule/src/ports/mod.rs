//! Sea ports by UN/LOCODE, with their positions.
//!
//! `data/ports.csv` is made by `scripts/ports.py` from UNECE's code list (its
//! issue 2023-1; function 1, port), as it is published for everyone's use;
//! where UNECE gives no position, from the list "sea-ports" 0.0.9 (MIT licence,
//! © marchah). Positions are rounded to a hundredth of a degree: good for
//! distances, not for navigation, and a few are far off in UNECE's list. Zones
//! are by country and subdivision, from zone.tab of the IANA time zone database
//! 2026f (public domain). `data/places.csv` is made by `scripts/places.py` from
//! the same list.
//!
//! Invariants: a [`PortCode`] is two capital letters and three capital letters
//! or digits; the table is sorted by it and contains each once.

use crate::zone::Zone;
use binnacle_compass::position::Position;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::OnceLock;

/// A UN/LOCODE: country and place, as `NLRTM`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct PortCode([u8; 5]);

/// The reason why a text is not a UN/LOCODE.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not a UN/LOCODE of five letters and digits, as NLRTM")]
pub struct PortCodeError(String);

/// A port of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Port {
    /// Its code.
    pub code: PortCode,
    /// Its name.
    pub name: &'static str,
    /// Its name without accents.
    pub plain_name: &'static str,
    /// Its approximate position.
    pub position: Position,
    /// Its legal time.
    pub zone: Zone,
}

static PORTS: OnceLock<Vec<Port>> = OnceLock::new();

/// Returns all ports, in the order of their codes.
#[allow(clippy::missing_panics_doc, reason = "a test reads the same table")]
pub fn all() -> &'static [Port] {
    PORTS.get_or_init(|| {
        let lines = include_str!("../../data/ports.csv").lines().skip(1);
        let ports =
            lines.map(|line| read(line).expect("the table that is compiled in is read by a test"));
        ports.collect()
    })
}

/// Finds the port of a code.
pub fn find(code: PortCode) -> Option<&'static Port> {
    let ports = all();
    let at = ports.binary_search_by_key(&code, |port| port.code).ok()?;
    Some(&ports[at])
}

/// Returns the legal time at a port; UTC where the table does not have its
/// code.
pub fn zone(code: PortCode) -> Zone {
    find(code).map_or_else(Zone::utc, |port| port.zone)
}

/// Explains why a code is not a port of the table, and suggests the port that
/// may be meant: cities and airports have codes of their own.
pub fn describe_unknown(code: PortCode) -> String {
    let wrong = format!("{code} is not a sea port in the UN/LOCODE table");
    let places = include_str!("../../data/places.csv").lines().skip(1);
    let mut places = places.filter_map(|line| line.split_once(','));
    let text = code.to_string();
    let meant = places.find(|(place, _)| *place == text);
    let port = meant.and_then(|(_, port)| find(PortCode::parse(port).ok()?));
    match port {
        Some(port) => format!("{wrong}; the sea port {} is {}", port.name, port.code),
        None => wrong,
    }
}

/// Finds the ports that words name: by a code, by a name, or by any place's name with the port's
/// code in brackets.
/// Several may share a name, and a name may be another port's code.
pub fn named(words: &str) -> Vec<&'static Port> {
    let by_code = |text: &str| PortCode::parse(text).ok().and_then(find);
    if let Some((name, code)) = words.trim().rsplit_once('(')
        && let Some(port) = code.strip_suffix(')').and_then(by_code)
    {
        // Another port's name contradicts the code; a terminal's, as Europoort's, does not.
        let others = called(name);
        let is_called = others.is_empty() || others.iter().any(|named| named.code == port.code);
        return Vec::from_iter(is_called.then_some(port));
    }
    let of_name = called(words).iter().copied();
    let mut found: Vec<&Port> = by_code(words).into_iter().chain(of_name).collect();
    found.sort_by_key(|port| port.code);
    found.dedup_by_key(|port| port.code);
    found
}

/// Returns the ports of exactly this name, with or without its accents, in either case.
pub(crate) fn called(name: &str) -> &'static [&'static Port] {
    // A file has thousands of places, and the table thousands of ports.
    static CALLED: OnceLock<BTreeMap<String, Vec<&'static Port>>> = OnceLock::new();
    let called = CALLED.get_or_init(|| {
        let mut called: BTreeMap<String, Vec<&'static Port>> = BTreeMap::new();
        for port in all() {
            let names: BTreeSet<String> = [port.name, port.plain_name]
                .map(str::to_lowercase)
                .into_iter()
                .collect();
            for name in names {
                called.entry(name).or_default().push(port);
            }
        }
        called
    });
    let found = called.get(&name.trim().to_lowercase());
    found.map_or(&[], Vec::as_slice)
}

/// Finds ports whose code or name begins with a text, then those whose name
/// contains it elsewhere; at most `limit`.
pub fn search(text: &str, limit: usize) -> Vec<&'static Port> {
    let text = text.trim().to_lowercase();
    if text.is_empty() {
        return Vec::new();
    }
    let (mut first, mut later) = (Vec::new(), Vec::new());
    for port in all() {
        let (name, plain) = (port.name.to_lowercase(), port.plain_name.to_lowercase());
        let code = port.code.to_string().to_lowercase();
        if code.starts_with(&text) || name.starts_with(&text) || plain.starts_with(&text) {
            first.push(port);
        } else if name.contains(&text) || plain.contains(&text) {
            later.push(port);
        }
    }
    first.append(&mut later);
    first.truncate(limit);
    first
}

impl PortCode {
    /// Parses a code, in either case and with or without the space behind the
    /// country.
    ///
    /// # Errors
    /// Fails when it is not a code.
    pub fn parse(text: &str) -> Result<PortCode, PortCodeError> {
        let wrong = || PortCodeError(text.chars().take(20).collect());
        let letters: Vec<u8> = text
            .trim()
            .bytes()
            .enumerate()
            .filter(|(at, byte)| !(*at == 2 && *byte == b' '))
            .map(|(_, byte)| byte.to_ascii_uppercase())
            .collect();
        let code: [u8; 5] = letters.try_into().map_err(|_| wrong())?;
        let country = code[..2].iter().all(u8::is_ascii_uppercase);
        let place = code[2..]
            .iter()
            .all(|byte| byte.is_ascii_uppercase() || byte.is_ascii_digit());
        (country && place)
            .then_some(PortCode(code))
            .ok_or_else(wrong)
    }
}

impl fmt::Display for PortCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(std::str::from_utf8(&self.0).expect("letters and digits are ASCII"))
    }
}

impl TryFrom<String> for PortCode {
    type Error = PortCodeError;
    fn try_from(text: String) -> Result<PortCode, PortCodeError> {
        PortCode::parse(&text)
    }
}

impl From<PortCode> for String {
    fn from(code: PortCode) -> String {
        code.to_string()
    }
}

/// Parses a line of the table: code, name, the name without accents where it has some, degrees
/// north, degrees east, time zone. Only names are quoted, and they have no quotes in them.
fn read(line: &'static str) -> Option<Port> {
    let (code, rest) = line.split_once(',')?;
    let (name, rest) = cell(rest)?;
    let (plain, rest) = cell(rest)?;
    let (lat, rest) = rest.split_once(',')?;
    let (lon, zone) = rest.split_once(',')?;
    Some(Port {
        code: PortCode::parse(code).ok()?,
        name,
        plain_name: if plain.is_empty() { name } else { plain },
        position: Position::new(lat.parse().ok()?, lon.parse().ok()?).ok()?,
        zone: Zone::find(zone).ok()?,
    })
}

fn cell(text: &'static str) -> Option<(&'static str, &'static str)> {
    match text.strip_prefix('"') {
        Some(quoted) => quoted.split_once("\","),
        None => text.split_once(','),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_whole_table_is_read_sorted_and_without_repetition() {
        assert!(all().len() > 10_000);
        assert!(all().is_sorted_by(|one, next| one.code < next.code));
        assert!(all().iter().all(|port| !port.name.contains('"')));
    }

    #[test]
    fn a_port_is_found_by_its_code_or_its_name_and_a_shared_name_finds_all() {
        let codes = |words: &str| -> Vec<String> {
            named(words)
                .iter()
                .map(|port| port.code.to_string())
                .collect()
        };
        for words in ["ESBIO", "es bio", "Bilbao", "bilbao", "Bilbao (ESBIO)"] {
            assert_eq!(codes(words), ["ESBIO"], "{words}");
        }
        // One in the United States is written without the accent.
        assert_eq!(codes("Málaga"), ["ESAGP"]);
        assert_eq!(codes("Malaga"), ["ESAGP", "USMG5"]);
        // There is one in the state of New York too.
        assert_eq!(codes("Rotterdam"), ["NLRTM", "USRAJ"]);
        assert!(codes("Rotterdm").is_empty());
        assert_eq!(codes("MÁLAGA"), ["ESAGP"]);
        // One port's name is another's code.
        assert_eq!(codes("Trana"), ["NOTRN", "TRANA"]);
        assert!(codes("Rotterdam (ESBIO)").is_empty());
        assert_eq!(codes("Europoort (NLRTM)"), ["NLRTM"]);
    }

    #[test]
    fn the_worlds_great_ports_are_where_they_are() {
        for (code, lat, lon) in [
            ("NLRTM", 51.9, 4.5),
            ("SGSIN", 1.3, 103.8),
            ("CNSGH", 31.2, 121.5),
            ("USHOU", 29.75, -95.4),
            ("PABLB", 8.96, -79.57),
            ("ESBIO", 43.3, -3.0),
            ("BRSSZ", -23.9, -46.3),
            ("ZADUR", -29.9, 31.0),
            ("AUMEL", -37.8, 145.0),
        ] {
            let port = find(PortCode::parse(code).unwrap()).unwrap();
            let off = (port.position.lat_deg() - lat)
                .abs()
                .max((port.position.lon_deg() - lon).abs());
            assert!(off < 0.3, "{code} is {off}° off");
        }
    }

    #[test]
    fn a_city_or_an_airport_is_refused_with_the_port_of_its_name() {
        let said = |code: &str| describe_unknown(PortCode::parse(code).unwrap());
        assert_eq!(
            said("CNSHA"),
            "CNSHA is not a sea port in the UN/LOCODE table; the sea port Shanghai is CNSGH"
        );
        assert!(said("CNNGB").ends_with("the sea port Ningbo is CNNBO"));
        assert_eq!(
            said("XXXXX"),
            "XXXXX is not a sea port in the UN/LOCODE table"
        );
    }

    #[test]
    fn every_place_of_the_table_is_refused_with_a_port() {
        let places = include_str!("../../data/places.csv").lines().skip(1);
        for (place, port) in places.map(|line| line.split_once(',').unwrap()) {
            assert!(find(PortCode::parse(place).unwrap()).is_none(), "{place}");
            assert!(find(PortCode::parse(port).unwrap()).is_some(), "{port}");
        }
    }

    #[test]
    fn a_code_is_read_in_either_case_and_with_its_space() {
        let rotterdam = PortCode::parse("NLRTM").unwrap();
        assert_eq!(PortCode::parse(" nl rtm ").unwrap(), rotterdam);
        for wrong in ["", "NLRT", "NLRTMX", "N1RTM", "NLR-M", "ÄÖÜ"] {
            assert!(PortCode::parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_port_is_found_by_the_beginning_of_its_name_without_accents() {
        let found = search("cristob", 5);
        assert!(found.iter().any(|port| port.code.to_string() == "PACTB"));
        assert_eq!(search("rotterdam", 1)[0].code.to_string(), "NLRTM");
        assert!(search("  ", 5).is_empty());
    }
}
