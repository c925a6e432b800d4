//! The corrected heading as sentences for autopilots and repeaters.
//!
//! `HDG` carries the raw reading with deviation and variation filled in, `THS` the true heading in
//! mode E, and `$PBINQ` their quality: `$PBINQ,status,model version,age in days,standard error in
//! degrees*hh`.
//!
//! The talker is `II`, not `HC`: an agent that receives its own output must not take it for the
//! compass. An unknown value is an empty field, and THS then has mode V.

use super::framing::frame_sentence;
use crate::corrected_heading::CorrectedHeading;
use crate::instruments::AGENT_TALKER;
use binnacle_compass::angle::{CompassHeading, Deviation, TrueHeading, Variation};
use binnacle_nmea::sentence::{Hdg, Ths, ThsMode};
use binnacle_nmea::{Data, Sentence, write};

/// Quality of the model behind a heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quality {
    /// Version of the model.
    pub(crate) version: u32,
    /// Days since its last sample.
    pub(crate) age_days: f64,
}

/// Returns HDG, THS and PBINQ, each with its line end.
pub(crate) fn heading_sentences(corrected: &CorrectedHeading, quality: Option<Quality>) -> Vec<u8> {
    let mut out = Vec::with_capacity(128);
    let hdg = Hdg {
        reading_deg: corrected
            .compass_deg
            .map(CompassHeading::degrees)
            .map(tenth),
        deviation_deg_east: corrected
            .deviation_deg
            // A receiver would add it.
            .filter(|_| corrected.magnetic_deg.is_some())
            .map(Deviation::degrees_east)
            .map(tenth),
        variation_deg_east: corrected
            .variation_deg
            .map(Variation::degrees_east)
            .map(tenth),
    };
    let ths = Ths {
        heading_deg_true: corrected.true_deg.map(TrueHeading::degrees).map(tenth),
        mode: if corrected.true_deg.is_some() {
            ThsMode::Estimated
        } else {
            ThsMode::NotValid
        },
    };
    for data in [Data::Hdg(hdg), Data::Ths(ths)] {
        write(
            &Sentence {
                talker: AGENT_TALKER,
                data,
            },
            &mut out,
        );
    }
    write_quality(corrected, quality, &mut out);
    out
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
        String::from_utf8(heading_sentences(corrected, quality)).unwrap()
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
