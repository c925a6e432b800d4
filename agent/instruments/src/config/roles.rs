//! `[roles]`: sources of each instrument, best first.

use binnacle_nmea::n2k::{Address, Name};
use serde::{Deserialize, Deserializer};
use std::net::IpAddr;
use toml::Spanned;

/// Ranked sources for each instrument.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RolesConfig {
    /// Magnetic compass, raw.
    #[serde(deserialize_with = "compass_sources")]
    pub compass: Vec<SourceConfig>,
    /// Gyro compass.
    #[serde(deserialize_with = "true_heading_sources")]
    pub gyro: Vec<SourceConfig>,
    /// Satellite compass.
    #[serde(deserialize_with = "true_heading_sources")]
    pub satellite: Vec<SourceConfig>,
    /// Position, speed and GNSS time.
    #[serde(deserialize_with = "position_sources")]
    pub position: Vec<SourceConfig>,
    /// Rate of turn.
    #[serde(deserialize_with = "rate_of_turn_sources")]
    pub rate_of_turn: Vec<SourceConfig>,
    /// Log: speed through the water.
    #[serde(deserialize_with = "log_sources")]
    pub log: Vec<SourceConfig>,
    /// Roll.
    #[serde(deserialize_with = "roll_sources")]
    pub roll: Vec<SourceConfig>,
    /// Temperature of the air.
    #[serde(deserialize_with = "temperature_sources")]
    pub temperature: Vec<SourceConfig>,
}

/// One source; an omitted key matches anything.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SourceConfig {
    /// Name of the input.
    pub input: Option<Spanned<String>>,
    /// Talker, two letters.
    #[serde(default, deserialize_with = "two_letters")]
    pub talker: Option<[u8; 2]>,
    /// Sentence, three letters.
    #[serde(default, deserialize_with = "three_letters")]
    pub sentence: Option<[u8; 3]>,
    /// Signal K: `$source` of the value.
    #[serde(default, deserialize_with = "some_text")]
    pub source: Option<String>,
    /// System function, `s:` of the TAG block.
    #[serde(default, deserialize_with = "some_text")]
    pub sfi: Option<String>,
    /// Address that datagrams come from.
    pub sender: Option<IpAddr>,
    /// Address on NMEA 2000.
    #[serde(default, deserialize_with = "n2k_address")]
    pub n2k_address: Option<Address>,
    /// NAME on NMEA 2000.
    #[serde(default, deserialize_with = "n2k_name")]
    pub n2k_name: Option<Name>,
    /// HDM only: the heading has had no deviation applied.
    #[serde(default)]
    pub raw: bool,
}

impl SourceConfig {
    fn usual(talker: Option<[u8; 2]>, sentence: [u8; 3]) -> SourceConfig {
        SourceConfig {
            input: None,
            talker,
            sentence: Some(sentence),
            source: None,
            sfi: None,
            sender: None,
            n2k_address: None,
            n2k_name: None,
            raw: false,
        }
    }

    /// Returns the name of the source, which is the same on every start: what the configuration
    /// asks for.
    pub fn name(&self) -> String {
        let input = self.input.as_ref().map(|input| input.get_ref().clone());
        let letters = |letters: &[u8]| String::from_utf8_lossy(letters).into_owned();
        let talker = self.talker.map(|talker| letters(&talker));
        let sentence = self.sentence.map(|sentence| letters(&sentence));
        // Keys that came later stand last, so that a source keeps its name.
        let parts = [
            input,
            talker,
            sentence,
            self.source.clone(),
            self.sfi.clone(),
            self.sender.map(|sender| sender.to_string()),
            self.n2k_address.map(|address| address.to_string()),
            self.n2k_name.map(|name| name.to_string()),
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join(" ")
    }

    /// Returns whether the talker matches.
    pub fn matches_talker(&self, talker: [u8; 2]) -> bool {
        self.talker.is_none_or(|wanted| wanted == talker)
    }
}

impl RolesConfig {
    /// Roles of true headings.
    pub const TRUE_HEADINGS: [&'static str; 2] = ["gyro", "satellite"];

    /// Returns the sources of each role by its name in the file.
    pub fn by_role(&self) -> [(&'static str, &[SourceConfig]); 8] {
        [
            ("compass", &self.compass),
            ("gyro", &self.gyro),
            ("satellite", &self.satellite),
            ("position", &self.position),
            ("rate_of_turn", &self.rate_of_turn),
            ("log", &self.log),
            ("roll", &self.roll),
            ("temperature", &self.temperature),
        ]
    }

    /// Iterates over the sources of all roles.
    pub fn sources(&self) -> impl Iterator<Item = &SourceConfig> {
        self.by_role().into_iter().flat_map(|(_, sources)| sources)
    }

    /// Returns the roles without input names, for recordings.
    pub fn without_input_names(&self) -> RolesConfig {
        let mut roles = self.clone();
        for sources in [
            &mut roles.compass,
            &mut roles.gyro,
            &mut roles.satellite,
            &mut roles.position,
            &mut roles.rate_of_turn,
            &mut roles.log,
            &mut roles.roll,
            &mut roles.temperature,
        ] {
            for source in sources {
                source.input = None;
            }
        }
        roles
    }

    fn none() -> RolesConfig {
        RolesConfig {
            compass: Vec::new(),
            gyro: Vec::new(),
            satellite: Vec::new(),
            position: Vec::new(),
            rate_of_turn: Vec::new(),
            log: Vec::new(),
            roll: Vec::new(),
            temperature: Vec::new(),
        }
    }

    /// Returns the conventional talkers of each role. `SK` is Signal K, whose HDG is
    /// `navigation.headingCompass`: the raw reading. `N2` is NMEA 2000, where true headings are
    /// satellite compasses' as a rule.
    pub fn usual() -> RolesConfig {
        let source = SourceConfig::usual;
        let of_any = |sentence| source(None, sentence);
        let of = |talkers: &[&[u8; 2]], sentence| {
            let talkers = talkers.iter().map(|talker| **talker);
            talkers
                .map(|talker| source(Some(talker), sentence))
                .collect::<Vec<_>>()
        };
        let satellite: [&[u8; 2]; 4] = [b"GP", b"GN", b"IN", b"N2"];
        RolesConfig {
            compass: of(&[b"HC", b"SK", b"N2"], *b"HDG"),
            gyro: [of(&[b"HE"], *b"THS"), of(&[b"HE", b"SK"], *b"HDT")].concat(),
            satellite: [of(&satellite, *b"THS"), of(&satellite, *b"HDT")].concat(),
            position: vec![of_any(*b"RMC"), of_any(*b"GGA"), of_any(*b"GLL")],
            rate_of_turn: vec![of_any(*b"ROT")],
            log: vec![of_any(*b"VHW")],
            roll: vec![of_any(*b"XDR")],
            temperature: vec![of_any(*b"MTA"), of_any(*b"XDR")],
        }
    }
}

impl Default for RolesConfig {
    fn default() -> RolesConfig {
        RolesConfig::none()
    }
}

fn two_letters<'de, D: Deserializer<'de>>(d: D) -> Result<Option<[u8; 2]>, D::Error> {
    letters(d, "two capital letters, as \"HC\"")
}

fn three_letters<'de, D: Deserializer<'de>>(d: D) -> Result<Option<[u8; 3]>, D::Error> {
    letters(d, "three capital letters, as \"HDG\"")
}

fn letters<'de, const N: usize, D: Deserializer<'de>>(
    deserializer: D,
    wanted: &str,
) -> Result<Option<[u8; N]>, D::Error> {
    let text = String::deserialize(deserializer)?;
    let letters: Option<[u8; N]> = text.as_bytes().try_into().ok();
    match letters {
        Some(letters)
            if letters
                .iter()
                .all(|b| b.is_ascii_uppercase() || b.is_ascii_digit()) =>
        {
            Ok(Some(letters))
        }
        _ => Err(serde::de::Error::custom(format!(
            "{text:?} is not {wanted}"
        ))),
    }
}

fn some_text<'de, D: Deserializer<'de>>(d: D) -> Result<Option<String>, D::Error> {
    let text = String::deserialize(d)?;
    if text.is_empty() {
        return Err(serde::de::Error::custom("\"\" names nothing"));
    }
    Ok(Some(text))
}

fn n2k_address<'de, D: Deserializer<'de>>(d: D) -> Result<Option<Address>, D::Error> {
    let number = i64::deserialize(d)?;
    let address = u8::try_from(number).ok().and_then(Address::new);
    address.map(Some).ok_or_else(|| {
        serde::de::Error::custom(format!("{number} is not an address from 0 to 251"))
    })
}

fn n2k_name<'de, D: Deserializer<'de>>(d: D) -> Result<Option<Name>, D::Error> {
    let text = String::deserialize(d)?;
    Name::parse(&text).map(Some).ok_or_else(|| {
        serde::de::Error::custom(format!("{text:?} is not a NAME of 16 hexadecimal digits"))
    })
}

type Sources<E> = Result<Vec<SourceConfig>, E>;

fn compass_sources<'de, D: Deserializer<'de>>(d: D) -> Sources<D::Error> {
    let sources = sources_of(d, &[b"HDG", b"HDM"], "HDG or HDM")?;
    if sources
        .iter()
        .any(|s| s.sentence == Some(*b"HDM") && !s.raw)
    {
        return Err(serde::de::Error::custom(
            "HDM may already have deviation applied: set raw = true if it has not",
        ));
    }
    Ok(sources)
}

fn true_heading_sources<'de, D: Deserializer<'de>>(d: D) -> Sources<D::Error> {
    sources_of(d, &[b"HDT", b"THS"], "HDT or THS")
}

fn position_sources<'de, D: Deserializer<'de>>(d: D) -> Sources<D::Error> {
    sources_of(d, &[b"RMC", b"GGA", b"GLL"], "RMC, GGA or GLL")
}

fn rate_of_turn_sources<'de, D: Deserializer<'de>>(d: D) -> Sources<D::Error> {
    sources_of(d, &[b"ROT"], "ROT")
}

fn log_sources<'de, D: Deserializer<'de>>(d: D) -> Sources<D::Error> {
    sources_of(d, &[b"VHW"], "VHW")
}

fn roll_sources<'de, D: Deserializer<'de>>(d: D) -> Sources<D::Error> {
    sources_of(d, &[b"XDR"], "XDR")
}

fn temperature_sources<'de, D: Deserializer<'de>>(d: D) -> Sources<D::Error> {
    sources_of(d, &[b"MTA", b"XDR"], "MTA or XDR")
}

fn sources_of<'de, D: Deserializer<'de>>(
    deserializer: D,
    allowed: &[&[u8; 3]],
    names: &str,
) -> Sources<D::Error> {
    let sources = Vec::<SourceConfig>::deserialize(deserializer)?;
    for source in &sources {
        let Some(sentence) = source.sentence else {
            continue;
        };
        if !allowed.contains(&&sentence) {
            let sentence = String::from_utf8_lossy(&sentence).into_owned();
            return Err(serde::de::Error::custom(format!(
                "{sentence} cannot serve here: use {names}"
            )));
        }
    }
    Ok(sources)
}
