//! Signal K deltas: values of each path in the agent's units and signs.
//!
//! Signal K 1.7, "Keys reference (vessel)": SI units, radians, east and starboard and bow-up
//! positive; `navigation.headingCompass` is the raw reading, `headingMagnetic` has deviation
//! applied. Readings get the talker `SK` and the sentence with the same meaning, and carry the
//! `$source` and `timestamp` of their update. A heading is combined with the deviation and
//! variation of its own source.
//!
//! Values that a server computes are ignored: a true heading made of a magnetic one is no reference
//! for the compass. Other vessels are ignored too.

use super::counts::DeltaCounts;
use super::value::{difference_deg, direction_deg, read_standalone};
use crate::{Observation, Reading, Source};
use binnacle_compass::angle::{CompassHeading, Deviation, MagneticHeading, Variation};
use binnacle_compass::time::Timestamp;
use binnacle_nmea::n2k::{Address, Name};
use serde::Deserialize;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// Paths to subscribe to.
pub const PATHS: [&str; 13] = [
    "navigation.headingCompass",
    "navigation.headingMagnetic",
    "navigation.headingTrue",
    "navigation.magneticDeviation",
    "navigation.magneticVariation",
    "navigation.rateOfTurn",
    "navigation.attitude",
    "navigation.position",
    "navigation.speedOverGround",
    "navigation.speedThroughWater",
    "navigation.courseOverGroundTrue",
    "environment.outside.temperature",
    "navigation.datetime",
];

const TALKER: [u8; 2] = *b"SK";
/// Limit on sources whose deviation is remembered.
const MAX_SOURCES: usize = 200;
/// Source of values that the server computes itself.
const DERIVED: &str = "derived-data";

/// Paths that no other vessel transmits.
const OWN_SHIP_PATHS: [&str; 3] = [
    "navigation.headingCompass",
    "navigation.headingMagnetic",
    "navigation.magneticDeviation",
];

/// Reader of one connection's messages.
#[derive(Debug)]
pub struct DeltaReader {
    input: Arc<str>,
    /// `vessels.urn:…`, once the server has identified itself.
    own_ship: Option<String>,
    /// Set for recordings, in which no server may have identified itself: the own ship is the one
    /// whose magnetic heading is known.
    infers_own_ship: bool,
    /// Last deviation and variation of each source; never applied.
    differences: HashMap<Option<Arc<str>>, Differences>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Differences {
    deviation: Option<Deviation>,
    variation: Option<Variation>,
}

/// A delta, or the server's greeting, reduced to the fields in use.
#[derive(Deserialize)]
struct Message<'a> {
    #[serde(borrow, rename = "self")]
    own_ship: Option<Cow<'a, str>>,
    /// Present time of the server, in its greeting.
    #[serde(borrow)]
    timestamp: Option<Cow<'a, str>>,
    #[serde(borrow)]
    context: Option<Cow<'a, str>>,
    #[serde(borrow, default)]
    updates: Vec<Update<'a>>,
}

#[derive(Deserialize)]
struct Update<'a> {
    #[serde(borrow, rename = "$source")]
    source_ref: Option<Cow<'a, str>>,
    /// Description of the device, in any form.
    source: Option<Value>,
    /// Time at which the values were measured.
    #[serde(borrow)]
    timestamp: Option<Cow<'a, str>>,
    /// Absent in updates of metadata.
    #[serde(borrow, default)]
    values: Vec<PathValue<'a>>,
}

#[derive(Deserialize)]
struct PathValue<'a> {
    #[serde(borrow)]
    path: Cow<'a, str>,
    value: Value,
}

impl DeltaReader {
    /// Creates a reader of a connection.
    pub fn new(input: Arc<str>) -> DeltaReader {
        DeltaReader {
            input,
            own_ship: None,
            infers_own_ship: false,
            differences: HashMap::new(),
        }
    }

    /// Creates a reader of a recording.
    pub fn of_recording(input: Arc<str>) -> DeltaReader {
        DeltaReader {
            infers_own_ship: true,
            ..DeltaReader::new(input)
        }
    }

    /// Returns the observations of one message; unused parts are counted.
    pub fn read(&mut self, text: &str, counts: &mut DeltaCounts) -> Vec<Observation> {
        let mut out = Vec::new();
        let Ok(message) = serde_json::from_str::<Message<'_>>(text) else {
            counts.reject("bad delta");
            return out;
        };
        if let Some(own_ship) = &message.own_ship {
            self.own_ship = Some(strip_vessel_prefix(own_ship).to_owned());
        }
        self.infer_own_ship(&message);
        if !self.is_own_ship(message.context.as_deref()) {
            counts.reject("another vessel");
            return out;
        }
        let greeting = message.timestamp.as_deref().map(Timestamp::parse);
        if let Some(Ok(at)) = greeting {
            let source = Source::of_sentence(Arc::clone(&self.input), TALKER, *b"SYS");
            out.push(Observation::now(source, Reading::Greeting(at)));
        }
        for update in &message.updates {
            if update.source_ref.as_deref().is_some_and(is_derived) {
                counts.reject("computed by the server");
                continue;
            }
            let device = self.device(update);
            let stated = update.timestamp.as_deref().map(Timestamp::parse);
            let Ok(stated) = stated.transpose() else {
                counts.reject("bad timestamp");
                continue;
            };
            // A compass reading is combined with the deviation beside it.
            let (differences, others): (Vec<_>, Vec<_>) = update
                .values
                .iter()
                .partition(|value| value.path.starts_with("navigation.magnetic"));
            for value in differences.into_iter().chain(others) {
                self.read_value(value, &device, stated, counts, &mut out);
            }
        }
        out
    }

    /// Returns the device of an update, with any sentence.
    fn device(&self, update: &Update<'_>) -> Source {
        let text = |key: &str| {
            let source = update.source.as_ref()?;
            source.get(key)?.as_str()
        };
        let signalk = match (&update.source_ref, text("label")) {
            (Some(source_ref), _) => Some(source_ref.to_string()),
            // Servers make `$source` of label and address, or label and talker.
            (None, Some(label)) => {
                let device = text("src").or_else(|| text("talker"));
                Some(device.map_or(label.to_owned(), |device| format!("{label}.{device}")))
            }
            (None, None) => None,
        };
        Source {
            signalk: signalk.map(Into::into),
            n2k_address: text("src").and_then(Address::parse),
            n2k_name: text("canName").and_then(Name::parse),
            ..Source::of_sentence(Arc::clone(&self.input), TALKER, *b"SYS")
        }
    }

    fn infer_own_ship(&mut self, message: &Message<'_>) {
        if !self.infers_own_ship || self.own_ship.is_some() {
            return;
        }
        let mut values = message.updates.iter().flat_map(|update| &update.values);
        if values.any(|value| OWN_SHIP_PATHS.contains(&value.path.as_ref())) {
            let context = message.context.as_deref().map(strip_vessel_prefix);
            self.own_ship = context.filter(|name| *name != "self").map(str::to_owned);
        }
    }

    fn is_own_ship(&self, context: Option<&str>) -> bool {
        match context.map(strip_vessel_prefix) {
            None | Some("self") => true,
            Some(context) => self.own_ship.as_deref() == Some(context),
        }
    }

    fn read_value(
        &mut self,
        value: &PathValue<'_>,
        device: &Source,
        stated: Option<Timestamp>,
        counts: &mut DeltaCounts,
        out: &mut Vec<Observation>,
    ) {
        let Some(path) = PATHS.into_iter().find(|path| *path == value.path) else {
            return counts.reject("unknown path");
        };
        let before = out.len();
        let mut push = |sentence: &[u8; 3], reading| {
            out.push(Observation {
                source: Source {
                    sentence: *sentence,
                    ..device.clone()
                },
                stated,
                reading,
            });
        };
        let known = self.differences.get(&device.signalk);
        let mut differences = known.copied().unwrap_or_default();
        let read = match path {
            "navigation.magneticDeviation" => difference_deg(&value.value).map(|deg| {
                differences.deviation = deg.and_then(Deviation::new);
            }),
            "navigation.magneticVariation" => difference_deg(&value.value).map(|deg| {
                differences.variation = deg.and_then(Variation::new);
            }),
            "navigation.headingCompass" => direction_deg(&value.value).map(|deg| {
                if let Some(raw) = deg.and_then(CompassHeading::new) {
                    let Differences {
                        deviation,
                        variation,
                    } = differences;
                    let reading = Reading::Compass {
                        raw,
                        deviation,
                        variation,
                    };
                    push(b"HDG", reading);
                }
            }),
            "navigation.headingMagnetic" => direction_deg(&value.value).map(|deg| {
                if let Some(heading) = deg.and_then(MagneticHeading::new) {
                    let Differences {
                        deviation,
                        variation,
                    } = differences;
                    let reading = Reading::Magnetic {
                        heading,
                        deviation,
                        variation,
                    };
                    push(b"HDM", reading);
                }
            }),
            _ => read_standalone(path, &value.value, &mut push),
        };
        if read.is_err() {
            out.truncate(before);
            return counts.reject("bad value");
        }
        if path.starts_with("navigation.magnetic") {
            self.remember(device, differences);
        }
        counts.count_value(path);
    }

    fn remember(&mut self, device: &Source, differences: Differences) {
        let is_known = self.differences.contains_key(&device.signalk);
        if is_known || self.differences.len() < MAX_SOURCES {
            self.differences.insert(device.signalk.clone(), differences);
        }
    }
}

fn strip_vessel_prefix(context: &str) -> &str {
    context.strip_prefix("vessels.").unwrap_or(context)
}

fn is_derived(source: &str) -> bool {
    source == DERIVED || source.starts_with("derived-data.")
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::position::Position;
    use binnacle_compass::time::Timestamp;
    use serde_json::json;
    use std::f64::consts::TAU;

    fn read_all(messages: &[Value]) -> (Vec<Observation>, DeltaCounts) {
        let mut counts = DeltaCounts::default();
        let mut reader = DeltaReader::new("sk".into());
        let mut out = Vec::new();
        for message in messages {
            out.extend(reader.read(&message.to_string(), &mut counts));
        }
        (out, counts)
    }

    fn delta(values: &Value) -> Value {
        json!({"context": "vessels.self", "updates": [{"$source": "n2k.1", "values": values}]})
    }

    fn one(path: &str, value: &Value) -> Vec<Reading> {
        let (seen, _) = read_all(&[delta(&json!([{"path": path, "value": value}]))]);
        seen.into_iter().map(|seen| seen.reading).collect()
    }

    #[test]
    fn a_compass_reading_goes_with_the_deviation_and_variation_of_either_sign() {
        for (deviation, variation) in [
            (0.05_f64, 0.3_f64),
            (0.05, -0.3),
            (-0.05, 0.3),
            (-0.05, -0.3),
        ] {
            let (seen, counts) = read_all(&[delta(&json!([
                {"path": "navigation.headingCompass", "value": 1.5},
                {"path": "navigation.magneticDeviation", "value": deviation},
                {"path": "navigation.magneticVariation", "value": variation},
            ]))]);
            let Reading::Compass {
                raw,
                deviation: found_deviation,
                variation: found_variation,
            } = seen[0].reading
            else {
                panic!("{seen:?}");
            };
            assert!((raw.radians() - 1.5).abs() < 1e-12);
            let degrees = found_deviation.unwrap().degrees_east();
            assert!((degrees.to_radians() - deviation).abs() < 1e-12);
            let degrees = found_variation.unwrap().degrees_east();
            assert!((degrees.to_radians() - variation).abs() < 1e-12);
            assert_eq!(
                (&seen[0].source.talker, &seen[0].source.sentence),
                (b"SK", b"HDG")
            );
            assert_eq!(counts.values["navigation.headingCompass"], 1);
        }
    }

    #[test]
    fn a_deviation_of_null_is_unknown_again() {
        let compass = json!({"path": "navigation.headingCompass", "value": 0.0});
        let deviation =
            |value: Value| json!({"path": "navigation.magneticDeviation", "value": value});
        let (seen, _) = read_all(&[
            delta(&json!([compass])),
            delta(&json!([deviation(json!(0.1)), compass])),
            delta(&json!([deviation(json!(null)), compass])),
        ]);
        let known: Vec<_> = seen
            .iter()
            .map(|seen| {
                matches!(
                    seen.reading,
                    Reading::Compass {
                        deviation: Some(_),
                        ..
                    }
                )
            })
            .collect();
        assert_eq!(known, [false, true, false]);
    }

    #[test]
    fn units_and_signs_are_the_agents_own() {
        let rate = one("navigation.rateOfTurn", &json!(-0.01));
        assert!(
            matches!(rate[..], [Reading::RateOfTurn { deg_min }] if (deg_min + 34.377).abs() < 1e-3)
        );
        let speed = one("navigation.speedOverGround", &json!(5.144_444_444));
        assert!(matches!(speed[..], [Reading::Speed { sog_kn }] if (sog_kn - 10.0).abs() < 1e-6));
        let course = one("navigation.courseOverGroundTrue", &json!(1.5));
        assert!(
            matches!(course[..], [Reading::Course(course)] if (course.radians() - 1.5).abs() < 1e-9)
        );
        let air = one("environment.outside.temperature", &json!(283.15));
        assert!(
            matches!(air[..], [Reading::Temperature { celsius }] if (celsius - 10.0).abs() < 1e-9)
        );
        let attitude = one(
            "navigation.attitude",
            &json!({"roll": -0.1, "pitch": 0.05, "yaw": 1}),
        );
        assert!(
            matches!(attitude[..], [Reading::Pitch { deg: pitch }, Reading::Roll { deg: roll }]
                if pitch > 2.8 && roll < -5.7)
        );
        let fix = one(
            "navigation.position",
            &json!({"latitude": -43.5, "longitude": -5.25}),
        );
        assert_eq!(
            fix,
            [Reading::Fix {
                position: Position::new(-43.5, -5.25).unwrap(),
                time: None,
                sog_kn: None
            }]
        );
        let time = one("navigation.datetime", &json!("2026-01-02T12:00:00.000Z"));
        assert_eq!(
            time,
            [Reading::Time(
                Timestamp::parse("2026-01-02T12:00:00Z").unwrap()
            )]
        );
    }

    #[test]
    fn null_is_unknown_and_what_is_out_of_range_is_counted() {
        for path in PATHS {
            assert_eq!(one(path, &json!(null)), [], "{path}");
            for wrong in [
                json!("x"),
                json!([1]),
                json!({"a": 1}),
                json!(true),
                json!(1e300),
            ] {
                let harmless = path == "navigation.attitude" && wrong.is_object();
                let (seen, counts) = read_all(&[delta(&json!([{"path": path, "value": wrong}]))]);
                assert_eq!(counts.rejected.contains_key("bad value"), !harmless);
                assert_eq!(seen, [], "{path} {wrong}");
            }
        }
        assert_eq!(one("navigation.headingTrue", &json!(TAU + 5e-5)).len(), 1);
        assert_eq!(one("navigation.headingTrue", &json!(6.3)), []);
        assert_eq!(one("navigation.headingTrue", &json!(-0.1)), []);
        assert_eq!(
            one(
                "navigation.position",
                &json!({"latitude": 95, "longitude": 0})
            ),
            []
        );
    }

    #[test]
    fn other_vessels_and_computed_values_are_left_out() {
        let heading = json!([{"path": "navigation.headingTrue", "value": 1.0}]);
        let of = |context: &str| json!({"context": context, "updates": [{"values": heading}]});
        let computed = json!({"updates": [{"$source": "derived-data", "values": heading}]});
        let (seen, counts) = read_all(&[
            of("vessels.urn:mrn:imo:mmsi:230099999"),
            json!({"name": "server", "version": "2", "self": "vessels.urn:mrn:imo:mmsi:230099999"}),
            of("vessels.urn:mrn:imo:mmsi:230099999"),
            of("vessels.urn:mrn:imo:mmsi:266000000"),
            computed,
        ]);
        assert_eq!(seen.len(), 1);
        let rejected = counts.rejected;
        assert_eq!(rejected["another vessel"], 2);
        assert_eq!(rejected["computed by the server"], 1);
    }

    #[test]
    fn what_is_no_delta_is_counted() {
        let mut counts = DeltaCounts::default();
        let mut reader = DeltaReader::new("sk".into());
        for text in [
            "",
            "{",
            "[]",
            "5",
            "{\"updates\": 5}",
            "{\"updates\":[{\"values\":[{}]}]}",
        ] {
            assert_eq!(reader.read(text, &mut counts), []);
        }
        assert_eq!(counts.rejected["bad delta"], 6);
    }
}
