//! Sources that are heard on board, and roles proposed for them.
//!
//! Nothing is guessed that would harm: a magnetic heading is a raw one only if someone says so, a
//! compass is one and not several, and a true heading of the compass's own device is left out.

use crate::acquisition::Acquisition;
use binnacle_instruments::{HeardSource, SourceReport};
use binnacle_observation::{Reading, Source};
use serde::Serialize;
use std::fmt::Write;
use tokio::time::Instant;

const GYRO_TALKER: &[u8; 2] = b"HE";
const WRITES: &str = "a String takes every write";

/// Sources that are heard, with proposed roles.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Discovery {
    sources: Vec<SourceReport>,
    problems: Vec<String>,
    /// Section `[roles]` of a configuration.
    roles: String,
}

impl Discovery {
    /// Collects what an acquisition has heard, with the inputs that cannot be opened.
    pub(crate) fn of(acquisition: &Acquisition, closed: Vec<String>, now: Instant) -> Discovery {
        let mut problems = closed;
        problems.extend(acquisition.source_problems(now));
        let heard: Vec<Heard<'_>> = acquisition.heard.sorted();
        Discovery {
            sources: acquisition.sources(now),
            problems,
            roles: propose(&heard),
        }
    }

    /// Formats the list as comments above the proposed roles: a section of a configuration.
    pub(crate) fn text(&self) -> String {
        let mut out = String::new();
        self.write_text(&mut out).expect(WRITES);
        out
    }

    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        writeln!(
            out,
            "# Heard: source, readings a second, latest values, role now."
        )?;
        for source in &self.sources {
            writeln!(out, "# {}", source.line())?;
        }
        if self.sources.is_empty() {
            writeln!(out, "# nothing")?;
        }
        for problem in &self.problems {
            writeln!(out, "# PROBLEM {}", problem.replace('\n', " "))?;
        }
        write!(out, "\n{}", self.roles)
    }
}

type Heard<'a> = (&'a Source, &'a HeardSource);

fn propose(heard: &[Heard<'_>]) -> String {
    let with = |is_kind: fn(&Reading) -> bool| -> Vec<Heard<'_>> {
        let of_kind = heard
            .iter()
            .copied()
            .filter(|(_, heard)| heard.is_live() && !heard.is_own_output())
            .filter(|(_, heard)| heard.values.iter().any(|seen| is_kind(&seen.reading)));
        let mut sources: Vec<_> = of_kind.collect();
        // A stable sort: the order of the names decides between equal rates.
        sources.sort_by(|(_, a), (_, b)| {
            let rate = |heard: &HeardSource| heard.rate_hz().unwrap_or_default();
            rate(b).total_cmp(&rate(a))
        });
        sources
    };
    let compass = with(|reading| matches!(reading, Reading::Compass { .. }));
    let magnetic = with(|reading| matches!(reading, Reading::Magnetic { .. }));
    let mut out = "[roles]\n".to_owned();
    write_compass(&mut out, heard, &compass, &magnetic);
    let is_of_compass = |source: &Source| {
        let mut magnetic = compass.iter().chain(&magnetic);
        source.names_device() && magnetic.any(|(known, _)| known.is_same_device(source))
    };
    let (copies, references): (Vec<_>, Vec<_>) =
        with(|reading| matches!(reading, Reading::True(_)))
            .into_iter()
            .partition(|(source, _)| is_of_compass(source));
    for (source, _) in copies {
        comment(
            &mut out,
            &format!("{source} is of the compass's device, and no reference"),
        );
    }
    let (gyros, others): (Vec<_>, Vec<_>) = references
        .into_iter()
        .partition(|(source, _)| source.talker == *GYRO_TALKER);
    for (source, _) in &others {
        if !source.is_of_satellites() {
            comment(
                &mut out,
                &format!("if {source} is a gyro compass, move it to gyro"),
            );
        }
    }
    write_role(&mut out, heard, "gyro", &gyros);
    write_role(&mut out, heard, "satellite", &others);
    let positions = with(|reading| matches!(reading, Reading::Fix { .. }));
    let has_rmc = positions
        .iter()
        .any(|(source, _)| source.sentence == *b"RMC");
    let positions: Vec<_> = positions
        .into_iter()
        .filter(|(source, _)| !has_rmc || source.sentence == *b"RMC")
        .collect();
    write_role(&mut out, heard, "position", &positions);
    let turning = with(|reading| matches!(reading, Reading::RateOfTurn { .. }));
    write_role(&mut out, heard, "rate_of_turn", &turning);
    let logs = with(|reading| matches!(reading, Reading::WaterSpeed { .. }));
    write_role(&mut out, heard, "log", &logs);
    let rolling = with(|reading| matches!(reading, Reading::Roll { .. }));
    write_role(&mut out, heard, "roll", &rolling);
    let warm = with(|reading| matches!(reading, Reading::Temperature { .. }));
    write_role(&mut out, heard, "temperature", &warm);
    out
}

fn write_compass(
    out: &mut String,
    heard: &[Heard<'_>],
    compass: &[Heard<'_>],
    magnetic: &[Heard<'_>],
) {
    let raw = |(source, _): &Heard<'_>| selection(source, heard).replace(" }", ", raw = true }");
    match (compass, magnetic.first()) {
        ([], None) => comment(out, "no compass is heard"),
        ([], Some(first)) => {
            comment(out, "only if no deviation is applied to this heading:");
            comment(out, &format!("compass = [{}]", raw(first)));
        }
        ([first, others @ ..], _) => {
            for (source, _) in others {
                comment(
                    out,
                    &format!("another compass: {}", selection(source, heard)),
                );
            }
            write_role(out, heard, "compass", std::slice::from_ref(first));
        }
    }
}

fn write_role(out: &mut String, heard: &[Heard<'_>], role: &str, sources: &[Heard<'_>]) {
    if sources.is_empty() {
        return;
    }
    let selections: Vec<String> = sources
        .iter()
        .map(|(source, _)| format!("    {},\n", selection(source, heard)))
        .collect();
    let written = match selections.as_slice() {
        [one] => format!("{role} = [{}]", one.trim().trim_end_matches(',')),
        all => format!("{role} = [\n{}]", all.concat()),
    };
    out.push_str(&written);
    out.push('\n');
}

fn comment(out: &mut String, text: &str) {
    out.push_str("# ");
    out.push_str(&text.replace('\n', " "));
    out.push('\n');
}

/// Returns the keys that select a source among all that are heard.
fn selection(source: &Source, heard: &[Heard<'_>]) -> String {
    let mut keys = format!("input = {}", quoted(&source.input));
    match &source.signalk {
        Some(signalk) => push_key(&mut keys, "source", signalk),
        None => push_key(&mut keys, "talker", &source.talker_text()),
    }
    push_key(&mut keys, "sentence", &source.sentence_text());
    if let Some(sfi) = &source.sfi {
        push_key(&mut keys, "sfi", sfi);
    }
    // Devices that send alike differ in these alone.
    let twins = || heard.iter().filter(|(other, _)| is_twin(other, source));
    if let Some(sender) = source.sender
        && twins().any(|(other, _)| other.sender != source.sender)
    {
        push_key(&mut keys, "sender", &sender.to_string());
    }
    if twins().any(|(other, _)| !other.is_same_device(source)) {
        match (source.n2k_name, source.n2k_address) {
            (Some(name), _) => push_key(&mut keys, "n2k_name", &name.to_string()),
            (None, Some(address)) => {
                write!(keys, ", n2k_address = {}", address.number()).expect(WRITES);
            }
            (None, None) => {}
        }
    }
    format!("{{ {keys} }}")
}

/// Returns whether two sources have the same name but for the sender and the device.
fn is_twin(one: &Source, other: &Source) -> bool {
    let name = |source: &Source| Source {
        sender: None,
        n2k_address: None,
        n2k_name: None,
        ..source.clone()
    };
    name(one) == name(other)
}

fn push_key(keys: &mut String, key: &str, value: &str) {
    write!(keys, ", {key} = {}", quoted(value)).expect(WRITES);
}

fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}
