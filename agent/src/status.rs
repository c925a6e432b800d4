//! How everything is, in one value: for the local page and for `status`.

use crate::alert::AlertStatus;
use crate::corrected::{CardRow, Corrected};
use crate::hold::Hold;
use crate::input::InputStatus;
use crate::ring::RingStatus;
use crate::spool::Standing;
use crate::uplink::{Account, LinkStatus};
use binnacle_magnetics::angle::TrueHeading;
use binnacle_magnetics::time::Timestamp;
use binnacle_wire::alert::ShipAlertState;
use binnacle_wire::messages::CardWithdrawn;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Everything the page shows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Status {
    /// The agent's version.
    pub(crate) agent_version: String,
    /// Whether an agent is running: the rest is live then, else from the spool.
    pub(crate) running: bool,
    pub(crate) vessel_name: Option<String>,
    pub(crate) compass_name: Option<String>,
    /// The ship's own time.
    pub(crate) ship_time: Option<Timestamp>,
    /// What is wrong with the receiver's time.
    #[serde(default)]
    pub(crate) clock_problem: Option<String>,
    /// Why samples cannot be stored.
    #[serde(default)]
    pub(crate) storage_problem: Option<String>,
    pub(crate) heading: Corrected,
    /// The agent's last alert of its own: open, or how it ended.
    #[serde(default)]
    pub(crate) alert: Option<AlertStatus>,
    pub(crate) gyro_deg: Option<TrueHeading>,
    pub(crate) satellite_deg: Option<TrueHeading>,
    pub(crate) sog_kn: Option<f64>,
    pub(crate) rate_of_turn_deg_min: Option<f64>,
    pub(crate) roll_deg: Option<f64>,
    pub(crate) model: Option<ModelStatus>,
    /// Deviation on every 15° at the ship's place.
    pub(crate) card: Vec<CardRow>,
    pub(crate) hold: Option<Hold>,
    /// Ten-second windows by outcome since the agent started.
    pub(crate) windows: BTreeMap<String, u64>,
    pub(crate) inputs: Vec<InputReport>,
    pub(crate) link: LinkStatus,
    pub(crate) spool: Standing,
    /// What the link may cost, and what is left of it.
    #[serde(default)]
    pub(crate) budget: Option<Account>,
    /// What was said in each second, kept on board.
    #[serde(default)]
    pub(crate) ring: Option<RingStatus>,
}

/// The model in use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ModelStatus {
    pub(crate) version: u32,
    /// The time of its last sample.
    pub(crate) data_until: Timestamp,
    /// Since then, by the ship's time.
    pub(crate) age_days: Option<f64>,
    /// Why it holds no more; nothing is corrected by it then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) withdrawn: Option<CardWithdrawn>,
    /// Why no card from before its epoch holds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) replaces: Option<CardWithdrawn>,
}

/// How an input is doing; counts are since the agent started.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct InputReport {
    pub(crate) name: String,
    pub(crate) connected: bool,
    /// Why it is not connected.
    pub(crate) problem: Option<String>,
    pub(crate) last_heard_s_ago: Option<f64>,
    /// Sentences and values that were understood, by kind.
    pub(crate) sentences: BTreeMap<String, u64>,
    /// Lines that were not used, by reason.
    pub(crate) rejected: BTreeMap<String, u64>,
    /// Observations for which there was no room.
    pub(crate) dropped: u64,
}

impl InputReport {
    /// An input's counts under its name.
    pub(crate) fn new(name: &str, status: InputStatus) -> InputReport {
        let owned = |counts: BTreeMap<&'static str, u64>| {
            let owned = counts.into_iter();
            owned
                .map(|(name, count)| (name.to_owned(), count))
                .collect()
        };
        InputReport {
            name: name.to_owned(),
            connected: status.connected,
            problem: status.problem,
            last_heard_s_ago: status.last_heard_s_ago,
            sentences: owned(status.sentences),
            rejected: owned(status.rejected),
            dropped: status.dropped,
        }
    }

    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        let state = match (&self.problem, self.connected) {
            (_, true) => "connected",
            (Some(problem), false) => problem,
            (None, false) => "not connected",
        };
        let sentences: u64 = self.sentences.values().sum();
        write!(
            out,
            "input      {}: {state}, {sentences} sentences",
            self.name
        )?;
        for (reason, lines) in &self.rejected {
            write!(out, ", {lines} {reason}")?;
        }
        if self.dropped > 0 {
            write!(out, ", {} dropped", self.dropped)?;
        }
        writeln!(out)
    }
}

impl Status {
    /// As text for a terminal.
    pub(crate) fn text(&self) -> String {
        let mut out = String::new();
        self.write_text(&mut out)
            .expect("a String takes every write");
        out
    }

    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        let running = if self.running {
            "running"
        } else {
            "not running"
        };
        writeln!(out, "agent      {} {running}", self.agent_version)?;
        if let (Some(vessel), Some(compass)) = (&self.vessel_name, &self.compass_name) {
            writeln!(out, "vessel     {vessel}, {compass}")?;
        }
        if let Some(time) = self.ship_time {
            writeln!(out, "ship time  {time}")?;
        }
        for (what, problem) in [
            ("CLOCK", &self.clock_problem),
            ("STORAGE", &self.storage_problem),
        ] {
            if let Some(problem) = problem {
                writeln!(out, "{what:<11}{problem}")?;
            }
        }
        self.write_alert(out)?;
        self.write_heading(out)?;
        match &self.model {
            Some(model) => {
                let age = model.age_days.map(|d| format!(", {d:.1} days old"));
                let age = age.unwrap_or_default();
                writeln!(
                    out,
                    "model      version {}, data until {}{age}",
                    model.version, model.data_until
                )?;
                if let Some(withdrawn) = &model.withdrawn {
                    writeln!(out, "           {withdrawn}: not in use")?;
                    writeln!(out, "           {}", CardWithdrawn::ADVICE)?;
                } else if let Some(replaces) = &model.replaces {
                    writeln!(out, "           {}", replaces.of_older_cards())?;
                }
            }
            None => writeln!(out, "model      none")?,
        }
        if let Some(hold) = self.hold {
            writeln!(out, "hold       {hold}: nothing is sampled")?;
        }
        self.write_link(out)?;
        for input in &self.inputs {
            input.write_text(out)?;
        }
        for (outcome, windows) in &self.windows {
            writeln!(out, "windows    {windows} {outcome}")?;
        }
        Ok(())
    }

    fn write_alert(&self, out: &mut String) -> std::fmt::Result {
        let Some(alert) = &self.alert else {
            return Ok(());
        };
        if alert.alert.state != ShipAlertState::Open {
            return writeln!(out, "alert      {}", alert.says);
        }
        let seen = if alert.acknowledged {
            " (acknowledged)"
        } else {
            ""
        };
        writeln!(out, "ALERT      {}{seen}", alert.says)?;
        writeln!(out, "           {}", alert.advice)
    }

    fn write_heading(&self, out: &mut String) -> std::fmt::Result {
        let heading = &self.heading;
        if let Some(compass) = heading.compass_deg {
            writeln!(out, "compass    {compass}")?;
        }
        if let (Some(deviation), Some(magnetic)) = (heading.deviation_deg, heading.magnetic_deg) {
            let band = heading.band95_deg.map(|band| format!(" ± {band:.1}°"));
            writeln!(
                out,
                "magnetic   {magnetic} (deviation {deviation}{})",
                band.unwrap_or_default()
            )?;
        }
        if let (Some(variation), Some(true_heading)) = (heading.variation_deg, heading.true_deg) {
            writeln!(out, "true       {true_heading} (variation {variation})")?;
        }
        if let Some(problem) = &heading.problem {
            writeln!(out, "heading    not corrected: {problem}")?;
        }
        Ok(())
    }

    fn write_link(&self, out: &mut String) -> std::fmt::Result {
        let state = serde_json::to_value(self.link.state).unwrap_or_default();
        let state = state.as_str().unwrap_or_default().replace('_', " ");
        write!(out, "link       {state}")?;
        if let Some(problem) = &self.link.problem {
            write!(out, ": {problem}")?;
        }
        if let Some(contact) = self.link.last_contact {
            write!(out, ", last answer {contact}")?;
        }
        writeln!(out)?;
        if let Some(budget) = &self.budget {
            write!(out, "profile    {}", budget.profile)?;
            if let Some(day) = budget.day_octets {
                let left = budget.left_octets;
                write!(out, ", {left:.0} octets left at {day:.0} a day")?;
            }
            writeln!(out)?;
        }
        let spool = &self.spool;
        writeln!(
            out,
            "spool      {} samples not sealed, {} batches to send, {} acknowledged",
            spool.pending_samples, spool.waiting_batches, spool.acknowledged_batches
        )?;
        if spool.thinned_batches > 0 {
            writeln!(
                out,
                "           {} batches were thinned for want of room or budget",
                spool.thinned_batches
            )?;
        }
        if let Some(ring) = &self.ring {
            let (octets, limit) = (ring.octets as f64 / 1e6, ring.limit_octets as f64 / 1e6);
            write!(out, "ring       {octets:.1} of {limit:.1} MB")?;
            if let Some(problem) = &ring.problem {
                write!(out, ", nothing is kept for now: {problem}")?;
            }
            writeln!(out)?;
        }
        if spool.parked_batches > 0 {
            let because = spool.parked_because.as_deref().unwrap_or("no reason given");
            writeln!(
                out,
                "REFUSED    {} batches were refused by the shore: {because}",
                spool.parked_batches
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uplink::Profile;

    #[test]
    fn the_text_says_what_is_wrong() {
        let status = Status {
            agent_version: "0.1.0".to_owned(),
            hold: Some(Hold::Berthed),
            clock_problem: Some("the receiver's time jumped".to_owned()),
            storage_problem: Some("samples cannot be stored".to_owned()),
            heading: Corrected {
                problem: Some("there is no model yet".to_owned()),
                ..Corrected::default()
            },
            budget: Some(Account {
                profile: Profile::Metered,
                day_octets: Some(8_000.0),
                left_octets: -120.4,
                ship_time: None,
            }),
            spool: Standing {
                parked_batches: 2,
                parked_because: Some("422 undecodable".to_owned()),
                ..Standing::default()
            },
            ..Status::default()
        };
        let text = status.text();
        for wanted in [
            "0.1.0 not running",
            "berthed: nothing is sampled",
            "CLOCK      the receiver's time jumped\n",
            "STORAGE    samples cannot be stored\n",
            "not corrected: there is no model yet",
            "link       not enrolled\n",
            "profile    metered, -120 octets left at 8000 a day\n",
            "2 batches were refused by the shore: 422 undecodable",
        ] {
            assert!(text.contains(wanted), "{wanted:?} is not in\n{text}");
        }
    }

    #[test]
    fn the_json_reads_back() {
        let status = Status::default();
        let json = serde_json::to_string(&status).unwrap();
        assert_eq!(serde_json::from_str::<Status>(&json).unwrap(), status);
    }
}
