//! Diagnoses of samples as bytes, without the samples: those are in the log.
//!
//! Columns of whole numbers, each by its difference from the one before, as variable-length
//! integers. Angles are kept to a thousandth of a degree, fields to one nT, weights to a
//! thousandth: less than anyone reads.

use binnacle_compass::angle::wrap_180;
use binnacle_compass::result::{SampleDiagnostic, SampleReason};
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;

/// Reasons by their number, none apart.
const REASONS: [SampleReason; 13] = [
    SampleReason::NoReference,
    SampleReason::ReferenceFailed,
    SampleReason::CompassStuck,
    SampleReason::GnssInterference,
    SampleReason::OutsideFieldModel,
    SampleReason::FieldTooWeak,
    SampleReason::MagneticCargo,
    SampleReason::Berth,
    SampleReason::Disturbance,
    SampleReason::Outlier,
    SampleReason::NoModel,
    SampleReason::TooSlowForCourse,
    SampleReason::TurningCourse,
];
const PARTS: f64 = 1000.0;

/// Value of a column, and where it is in a diagnosis.
type Value = fn(&SampleDiagnostic) -> Option<i64>;

/// Columns behind that of the times.
const COLUMNS: [Value; 7] = [
    |d| d.variation_deg.map(|deg| (deg * PARTS).round() as i64),
    |d| d.h_nt.map(|nt| nt.round() as i64),
    |d| d.z_nt.map(|nt| nt.round() as i64),
    |d| d.deviation_deg.map(|deg| (deg * PARTS).round() as i64),
    |d| d.predicted_deg.map(|deg| (deg * PARTS).round() as i64),
    |d| Some((d.weight * PARTS).round() as i64),
    |d| Some(2 * reason_number(d.reason) + i64::from(d.used)),
];

/// Packs diagnoses in order of time.
pub(super) fn pack(diagnoses: &[SampleDiagnostic]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&mut bytes, diagnoses.len() as u64);
    let mut last = 0;
    for diagnosis in diagnoses {
        let time = diagnosis.sample.time.micros();
        write(&mut bytes, folded(time - last));
        last = time;
    }
    for column in COLUMNS {
        let mut last = 0;
        for diagnosis in diagnoses {
            // Zero stands for none.
            let code = column(diagnosis).map_or(0, |value| {
                let code = folded(value - last) + 1;
                last = value;
                code
            });
            write(&mut bytes, code);
        }
    }
    bytes
}

/// Unpacks diagnoses and joins them to their samples, which are among `samples`, in order of
/// time; none if bytes or samples are missing.
pub(super) fn unpack(bytes: &[u8], samples: &[Sample]) -> Option<Vec<SampleDiagnostic>> {
    let mut bytes = bytes;
    let count = usize::try_from(read(&mut bytes)?).ok()?;
    let mut times = Vec::new();
    let mut last = 0_i64;
    for _ in 0..count {
        last = last.checked_add(unfolded(read(&mut bytes)?))?;
        times.push(Timestamp::from_micros(last).ok()?);
    }
    let mut columns: [Vec<Option<i64>>; COLUMNS.len()] = Default::default();
    for column in &mut columns {
        let mut last = 0_i64;
        for _ in 0..count {
            let code = read(&mut bytes)?;
            column.push(match code.checked_sub(1) {
                None => None,
                Some(code) => {
                    last = last.checked_add(unfolded(code))?;
                    Some(last)
                }
            });
        }
    }
    let mut next = 0;
    let mut diagnoses = Vec::with_capacity(count);
    for (row, time) in times.into_iter().enumerate() {
        // A sample that no analysis has seen yet has no diagnosis.
        next += samples[next..].partition_point(|sample| sample.time < time);
        let sample = *samples.get(next).filter(|sample| sample.time == time)?;
        next += 1;
        diagnoses.push(diagnosis(
            sample,
            columns.each_ref().map(|column| column[row]),
        )?);
    }
    Some(diagnoses)
}

fn diagnosis(sample: Sample, values: [Option<i64>; COLUMNS.len()]) -> Option<SampleDiagnostic> {
    let [variation, h_nt, z_nt, deviation, predicted, weight, outcome] = values;
    let degrees = |thousandths: Option<i64>| thousandths.map(|value| value as f64 / PARTS);
    let (deviation_deg, predicted_deg) = (degrees(deviation), degrees(predicted));
    let residual = deviation_deg.zip(predicted_deg);
    let residual = residual.map(|(measured, predicted)| wrap_180(measured - predicted));
    let outcome = outcome?;
    Some(SampleDiagnostic {
        sample,
        variation_deg: degrees(variation),
        h_nt: h_nt.map(|nt| nt as f64),
        z_nt: z_nt.map(|nt| nt as f64),
        deviation_deg,
        predicted_deg,
        residual_deg: residual.map(|deg| (deg * PARTS).round() / PARTS),
        weight: weight? as f64 / PARTS,
        used: outcome % 2 == 1,
        reason: match usize::try_from(outcome / 2).ok()? {
            0 => None,
            number => Some(*REASONS.get(number - 1)?),
        },
    })
}

fn reason_number(reason: Option<SampleReason>) -> i64 {
    let place = reason.and_then(|reason| REASONS.iter().position(|known| *known == reason));
    place.map_or(0, |place| place as i64 + 1)
}

/// Returns a number without a sign: small where the number is, on either side of zero.
fn folded(number: i64) -> u64 {
    ((number << 1) ^ (number >> 63)) as u64
}

fn unfolded(code: u64) -> i64 {
    (code >> 1) as i64 ^ -((code & 1) as i64)
}

fn write(bytes: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

fn read(bytes: &mut &[u8]) -> Option<u64> {
    let mut number = 0;
    for shift in (0..64).step_by(7) {
        let (byte, rest) = bytes.split_first()?;
        *bytes = rest;
        number |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return Some(number);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn diagnosis(minute: i64, reason: Option<SampleReason>) -> SampleDiagnostic {
        let begin = Timestamp::parse("2026-10-12T00:00:00Z").unwrap();
        let has_field = reason != Some(SampleReason::OutsideFieldModel);
        let value = |value: f64| has_field.then_some(value);
        let diagnostic = json!({
            "time": begin.plus_seconds(60.0 * minute as f64), "lat": 43.126, "lon": -8.449,
            "compass_deg": 90.04, "gyro_deg": 90.0, "satellite_deg": null, "sog_kn": 12.0,
            "rate_of_turn_deg_min": 0.0, "spread_deg": 0.1, "windows": 60,
            "variation_deg": value(-1.25), "h_nt": value(24_000.0 + minute as f64),
            "z_nt": value(-38_000.0), "deviation_deg": value(-179.5),
            "predicted_deg": value(179.0), "residual_deg": value(1.5), "weight": 0.25,
            "used": reason.is_none(), "reason": reason,
        });
        serde_json::from_value(diagnostic).unwrap()
    }

    fn all() -> Vec<SampleDiagnostic> {
        let reasons = REASONS.into_iter().map(Some).chain([None]);
        let mut all: Vec<SampleDiagnostic> = reasons
            .enumerate()
            .map(|(minute, reason)| diagnosis(10 * minute as i64, reason))
            .collect();
        // Two installations sampled at the same instant.
        all.push(all.last().unwrap().clone());
        all
    }

    #[test]
    fn diagnoses_survive_and_find_their_samples() {
        let all = all();
        let bytes = pack(&all);
        let mut samples: Vec<Sample> = all.iter().map(|found| found.sample).collect();
        assert_eq!(unpack(&bytes, &samples), Some(all.clone()));
        // A batch that no analysis has seen yet brought another sample.
        samples.insert(3, diagnosis(25, None).sample);
        assert_eq!(unpack(&bytes, &samples), Some(all));
        samples.pop();
        assert_eq!(unpack(&bytes, &samples), None);
        assert_eq!(unpack(&pack(&[]), &[]), Some(Vec::new()));
    }

    #[test]
    fn no_bytes_but_whole_ones_are_read() {
        let all = all();
        let samples: Vec<Sample> = all.iter().map(|found| found.sample).collect();
        let bytes = pack(&all);
        for length in 0..bytes.len() {
            assert_eq!(unpack(&bytes[..length], &samples), None, "{length}");
        }
    }

    #[test]
    fn numbers_of_any_size_survive() {
        for number in [0, 1, -1, 63, -64, 1 << 40, i64::MAX, i64::MIN] {
            let mut bytes = Vec::new();
            write(&mut bytes, folded(number));
            assert_eq!(read(&mut &bytes[..]).map(unfolded), Some(number));
        }
    }
}
