//! Interference with the receivers of satellites: samples whose place is by dead reckoning.

use super::reading::Reading;
use binnacle_compass::result::{Cause, CauseProbability, Change, SampleReason};

/// Time without such a sample after which the next is another interference, seconds.
const APART_S: f64 = 6.0 * 3600.0;

/// Returns a change for each interference. The compass is sound meanwhile.
pub fn interference(readings: &[Reading]) -> Vec<Change> {
    let mut changes: Vec<Change> = Vec::new();
    let mut last: Option<usize> = None;
    let disturbed =
        |reading: &Reading| reading.diagnostic.reason == Some(SampleReason::GnssInterference);
    for (k, reading) in readings.iter().enumerate() {
        if !disturbed(reading) {
            continue;
        }
        let time = reading.sample().time;
        let ended = readings[k + 1..].iter().find(|next| !disturbed(next));
        let ended = ended.map(|next| next.sample().time);
        let goes_on = last
            .replace(k)
            .is_some_and(|last| time.seconds_since(readings[last].sample().time) <= APART_S);
        match changes.last_mut().filter(|_| goes_on) {
            Some(change) => change.ended = ended,
            None => changes.push(Change {
                from: time,
                from_earliest: time,
                from_latest: time,
                detected_at: time,
                confirmed: true,
                position: None,
                disturbed_deg: None,
                withdrawn: false,
                cause: Cause::GnssInterference,
                causes: vec![CauseProbability {
                    cause: Cause::GnssInterference,
                    probability: 1.0,
                }],
                evidence: vec![
                    "The receiver's position was not where the ship could be by her heading and \
                     speed."
                        .to_owned(),
                ],
                deviation_change_deg: None,
                step: None,
                ended,
            }),
        }
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::super::reading::readings;
    use super::*;
    use binnacle_compass::angle::{CompassHeading, TrueHeading};
    use binnacle_compass::model::ReferenceGrade;
    use binnacle_compass::position::Position;
    use binnacle_compass::sample::Sample;
    use binnacle_compass::settings::AnalysisSettings;
    use binnacle_compass::time::Timestamp;

    fn found(hours: &[(f64, bool)]) -> Vec<Change> {
        let start = Timestamp::parse("2026-11-21T00:00:00Z").unwrap();
        let samples: Vec<Sample> = hours
            .iter()
            .map(|(hour, reckoned)| Sample {
                gyro: TrueHeading::new(90.0),
                position_reckoned: *reckoned,
                ..Sample::new(
                    start.plus_seconds(hour * 3600.0),
                    Position::new(43.0, -3.0).unwrap(),
                    CompassHeading::new(91.0).unwrap(),
                )
            })
            .collect();
        let settings = AnalysisSettings::default();
        interference(&readings(&samples, &[], &settings, ReferenceGrade::Heading))
    }

    #[test]
    fn hours_near_each_other_are_one_interference_until_it_passes() {
        let changes = found(&[
            (0.0, false),
            (1.0, true),
            (2.0, true),
            (3.0, false),
            (4.0, true),
            (5.0, false),
            (20.0, true),
        ]);
        let hour = |time: Timestamp| {
            time.seconds_since(Timestamp::parse("2026-11-21T00:00:00Z").unwrap()) / 3600.0
        };
        let spans: Vec<_> = changes
            .iter()
            .map(|change| (hour(change.from), change.ended.map(hour)))
            .collect();
        assert_eq!(spans, [(1.0, Some(5.0)), (20.0, None)]);
        assert!(found(&[(0.0, false)]).is_empty());
    }
}
