//! Sentences of the output: kinds, talkers and intervals.

use serde::{Deserialize, Deserializer};

/// Sentences that a destination can select.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum SentenceKind {
    /// Raw heading with deviation and variation.
    Hdg,
    /// True heading with its mode.
    Ths,
    /// True heading without a mode.
    Hdt,
    /// Quality of the heading.
    Pbinq,
    /// Alarm for an alarm panel.
    Alr,
    /// Alerts for bridge alert management: ALF, ALC, ARC and HBT.
    Alf,
}

impl SentenceKind {
    pub(super) const ALL: [SentenceKind; 6] = [
        SentenceKind::Hdg,
        SentenceKind::Ths,
        SentenceKind::Hdt,
        SentenceKind::Pbinq,
        SentenceKind::Alr,
        SentenceKind::Alf,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            SentenceKind::Hdg => "HDG",
            SentenceKind::Ths => "THS",
            SentenceKind::Hdt => "HDT",
            SentenceKind::Pbinq => "PBINQ",
            SentenceKind::Alr => "ALR",
            SentenceKind::Alf => "ALF",
        }
    }
}

/// Seconds between two sentences, from a hundredth to an hour.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Deserialize)]
#[serde(try_from = "f64")]
pub struct Interval(pub(super) f64);

impl Interval {
    /// Returns the interval in seconds.
    pub fn seconds(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for Interval {
    type Error = String;

    fn try_from(seconds: f64) -> Result<Interval, String> {
        if (0.01..=3_600.0).contains(&seconds) {
            Ok(Interval(seconds))
        } else {
            Err(format!("{seconds} is not from 0.01 to 3600 seconds"))
        }
    }
}

/// Reads a talker: two capital letters or digits.
pub(super) fn talker<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[u8; 2], D::Error> {
    let text = String::deserialize(deserializer)?;
    let is_plain = |byte: &u8| byte.is_ascii_uppercase() || byte.is_ascii_digit();
    let letters: Option<[u8; 2]> = text.as_bytes().try_into().ok();
    letters
        .filter(|letters| letters.iter().all(is_plain))
        .ok_or_else(|| {
            let problem = format!("{text:?} is not two capital letters, as \"HC\"");
            serde::de::Error::custom(problem)
        })
}

/// One sentence: off, on, or with its own talker and interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(from = "SentenceForm")]
pub struct SentenceConfig {
    /// Set if it is sent.
    pub is_on: bool,
    /// Talker other than that of the output.
    pub talker: Option<[u8; 2]>,
    /// Interval other than that of the output.
    pub interval_s: Option<Interval>,
}

impl SentenceConfig {
    pub(super) const OFF: SentenceConfig = SentenceConfig {
        is_on: false,
        talker: None,
        interval_s: None,
    };
    pub(crate) const ON: SentenceConfig = SentenceConfig {
        is_on: true,
        ..SentenceConfig::OFF
    };
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected true, false or { talker = \"HC\", interval_s = 0.2 }"
)]
enum SentenceForm {
    Switch(bool),
    Table(SentenceTable),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SentenceTable {
    #[serde(default, deserialize_with = "some_talker")]
    talker: Option<[u8; 2]>,
    interval_s: Option<Interval>,
}

impl From<SentenceForm> for SentenceConfig {
    fn from(form: SentenceForm) -> SentenceConfig {
        match form {
            SentenceForm::Switch(is_on) => SentenceConfig {
                is_on,
                ..SentenceConfig::OFF
            },
            SentenceForm::Table(table) => SentenceConfig {
                is_on: true,
                talker: table.talker,
                interval_s: table.interval_s,
            },
        }
    }
}

fn some_talker<'de, D: Deserializer<'de>>(d: D) -> Result<Option<[u8; 2]>, D::Error> {
    talker(d).map(Some)
}
