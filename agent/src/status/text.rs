//! The status as text for a terminal.

use super::{InputReport, ModelStatus, Status};
use binnacle_wire::alert::ShipAlertState;
use binnacle_wire::messages::CardWithdrawn;
use std::fmt::Write;

/// Age up to which live values need no remark, seconds: they are put together every second.
const FRESH_S: f64 = 3.0;

impl Status {
    /// Formats the status in one line, for the service manager.
    pub(crate) fn line(&self) -> String {
        let heading = match &self.heading.problem {
            None => "the heading is corrected".to_owned(),
            Some(problem) => format!("the heading is not corrected: {problem}"),
        };
        let link = self.link.state.words();
        let waiting = self.spool.waiting_batches;
        let storage = match &self.storage_problem {
            None => String::new(),
            Some(problem) => format!("; {problem}"),
        };
        format!("{heading}; link {link}, {waiting} batches to send{storage}")
    }

    /// Formats the status for a terminal.
    pub(crate) fn text(&self) -> String {
        let mut out = String::new();
        self.write_text(&mut out)
            .expect("a String takes every write");
        out
    }

    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        let running = match (self.running, self.age_s) {
            (true, Some(age_s)) if age_s > FRESH_S => format!("running, values {age_s:.0} s old"),
            (true, Some(_)) => "running".to_owned(),
            (true, None) => "running, but does not respond: as stored on the disk".to_owned(),
            (false, _) => "not running".to_owned(),
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
        if let Some(interference) = &self.gnss_interference {
            writeln!(out, "GNSS       {}", interference.summary)?;
        }
        for problem in &self.source_problems {
            writeln!(out, "SOURCES    {problem}")?;
        }
        self.write_alert(out)?;
        self.write_heading_difference(out)?;
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
                if !model.reference_grade.is_heading() {
                    writeln!(out, "           {}", ModelStatus::BY_COURSE)?;
                }
                if let Some(withdrawn) = &model.withdrawn {
                    writeln!(out, "           {withdrawn}: not in use")?;
                    writeln!(out, "           {}", CardWithdrawn::ADVICE)?;
                } else if let Some(replaces) = &model.replaces {
                    writeln!(out, "           {}", replaces.of_older_cards())?;
                }
            }
            None => writeln!(out, "model      none")?,
        }
        if let Some(exclusion) = self.exclusion {
            writeln!(out, "hold       {exclusion}: nothing is sampled")?;
        }
        self.write_link(out)?;
        for input in &self.inputs {
            input.write_text(out)?;
        }
        for source in &self.sources {
            writeln!(out, "source     {}", source.line())?;
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
            return writeln!(out, "alert      {}", alert.summary);
        }
        let seen = if alert.acknowledged {
            " (acknowledged)"
        } else {
            ""
        };
        writeln!(out, "ALERT      {}{seen}", alert.summary)?;
        writeln!(out, "           {}", alert.advice)
    }

    fn write_heading_difference(&self, out: &mut String) -> std::fmt::Result {
        let open = self.heading_difference.as_ref();
        let Some(difference) = open.filter(|known| known.alarm.is_open) else {
            return Ok(());
        };
        let seen = if difference.alarm.acknowledged {
            " (acknowledged)"
        } else {
            ""
        };
        writeln!(out, "ALERT      {}{seen}", difference.summary)?;
        writeln!(out, "           {}", difference.advice)
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
        write!(out, "link       {}", self.link.state.words())?;
        if let Some(problem) = &self.link.problem {
            write!(out, ": {problem}")?;
        }
        if let Some(contact) = self.link.last_contact {
            write!(out, ", last response {contact}")?;
        }
        writeln!(out)?;
        if let Some(budget) = &self.budget {
            write!(out, "profile    {}", budget.profile)?;
            if let Some(day) = budget.daily_bytes {
                let left = budget.remaining_bytes;
                write!(out, ", {left:.0} bytes left at {day:.0} a day")?;
            }
            if let Some(bytes) = budget.connection_bytes {
                write!(out, ", a connection costs {bytes:.0}")?;
            }
            write!(out, ", {:.1} kB in all", budget.total_bytes / 1e3)?;
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
                "           {} batches were thinned for disk space or budget",
                spool.thinned_batches
            )?;
        }
        if let Some(raw_log) = &self.raw_log {
            let (size, limit) = (raw_log.bytes as f64 / 1e6, raw_log.limit_bytes as f64 / 1e6);
            write!(out, "ring       {size:.1} of {limit:.1} MB")?;
            if let Some(problem) = &raw_log.problem {
                write!(out, ", nothing is recorded for now: {problem}")?;
            }
            writeln!(out)?;
        }
        if spool.parked_batches > 0 {
            let because = spool.parked_because.as_deref().unwrap_or("no reason given");
            writeln!(
                out,
                "REFUSED    {} batches are kept aside: {because}",
                spool.parked_batches
            )?;
        }
        Ok(())
    }
}

impl InputReport {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alert::InterferenceMonitor;
    use crate::config::Profile;
    use crate::corrected_heading::CorrectedHeading;
    use crate::sampler::Exclusion;
    use crate::spool::{BudgetAccount, SpoolStatus};
    use binnacle_compass::model::ReferenceGrade;
    use binnacle_compass::position::Position;
    use binnacle_compass::time::Timestamp;
    use binnacle_instruments::{Interference, SourceReport};

    #[test]
    fn the_text_says_what_is_wrong() {
        let mut interference = InterferenceMonitor::default();
        let met = Interference {
            since: Timestamp::parse("2026-11-20T06:30:00Z").ok(),
            place: Position::new(36.0, 15.0).unwrap(),
        };
        interference.observe(Some(met), || uuid::Uuid::from_u128(1));
        let status = Status {
            agent_version: "0.1.0".to_owned(),
            exclusion: Some(Exclusion::Berthed),
            model: Some(ModelStatus {
                version: 4,
                data_until: Timestamp::parse("2026-11-20T00:00:00Z").unwrap(),
                age_days: None,
                withdrawn: None,
                replaces: None,
                reference_grade: ReferenceGrade::CourseOverGround,
            }),
            clock_problem: Some("the receiver's time jumped".to_owned()),
            storage_problem: Some("samples cannot be stored".to_owned()),
            gnss_interference: interference.status(),
            source_problems: vec!["gyro: two sensors".to_owned()],
            sources: vec![SourceReport {
                input: "bridge".to_owned(),
                talker: "HC".to_owned(),
                sentence: "HDG".to_owned(),
                rate_hz: Some(10.0),
                last: "compass 090.0°".to_owned(),
                age_s: Some(0.0),
                serves: vec!["compass".to_owned()],
                ..SourceReport::default()
            }],
            heading: CorrectedHeading {
                problem: Some("there is no model yet".to_owned()),
                ..CorrectedHeading::default()
            },
            budget: Some(BudgetAccount {
                profile: Profile::Metered,
                daily_bytes: Some(8_000.0),
                remaining_bytes: -120.4,
                ship_time: None,
                connection_bytes: Some(4_400.0),
                total_bytes: 12_345.0,
            }),
            spool: SpoolStatus {
                parked_batches: 2,
                parked_because: Some("422 undecodable".to_owned()),
                ..SpoolStatus::default()
            },
            ..Status::default()
        };
        let line = status.line();
        assert_eq!(
            line,
            "the heading is not corrected: there is no model yet; link not enrolled, 0 batches to \
             send; samples cannot be stored"
        );
        let text = status.text();
        for wanted in [
            "0.1.0 not running",
            "berthed: nothing is sampled",
            "no gyro or satellite compass checks it",
            "CLOCK      the receiver's time jumped\n",
            "STORAGE    samples cannot be stored\n",
            "GNSS       GNSS interference since 20 Nov 06:30 UTC",
            "SOURCES    gyro: two sensors\n",
            "source     bridge HCHDG  10.0/s  compass 090.0° [compass]\n",
            "not corrected: there is no model yet",
            "link       not enrolled\n",
            "profile    metered, -120 bytes left at 8000 a day, a connection costs 4400, 12.3 kB in all\n",
            "2 batches are kept aside: 422 undecodable",
        ] {
            assert!(text.contains(wanted), "{wanted:?} is not in\n{text}");
        }
    }
}
