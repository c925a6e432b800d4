//! Every source that is heard, whether it has a role or not.

use binnacle_nmea::n2k::Address;
use binnacle_observation::{Observation, Reading, Source};
use serde::{Deserialize, Serialize};
use std::collections::{HashMap, VecDeque};
use std::mem::discriminant;
use std::time::Duration;
use tokio::time::Instant;

/// Limit on sources that are listed: senders of datagrams may be many.
const MAX_SOURCES: usize = 200;
/// Latest times of a source from which its rate follows.
const TIMES: usize = 16;
/// Age up to which a reading on arrival is a live one.
const LIVE_WITHIN: Duration = Duration::from_mins(1);
/// Different readings of one sentence that are shown.
const MAX_VALUES: usize = 4;

/// Sources by what their paths name.
#[derive(Debug, Default)]
pub struct HeardSources {
    sources: HashMap<Source, HeardSource>,
}

/// A source and what it sends.
#[derive(Debug)]
pub struct HeardSource {
    /// Latest reading of each kind.
    pub values: Vec<Observation>,
    heard: Instant,
    /// Age of the latest reading; `None` while it is unknown.
    age: Option<Duration>,
    times_s: VecDeque<f64>,
    is_own_output: bool,
}

/// Source as the page, `status` and `discover` show it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SourceReport {
    /// Name of the input.
    pub input: String,
    /// Talker of the sentence, or empty.
    pub talker: String,
    /// Sentence, or the kind of message.
    pub sentence: String,
    /// Signal K: `$source`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// TAG block: `s:`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sfi: Option<String>,
    /// Datagrams: address of the sender.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sender: Option<String>,
    /// NMEA 2000: address.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub n2k_address: Option<u8>,
    /// NMEA 2000: NAME.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub n2k_name: Option<String>,
    /// Readings a second, from two readings on.
    pub rate_hz: Option<f64>,
    /// Latest values.
    pub last: String,
    /// Seconds since it was heard.
    pub heard_s_ago: f64,
    /// Age of its latest reading when that arrived, seconds; none while it is unknown.
    pub age_s: Option<f64>,
    /// Roles in which it serves.
    #[serde(default)]
    pub serves: Vec<String>,
    /// Roles that select it, while another source serves.
    #[serde(default)]
    pub stands_by: Vec<String>,
    /// Set if it repeats the agent's own output.
    #[serde(default)]
    pub own_output: bool,
}

impl HeardSources {
    /// Records an observation at a time in seconds, from which rates follow.
    pub fn note(
        &mut self,
        seen: &Observation,
        heard: Instant,
        age: Option<Duration>,
        seconds: f64,
    ) -> Option<&mut HeardSource> {
        if !self.sources.contains_key(&seen.source) {
            self.name_device(&seen.source);
        }
        if !self.sources.contains_key(&seen.source) {
            if self.sources.len() >= MAX_SOURCES {
                return None;
            }
            let source = HeardSource {
                values: Vec::new(),
                heard,
                age,
                times_s: VecDeque::new(),
                is_own_output: false,
            };
            self.sources.insert(seen.source.clone(), source);
        }
        let source = self.sources.get_mut(&seen.source)?;
        source.note(seen, heard, age, seconds);
        Some(source)
    }

    /// Gives a device on NMEA 2000 its NAME: readings come before it is known.
    fn name_device(&mut self, source: &Source) {
        let mut unnamed = source.clone();
        unnamed.n2k_name = None;
        if source.n2k_name.is_some()
            && let Some(known) = self.sources.remove(&unnamed)
        {
            self.sources.insert(source.clone(), known);
        }
    }

    /// Returns the sources in the order of their names.
    pub fn sorted(&self) -> Vec<(&Source, &HeardSource)> {
        let mut sources: Vec<_> = self.sources.iter().collect();
        sources.sort_by(|(one, _), (other, _)| {
            let by_device = one.device_order(other);
            one.input
                .cmp(&other.input)
                .then(by_device)
                .then(one.sentence.cmp(&other.sentence))
        });
        sources
    }
}

impl HeardSource {
    fn note(&mut self, seen: &Observation, heard: Instant, age: Option<Duration>, seconds: f64) {
        (self.heard, self.age) = (heard, age);
        let kind = discriminant(&seen.reading);
        let place = self
            .values
            .iter()
            .position(|known| discriminant(&known.reading) == kind);
        match place {
            Some(place) => self.values[place].reading = seen.reading,
            None if self.values.len() < MAX_VALUES => self.values.push(seen.clone()),
            None => {}
        }
        // One sentence may have several readings.
        if place.unwrap_or(self.values.len() - 1) != 0 {
            return;
        }
        if self.times_s.len() == TIMES {
            self.times_s.pop_front();
        }
        self.times_s.push_back(seconds);
    }

    /// Marks whether the latest reading was the agent's own output.
    pub fn mark_own_output(&mut self, is_own_output: bool) {
        self.is_own_output = is_own_output;
    }

    /// Returns whether the latest reading was new when it arrived, rather than a server's cached
    /// one.
    pub fn is_live(&self) -> bool {
        self.age.is_some_and(|age| age <= LIVE_WITHIN)
    }

    /// Returns whether the latest reading was the agent's own output.
    pub fn is_own_output(&self) -> bool {
        self.is_own_output
    }

    /// Returns the readings a second.
    pub fn rate_hz(&self) -> Option<f64> {
        let passed_s = self.times_s.back()? - self.times_s.front()?;
        (passed_s > 0.0).then(|| (self.times_s.len() - 1) as f64 / passed_s)
    }

    /// Returns the latest values as text.
    pub fn last(&self) -> String {
        let values = self.values.iter().map(|seen| value_text(&seen.reading));
        values.collect::<Vec<_>>().join(", ")
    }

    /// Returns the source as it is shown.
    pub fn report(
        &self,
        source: &Source,
        uses: &[(&'static str, bool)],
        now: Instant,
    ) -> SourceReport {
        let roles = |serves: bool| {
            let roles = uses.iter().filter(|(_, is_served)| *is_served == serves);
            roles.map(|(role, _)| (*role).to_owned()).collect()
        };
        let passed = now.saturating_duration_since(self.heard);
        SourceReport {
            input: source.input.to_string(),
            talker: source.talker_text(),
            sentence: source.sentence_text(),
            source: source.signalk.as_deref().map(str::to_owned),
            sfi: source.sfi.as_deref().map(str::to_owned),
            sender: source.sender.map(|sender| sender.to_string()),
            n2k_address: source.n2k_address.map(Address::number),
            n2k_name: source.n2k_name.map(|name| name.to_string()),
            rate_hz: self.rate_hz().map(|rate| (rate * 100.0).round() / 100.0),
            last: self.last(),
            heard_s_ago: (passed.as_secs_f64() * 10.0).round() / 10.0,
            age_s: self
                .age
                .map(|age| (age.as_secs_f64() * 10.0).round() / 10.0),
            serves: roles(true),
            stands_by: roles(false),
            own_output: self.is_own_output,
        }
    }
}

impl SourceReport {
    /// Formats the source in one line.
    pub fn line(&self) -> String {
        let device = self.source.as_deref().unwrap_or(&self.talker);
        let separator = if self.source.is_some() { " " } else { "" };
        let mut name = format!("{} {device}{separator}{}", self.input, self.sentence);
        for (what, text) in [(" of ", &self.sfi), (" from ", &self.sender)] {
            if let Some(text) = text {
                name += what;
                name += text;
            }
        }
        if let Some(address) = self.n2k_address {
            name = format!("{name} ({address})");
        }
        let rate = self
            .rate_hz
            .map_or("once".to_owned(), |rate| format!("{rate:.1}/s"));
        let age = match self.age_s {
            None => ", not yet known to be new".to_owned(),
            Some(age_s) if age_s >= 1.0 => format!(", {age_s:.0} s late"),
            Some(_) => String::new(),
        };
        let role = if self.own_output {
            " [own output]".to_owned()
        } else if !self.serves.is_empty() {
            format!(" [{}]", self.serves.join(", "))
        } else if !self.stands_by.is_empty() {
            format!(" [not used as {}]", self.stands_by.join(", "))
        } else {
            String::new()
        };
        format!("{name}  {rate}  {}{age}{role}", self.last)
    }
}

fn value_text(reading: &Reading) -> String {
    match reading {
        Reading::Compass { raw, .. } => format!("compass {raw}"),
        Reading::Magnetic { heading, .. } => format!("magnetic {heading}"),
        Reading::True(heading) => format!("true {heading}"),
        Reading::TrueNotValid => "true heading not valid".to_owned(),
        Reading::Fix { position, .. } => {
            format!("{:.4} {:.4}", position.lat_deg(), position.lon_deg())
        }
        Reading::Time(at) => at.to_string(),
        Reading::Greeting(at) => format!("greeting at {at}"),
        Reading::Speed { sog_kn } => format!("{sog_kn:.1} kn"),
        Reading::Course(course) => format!("course {:.1}°", course.degrees()),
        Reading::WaterSpeed { kn } => format!("{kn:.1} kn through the water"),
        Reading::RateOfTurn { deg_min } => format!("{deg_min:.1}°/min"),
        Reading::Roll { deg } => format!("roll {deg:.1}°"),
        Reading::Temperature { celsius } => format!("{celsius:.1} °C"),
        Reading::Pitch { deg } => format!("pitch {deg:.1}°"),
        Reading::AlertCommand(_) => "command to an alert".to_owned(),
    }
}
