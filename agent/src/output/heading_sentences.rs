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

use super::framing::frame_sentence;
use crate::config::OutputConfig;
use crate::corrected_heading::CorrectedHeading;
use binnacle_compass::angle::{CompassHeading, Deviation, TrueHeading, Variation};
use binnacle_nmea::sentence::{Hdg, Hdt, Ths, ThsMode};
use binnacle_nmea::{Data, Sentence, write};
use std::time::Duration;
use tokio::time::Instant;

/// Longest time until receivers hear that a heading is withheld.
const LONGEST_TICK: Duration = Duration::from_millis(500);

/// Quality of the model behind a heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quality {
    /// Version of the model.
    pub(crate) version: u32,
    /// Days since its last sample.
    pub(crate) age_days: f64,
}

/// Sentences that are sent, each at its own interval.
#[derive(Debug)]
pub(crate) struct HeadingSentences {
    hdg: Option<Schedule>,
    ths: Option<Schedule>,
    hdt: Option<Schedule>,
    quality: Schedule,
    was_withheld: bool,
}

/// Talker and interval of a sentence.
#[derive(Clone, Copy, Debug)]
struct Schedule {
    talker: [u8; 2],
    interval: Duration,
    sent: Option<Instant>,
}

impl HeadingSentences {
    /// Creates the configured sentences.
    pub(crate) fn new(config: &OutputConfig) -> HeadingSentences {
        let schedule = |own: crate::config::SentenceConfig| Schedule {
            talker: own.talker.unwrap_or(config.talker),
            interval: own.interval_s.unwrap_or(config.interval_s).duration(),
            sent: None,
        };
        let if_on = |own: crate::config::SentenceConfig| own.is_on.then(|| schedule(own));
        HeadingSentences {
            hdg: if_on(config.hdg),
            ths: if_on(config.ths),
            hdt: if_on(config.hdt),
            quality: schedule(crate::config::SentenceConfig::default()),
            was_withheld: false,
        }
    }

    /// Returns the interval at which [`HeadingSentences::due`] is to be asked.
    pub(crate) fn tick(&self) -> Duration {
        let own = [self.hdg, self.ths, self.hdt, Some(self.quality)];
        let shortest = own.into_iter().flatten().map(|schedule| schedule.interval);
        shortest.fold(LONGEST_TICK, Duration::min)
    }

    /// Returns the sentences that are due, each with its line end. A heading that has just been
    /// withheld is not valid at once, whatever the intervals.
    pub(crate) fn due(
        &mut self,
        corrected: &CorrectedHeading,
        quality: Option<Quality>,
        now: Instant,
    ) -> Vec<u8> {
        let is_withheld = corrected.true_deg.is_none();
        let at_once = is_withheld && !std::mem::replace(&mut self.was_withheld, is_withheld);
        self.was_withheld = is_withheld;
        let tick = self.tick();
        let mut out = Vec::with_capacity(128);
        let mut say = |schedule: Option<&mut Schedule>, data: Option<Data>| {
            let (Some(schedule), Some(data)) = (schedule, data) else {
                return;
            };
            if schedule.is_due(tick, at_once, now) {
                let talker = schedule.talker;
                write(&Sentence { talker, data }, &mut out);
            }
        };
        say(self.hdg.as_mut(), Some(hdg(corrected)));
        say(self.ths.as_mut(), Some(ths(corrected)));
        say(self.hdt.as_mut(), hdt(corrected));
        if self.quality.is_due(tick, at_once, now) {
            write_quality(corrected, quality, &mut out);
        }
        out
    }
}

impl Schedule {
    /// Returns whether the sentence is to be sent, and notes it.
    fn is_due(&mut self, tick: Duration, at_once: bool, now: Instant) -> bool {
        let is_due = self.sent.is_none_or(|sent| {
            // Ticks come a little early or late.
            now.saturating_duration_since(sent) + tick / 2 >= self.interval
        });
        if is_due || at_once {
            self.sent = Some(now);
        }
        is_due || at_once
    }
}

fn hdg(corrected: &CorrectedHeading) -> Data {
    let is_withheld = corrected.true_deg.is_none();
    Data::Hdg(Hdg {
        // Without a deviation, a receiver would take the raw reading for the magnetic heading.
        reading_deg: corrected
            .compass_deg
            .filter(|_| !is_withheld)
            .map(CompassHeading::degrees)
            .map(tenth),
        deviation_deg_east: corrected
            .deviation_deg
            .filter(|_| !is_withheld)
            .map(Deviation::degrees_east)
            .map(tenth),
        variation_deg_east: corrected
            .variation_deg
            .map(Variation::degrees_east)
            .map(tenth),
    })
}

fn ths(corrected: &CorrectedHeading) -> Data {
    Data::Ths(Ths {
        heading_deg_true: corrected.true_deg.map(TrueHeading::degrees).map(tenth),
        mode: if corrected.true_deg.is_some() {
            ThsMode::Estimated
        } else {
            ThsMode::NotValid
        },
    })
}

/// Returns HDT; none while the heading is withheld, for it cannot say so.
fn hdt(corrected: &CorrectedHeading) -> Option<Data> {
    let heading_deg_true = Some(tenth(corrected.true_deg?.degrees()));
    Some(Data::Hdt(Hdt { heading_deg_true }))
}

fn write_quality(corrected: &CorrectedHeading, quality: Option<Quality>, out: &mut Vec<u8>) {
    let status = if corrected.true_deg.is_some() {
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
    let error = corrected
        .standard_error_deg
        .map(|error| format!("{error:.2}"))
        .unwrap_or_default();
    out.extend(frame_sentence(&format!(
        "PBINQ,{status},{version},{age},{error}"
    )));
}

/// Rounds to a tenth: sensors give no more, and further digits would only look better.
fn tenth(degrees: f64) -> f64 {
    (degrees * 10.0).round() / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(corrected: &CorrectedHeading, quality: Option<Quality>) -> String {
        let mut sentences = HeadingSentences::new(&OutputConfig::default());
        String::from_utf8(sentences.due(corrected, quality, Instant::now())).unwrap()
    }

    fn corrected(compass: f64, deviation: f64, variation: f64) -> CorrectedHeading {
        let compass = CompassHeading::new(compass).unwrap();
        let deviation = Deviation::new(deviation).unwrap();
        let variation = Variation::new(variation).unwrap();
        CorrectedHeading {
            compass_deg: Some(compass),
            deviation_deg: Some(deviation),
            standard_error_deg: Some(0.25),
            band95_deg: Some(0.5),
            variation_deg: Some(variation),
            magnetic_deg: Some(compass + deviation),
            true_deg: Some(compass + deviation + variation),
            problem: None,
        }
    }

    #[test]
    fn east_and_west_stand_in_their_places() {
        let quality = Some(Quality {
            version: 3,
            age_days: 1.04,
        });
        let said = text(&corrected(1.0, -2.5, 4.0), quality);
        let lines: Vec<&str> = said.lines().map(|l| l.split('*').next().unwrap()).collect();
        let [hdg, ths, pbinq] = lines.as_slice() else {
            panic!("{said}")
        };
        let numbers: Vec<&str> = hdg.split(',').collect();
        assert_eq!(numbers[0], "$IIHDG");
        let (deviation, variation) = (numbers[2].parse::<f64>(), numbers[4].parse::<f64>());
        assert_eq!((deviation, numbers[3]), (Ok(2.5), "W"));
        assert_eq!((variation, numbers[5]), (Ok(4.0), "E"));
        assert!(
            ths.starts_with("$IITHS,2.5") && ths.ends_with(",E"),
            "{ths}"
        );
        assert_eq!(*pbinq, "$PBINQ,A,3,1.0,0.25");
    }

    #[test]
    fn what_is_not_known_is_empty_and_not_valid() {
        let said = text(&CorrectedHeading::default(), None);
        assert!(said.starts_with("$IIHDG,,,,,*"), "{said}");
        assert!(said.contains("$IITHS,,V*"), "{said}");
        assert!(said.contains("$PBINQ,V,,,*"), "{said}");
    }

    #[test]
    fn while_a_heading_is_withheld_nothing_can_be_read_as_one() {
        let withheld = CorrectedHeading {
            magnetic_deg: None,
            true_deg: None,
            ..corrected(90.0, 2.0, 4.0)
        };
        let config: OutputConfig = toml::from_str("hdt = true").unwrap();
        let mut sentences = HeadingSentences::new(&config);
        let said = sentences.due(&withheld, None, Instant::now());
        let said = String::from_utf8(said).unwrap();
        assert!(said.starts_with("$IIHDG,,,,4.0,E*"), "{said}");
        assert!(said.contains("$IITHS,,V*"), "{said}");
        assert!(!said.contains("HDT") && !said.contains("90"), "{said}");
    }

    #[test]
    fn each_sentence_has_its_talker_and_interval_and_a_withheld_heading_is_said_at_once() {
        let config = r#"
hdg = false
ths = { interval_s = 10 }
hdt = { talker = "HE", interval_s = 0.2 }
"#;
        let config: OutputConfig = toml::from_str(config).unwrap();
        let mut sentences = HeadingSentences::new(&config);
        assert_eq!(sentences.tick(), Duration::from_millis(200));
        let valid = corrected(90.0, 2.0, 4.0);
        let start = Instant::now();
        let mut count = |ms, heading: &CorrectedHeading| {
            let now = start + Duration::from_millis(ms);
            let said = String::from_utf8(sentences.due(heading, None, now)).unwrap();
            ["HDG", "THS", "HEHDT", "PBINQ"].map(|id| said.matches(id).count())
        };
        assert_eq!(count(0, &valid), [0, 1, 1, 1]);
        assert_eq!(count(205, &valid), [0, 0, 1, 0]);
        assert_eq!(count(395, &valid), [0, 0, 1, 0]);
        assert_eq!(count(1_000, &valid), [0, 0, 1, 1]);
        let withheld = CorrectedHeading::default();
        assert_eq!(count(1_200, &withheld), [0, 1, 0, 1]);
        assert_eq!(count(1_400, &withheld), [0, 0, 0, 0]);
    }

    #[test]
    fn what_is_written_reads_back() {
        let said = text(&corrected(359.96, 0.1, -20.0), None);
        let hdg = binnacle_nmea::parse(said.lines().next().unwrap().as_bytes()).unwrap();
        let Data::Hdg(hdg) = hdg.data else {
            panic!("{said}")
        };
        assert_eq!(hdg.reading_deg, Some(0.0));
        assert_eq!(hdg.variation_deg_east, Some(-20.0));
    }
}
