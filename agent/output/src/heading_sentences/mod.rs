//! The corrected heading as sentences for autopilots and repeaters.
//!
//! `HDG` carries the raw reading with deviation and variation filled in, `THS` the true heading in
//! mode E, `HDT` the true heading without a mode, and `$PBINQ` their quality: `$PBINQ,status,model
//! version,age in days,standard error in degrees*hh`.
//!
//! While the corrected heading is withheld, nothing can be read as a heading: THS has mode V, HDG
//! has no reading, and HDT is not sent.
//!
//! The usual talker is `II`, not `HC`: an agent that receives its own output must not take it for
//! the compass.

use crate::config::{OutputConfig, SentenceConfig, SentenceKind};
use crate::framing::frame_sentence;
use crate::heading::{Heading, Schedule, Trigger};
use crate::line::Line;
use binnacle_compass::angle::{CompassHeading, Deviation, TrueHeading, Variation};
use binnacle_nmea::sentence::{Hdg, Hdt, Ths, ThsMode};
use binnacle_nmea::{Data, Sentence, write};
use std::time::Duration;
use tokio::time::Instant;

/// Longest time until receivers hear that a heading is withheld.
const LONGEST_PAUSE: Duration = Duration::from_millis(500);

/// Quality of the model behind a heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Version of the model.
    pub version: u32,
    /// Days since its last sample.
    pub age_days: f64,
}

/// Sentences that are sent, each at its own interval.
#[derive(Debug)]
pub struct HeadingSentences {
    sentences: Vec<ScheduledSentence>,
}

/// Talker and interval of a sentence.
#[derive(Clone, Copy, Debug)]
struct ScheduledSentence {
    kind: SentenceKind,
    talker: [u8; 2],
    schedule: Schedule,
}

impl HeadingSentences {
    /// Creates the configured sentences.
    pub fn new(config: &OutputConfig) -> HeadingSentences {
        let always = SentenceConfig::ON;
        let own = [
            (SentenceKind::Hdg, config.hdg),
            (SentenceKind::Ths, config.ths),
            (SentenceKind::Hdt, config.hdt),
            (SentenceKind::Pbinq, always),
        ];
        let sent = own.into_iter().filter(|(_, own)| own.is_on);
        let sentences = sent.map(|(kind, own)| ScheduledSentence {
            kind,
            talker: own.talker.unwrap_or(config.talker),
            schedule: Schedule::new(config.interval_s(own)),
        });
        HeadingSentences {
            sentences: sentences.collect(),
        }
    }

    /// Returns the time of the next [`Trigger::Timer`], given the compass's own interval.
    pub fn next_timer(&self, compass_interval: Duration, now: Instant) -> Instant {
        let schedules = self.sentences.iter().map(|sentence| sentence.schedule);
        let times = schedules.map(|schedule| schedule.timer(compass_interval).unwrap_or(now));
        times.fold(now + LONGEST_PAUSE, Instant::min)
    }

    /// Returns the sentences that are due.
    pub fn due(
        &mut self,
        heading: &Heading,
        quality: Option<Quality>,
        trigger: Trigger,
        compass_interval: Duration,
        now: Instant,
    ) -> Vec<Line> {
        let mut lines = Vec::new();
        for sentence in &mut self.sentences {
            let is_due = sentence
                .schedule
                .take_due(heading, trigger, compass_interval, now);
            if !is_due {
                continue;
            }
            let text = sentence.text(heading, quality);
            let kind = sentence.kind;
            lines.extend(text.map(|text| Line::single(kind, text)));
        }
        lines
    }
}

impl ScheduledSentence {
    /// Returns the sentence with its line end; none for an HDT that is withheld.
    fn text(&self, heading: &Heading, quality: Option<Quality>) -> Option<Vec<u8>> {
        let data = match self.kind {
            SentenceKind::Hdg => hdg(heading),
            SentenceKind::Ths => ths(heading),
            SentenceKind::Hdt => hdt(heading)?,
            _ => return Some(quality_sentence(heading, quality)),
        };
        let mut text = Vec::with_capacity(40);
        let talker = self.talker;
        write(&Sentence { talker, data }, &mut text);
        Some(text)
    }
}

fn hdg(heading: &Heading) -> Data {
    let is_withheld = heading.true_heading.is_none();
    Data::Hdg(Hdg {
        // Without a deviation, a receiver would take the raw reading for the magnetic heading.
        reading_deg: heading
            .compass
            .filter(|_| !is_withheld)
            .map(CompassHeading::degrees)
            .map(tenth),
        deviation_deg_east: heading
            .deviation
            .filter(|_| !is_withheld)
            .map(Deviation::degrees_east)
            .map(tenth),
        variation_deg_east: heading.variation.map(Variation::degrees_east).map(tenth),
    })
}

fn ths(heading: &Heading) -> Data {
    Data::Ths(Ths {
        heading_deg_true: heading.true_heading.map(TrueHeading::degrees).map(tenth),
        mode: if heading.true_heading.is_some() {
            ThsMode::Estimated
        } else {
            ThsMode::NotValid
        },
    })
}

/// Returns HDT; none while the heading is withheld, for it cannot say so.
fn hdt(heading: &Heading) -> Option<Data> {
    let heading_deg_true = Some(tenth(heading.true_heading?.degrees()));
    Some(Data::Hdt(Hdt { heading_deg_true }))
}

fn quality_sentence(heading: &Heading, quality: Option<Quality>) -> Vec<u8> {
    let status = if heading.true_heading.is_some() {
        'A'
    } else {
        'V'
    };
    let (version, age) = match quality {
        Some(quality) => (
            quality.version.to_string(),
            format!("{:.1}", quality.age_days),
        ),
        None => (String::new(), String::new()),
    };
    let error = heading
        .standard_error_deg
        .map(|error| format!("{error:.2}"))
        .unwrap_or_default();
    frame_sentence(&format!("PBINQ,{status},{version},{age},{error}"))
}

/// Rounds to a tenth: sensors give no more, and further digits would only look better.
fn tenth(degrees: f64) -> f64 {
    (degrees * 10.0).round() / 10.0
}

#[cfg(test)]
mod tests;
