//! Role of one instrument: its selections, ranked, and the device that each of them uses.
//!
//! Invariants:
//!
//! - A selection is used while no better one has been heard within the silence limit.
//! - Of several devices that match a selection, one is used while it is heard, the first by its
//!   name. All are named, and their readings are never mixed.
//! - When another source of a heading has fallen silent, one that has not moved by itself since is
//!   not used: a repeater goes on saying the last heading. The first selection is excepted, while
//!   one device alone matches it.

use super::own_output::AGENT_TALKER;
use super::succession::Succession;
use super::two_sensors::TwoSensors;
use crate::config::SourceConfig;
use binnacle_compass::sample::SourceId;
use binnacle_compass::time::Timestamp;
use binnacle_observation::{Observation, Reading, Source};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::Instant;

/// Devices of a role that are remembered.
const MAX_DEVICES: usize = 16;

/// Selections of one instrument, best first.
#[derive(Debug)]
pub(super) struct Role {
    name: &'static str,
    selections: Vec<Selection>,
    stale_s: f64,
    /// Devices that have served, in the order of their first readings.
    served: Vec<Source>,
    /// Device that has served last.
    in_use: Option<Source>,
    succession: Succession,
    /// Headings that the agent itself sends.
    own_headings: Vec<([u8; 2], [u8; 3])>,
}

/// Moment of an observation, by both clocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    /// GNSS time, once it is known.
    pub(super) ship: Option<Timestamp>,
    /// Computer's time when the reading was measured.
    pub(super) measured: Instant,
    /// Age on arrival.
    pub(super) age: Duration,
}

/// Use of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Use {
    /// Another source is used, or the reading is old.
    None,
    /// It is that of the source in use.
    Used(SourceId),
    /// Two sensors cannot be distinguished, or another device has taken over.
    Mixed,
}

impl Use {
    /// Returns the source whose reading is used.
    pub(super) fn source(self) -> Option<SourceId> {
        match self {
            Use::Used(source) => Some(source),
            Use::None | Use::Mixed => None,
        }
    }
}

#[derive(Debug)]
struct Selection {
    input: Option<Arc<str>>,
    config: SourceConfig,
    id: SourceId,
    heard: Option<Moment>,
    device: Option<Source>,
    /// Another device that matches, when it was last heard.
    other: Option<(Source, Moment)>,
    two_sensors: TwoSensors,
}

impl Role {
    pub(super) fn new(name: &'static str, sources: &[SourceConfig], stale_s: f64) -> Role {
        let selections = sources.iter().map(|config| Selection {
            input: config
                .input
                .as_ref()
                .map(|name| name.get_ref().as_str().into()),
            config: config.clone(),
            id: SourceId::from_name(&config.name()),
            heard: None,
            device: None,
            other: None,
            two_sensors: TwoSensors::default(),
        });
        Role {
            name,
            selections: selections.collect(),
            stale_s,
            served: Vec::new(),
            in_use: None,
            succession: Succession::default(),
            own_headings: vec![(AGENT_TALKER, *b"HDG"), (AGENT_TALKER, *b"THS")],
        }
    }

    /// Adds headings that the agent itself sends. Of another talker than the usual one they may
    /// be an instrument's as well: those are known by their content alone.
    pub(super) fn add_own_headings(&mut self, headings: &[([u8; 2], [u8; 3])]) {
        let own = headings
            .iter()
            .filter(|(talker, _)| *talker == AGENT_TALKER);
        self.own_headings.extend(own);
    }

    /// Returns whether the selection of a rank names a talker.
    pub(super) fn names_talker(&self, rank: usize) -> bool {
        self.selections[rank].config.talker.is_some()
    }

    /// Returns the name of the role.
    pub(super) fn name(&self) -> &'static str {
        self.name
    }

    /// Records a reading that is no direction.
    pub(super) fn note_reading(&mut self, seen: &Observation, moment: Moment) -> Use {
        self.note(seen, moment, None)
    }

    /// Records a heading in degrees.
    pub(super) fn note_heading(&mut self, seen: &Observation, moment: Moment, deg: f64) -> Use {
        self.note(seen, moment, Some(deg))
    }

    fn note(&mut self, seen: &Observation, moment: Moment, heading_deg: Option<f64>) -> Use {
        let Some(rank) = self.rank(seen) else {
            return Use::None;
        };
        if !self.is_recent(moment) {
            return Use::None;
        }
        if heading_deg.is_some_and(|degrees| !self.may_serve(rank, &seen.source, moment, degrees)) {
            return Use::None;
        }
        let changes = match self.choose_device(rank, &seen.source, moment) {
            Choice::Other => return Use::None,
            Choice::Taken => true,
            Choice::InUse => false,
        };
        let selection = &mut self.selections[rank];
        selection.heard = Some(moment);
        if changes {
            selection.two_sensors = TwoSensors::default();
        }
        let difference_deg = heading_deg.and_then(|degrees| selection.two_sensors.observe(degrees));
        let id = selection.id;
        if !self.is_best(rank, moment) {
            return Use::None;
        }
        self.note_served(&seen.source);
        if self.in_use.as_ref() != Some(&seen.source) {
            self.in_use = Some(seen.source.clone());
        }
        if changes || difference_deg.is_some() {
            return Use::Mixed;
        }
        Use::Used(id)
    }

    /// Returns whether a heading may be used unless a better one is alive.
    fn may_serve(
        &mut self,
        rank: usize,
        source: &Source,
        moment: Moment,
        heading_deg: f64,
    ) -> bool {
        let in_use = self.in_use.as_ref();
        if in_use.is_some_and(|device| device.is_same_device(source)) {
            return self.may_stay(rank, source, moment, heading_deg);
        }
        let selection = &self.selections[rank];
        let before = selection.device.as_ref();
        let is_first = before.is_none_or(|device| device.device_order(source).is_ge());
        if rank == 0 && is_first {
            return true;
        }
        let is_better_alive =
            !self.is_best(rank, moment) || (!is_first && self.is_alive(selection.heard, moment));
        if is_better_alive {
            self.succession.note_better(source);
            return true;
        }
        self.succession
            .has_moved(source, heading_deg, moment.measured)
    }

    /// Returns whether the device in use may stay so: it may be the repeater of another one of its
    /// selection that has died.
    fn may_stay(&mut self, rank: usize, source: &Source, moment: Moment, heading_deg: f64) -> bool {
        let other = self.selections[rank].other.as_ref();
        let Some(silent_s) = other.map(|(_, heard)| silence_s(*heard, moment)) else {
            return true;
        };
        // What comes late, or settles, is not yet motion of its own.
        if silent_s < self.stale_s / 2.0 {
            self.succession.note_better(source);
            return true;
        }
        let has_moved = self
            .succession
            .has_moved(source, heading_deg, moment.measured);
        if has_moved {
            self.selections[rank].other = None;
        }
        has_moved || silent_s <= self.stale_s
    }

    /// Chooses between the device in use and that of a reading.
    fn choose_device(&mut self, rank: usize, source: &Source, moment: Moment) -> Choice {
        let selection = &self.selections[rank];
        let is_alive = self.is_alive(selection.heard, moment);
        let selection = &mut self.selections[rank];
        let Some(device) = &selection.device else {
            selection.device = Some(source.clone());
            return Choice::InUse;
        };
        if device.is_same_device(source) {
            return Choice::InUse;
        }
        if is_alive && device.device_order(source).is_lt() {
            selection.other = Some((source.clone(), moment));
            return Choice::Other;
        }
        let before = selection.device.replace(source.clone());
        selection.other = before.zip(selection.heard);
        Choice::Taken
    }

    /// Records that a device serves.
    pub(super) fn note_served(&mut self, source: &Source) {
        let is_known = self.has_served(source);
        if !is_known && self.served.len() < MAX_DEVICES {
            self.served.push(source.clone());
        }
    }

    /// Returns whether a device has served in this role.
    pub(super) fn has_served(&self, source: &Source) -> bool {
        self.served.iter().any(|known| known.is_same_device(source))
    }

    /// Records that a source is invalid. Returns whether it was in use.
    pub(super) fn note_invalid(&mut self, seen: &Observation, moment: Moment) -> bool {
        let Some(rank) = self.rank(seen) else {
            return false;
        };
        let selection = &mut self.selections[rank];
        let device = selection.device.as_ref();
        if device.is_some_and(|device| !device.is_same_device(&seen.source)) {
            return false;
        }
        selection.heard = None;
        self.is_best(rank, moment)
    }

    /// Returns whether no better selection is alive.
    pub(super) fn is_best(&self, rank: usize, moment: Moment) -> bool {
        !self.selections[..rank]
            .iter()
            .any(|better| self.is_alive(better.heard, moment))
    }

    /// Returns whether any of its selections is alive.
    pub(super) fn is_served(&self, moment: Moment) -> bool {
        !self.is_best(self.selections.len(), moment)
    }

    /// Returns whether a reading is recent enough to be used.
    pub(super) fn is_recent(&self, moment: Moment) -> bool {
        moment.age.as_secs_f64() <= self.stale_s
    }

    fn is_alive(&self, heard: Option<Moment>, now: Moment) -> bool {
        heard.is_some_and(|heard| silence_s(heard, now) <= self.stale_s)
    }

    /// Returns the rank of the selection that an observation matches.
    pub(super) fn rank(&self, seen: &Observation) -> Option<usize> {
        self.selections
            .iter()
            .position(|selection| selection.matches(seen, &self.own_headings))
    }

    /// Returns the rank of the selection of the same device: ZDA and VTG come from the receiver
    /// whose position is used.
    pub(super) fn device_rank(&self, source: &Source) -> Option<usize> {
        self.selections
            .iter()
            .position(|selection| selection.matches_device(source))
    }

    /// Describes the sources that may be repeaters, and the selections that match more than one
    /// sensor.
    pub(super) fn problems(&self, now: Moment) -> impl Iterator<Item = String> {
        let still = self.succession.still(now.measured).map(|source| {
            format!(
                "{}: {source} has not moved by itself while another source is silent: it may repeat \
                 the last heading, and is not used until it moves",
                self.name
            )
        });
        still.chain(self.mixed(now))
    }

    fn mixed(&self, now: Moment) -> impl Iterator<Item = String> {
        self.selections.iter().flat_map(move |selection| {
            let device = selection
                .device
                .as_ref()
                .filter(|_| self.is_alive(selection.heard, now));
            let name = self.name;
            let mixed = device.zip(selection.two_sensors.difference_deg());
            let mixed = mixed.map(|(device, degrees)| {
                format!("{name}: two sensors {degrees:.1}° apart send as {device}: neither is used")
            });
            let other = selection.other.as_ref();
            let other = other.filter(|(_, heard)| self.is_alive(Some(*heard), now));
            let both = device.zip(other).map(|(device, (other, _))| {
                format!("{name}: both {device} and {other} match one selection: {device} is used")
            });
            mixed.into_iter().chain(both)
        })
    }
}

/// Choice between the device in use and another.
enum Choice {
    InUse,
    Taken,
    Other,
}

/// Returns the seconds since a reading: by both clocks, for recorded time runs fast, and GNSS time
/// stands still when its receiver fails.
fn silence_s(heard: Moment, now: Moment) -> f64 {
    let passed = now.measured.saturating_duration_since(heard.measured);
    let by_ship = match (heard.ship, now.ship) {
        (Some(heard), Some(now)) => now.seconds_since(heard).abs(),
        (None, None) => 0.0,
        _ => f64::INFINITY,
    };
    by_ship.max(passed.as_secs_f64())
}

impl Selection {
    fn matches(&self, seen: &Observation, own_headings: &[([u8; 2], [u8; 3])]) -> bool {
        let source = &seen.source;
        if self
            .config
            .sentence
            .is_some_and(|wanted| wanted != source.sentence)
        {
            return false;
        }
        // Without a configured talker, the agent's own output is excluded: on a shared line a dead
        // compass would live on as its echo.
        if self.config.talker.is_none() && own_headings.contains(&(source.talker, source.sentence))
        {
            return false;
        }
        // A magnetic heading is a raw one only where the configuration says so.
        if matches!(seen.reading, Reading::Magnetic { .. }) && !self.config.raw {
            return false;
        }
        self.matches_device(source)
    }

    fn matches_device(&self, source: &Source) -> bool {
        self.config.matches_talker(source.talker)
            && self
                .input
                .as_ref()
                .is_none_or(|input| **input == *source.input)
            && is_or_any(self.config.source.as_deref(), source.signalk.as_deref())
            && is_or_any(self.config.sfi.as_deref(), source.sfi.as_deref())
            && is_or_any(self.config.sender, source.sender)
            && is_or_any(self.config.n2k_address, source.n2k_address)
            && is_or_any(self.config.n2k_name, source.n2k_name)
    }
}

fn is_or_any<T: PartialEq + Copy>(wanted: Option<T>, found: Option<T>) -> bool {
    wanted.is_none_or(|wanted| found == Some(wanted))
}
