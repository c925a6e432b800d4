//! Recordings in the formats that loggers write.

use super::*;
use crate::{Reading, is_recorded_time};
use binnacle_compass::time::Timestamp;
use binnacle_nmea::recording::DateOrder;
use proptest::prelude::*;
use std::io::Write;
use std::path::PathBuf;
use tempfile::TempDir;

const HEADING: &str = "$GPHDT,274.07,T*03";

/// A sentence with its checksum.
fn sentence(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}")
}

fn at(text: &str) -> Timestamp {
    Timestamp::parse(text).unwrap()
}

fn file(folder: &TempDir, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join("a.log");
    std::fs::write(&path, bytes).unwrap();
    path
}

fn read_with(bytes: &[u8], plan: Plan) -> (Vec<Recorded>, decoder::Decoder) {
    let mut decoder = decoder::Decoder::new("log".into(), plan);
    decoder.chunk(bytes);
    decoder.finish();
    (decoder.take_recorded(), decoder)
}

fn read(text: &str) -> (Vec<Recorded>, decoder::Decoder) {
    read_with(text.as_bytes(), Plan::default())
}

/// Times and headings in the order of the lines.
fn headings(recorded: &[Recorded]) -> Vec<(Option<Timestamp>, f64)> {
    let headings = recorded.iter().filter_map(|recorded| {
        let degrees = match recorded.seen.reading {
            Reading::True(heading) => heading.degrees(),
            Reading::Magnetic { heading, .. } => heading.degrees(),
            Reading::Compass { raw, .. } => raw.degrees(),
            _ => return None,
        };
        Some((recorded.at, (degrees * 100.0).round() / 100.0))
    });
    headings.collect()
}

/// A heading as an Actisense gateway sends it.
fn actisense_heading() -> Vec<u8> {
    let mut frame = vec![0x93, 19, 2, 0x12, 0xf1, 1, 255, 204, 0, 0, 0, 0, 8];
    frame.extend([0xff, 0x2b, 0x46, 0xff, 0x7f, 0xff, 0x7f, 0xfd]);
    let sum = frame.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    frame.push(sum.wrapping_neg());
    assert!(!frame.contains(&0x10));
    [&[0x10, 0x02], &frame[..], &[0x10, 0x03]].concat()
}

#[test]
fn the_kind_of_a_recording_does_not_depend_on_its_chunks() {
    // The gateway's own text comes first.
    let bytes = [b"gateway starts\n".to_vec(), actisense_heading()].concat();
    let (whole, _) = read_with(&bytes, Plan::default());
    assert_eq!(headings(&whole).len(), 1);
    for length in [1, 7, 16] {
        let mut decoder = decoder::Decoder::new("log".into(), Plan::default());
        bytes.chunks(length).for_each(|chunk| decoder.chunk(chunk));
        decoder.finish();
        assert_eq!(decoder.take_recorded(), whole, "{length}");
    }
}

#[test]
fn lines_carry_the_time_that_stands_before_them() {
    let text = format!(
        "2026-01-02T12:00:00Z {HEADING}\ngyro\t2026-01-02 12:00:01.5\t{HEADING}\r\n\
         01/02/2026,12:00:02.000,{HEADING}\n\"1767355203\",\"{HEADING}\"\n1767355204000;N;{HEADING}"
    );
    let (recorded, mut decoder) = read(&text);
    let times: Vec<_> = headings(&recorded)
        .into_iter()
        .map(|(at, _)| at.unwrap())
        .collect();
    let expected = ["00Z", "01.500Z", "02Z", "03Z", "04Z"];
    assert_eq!(
        times,
        expected.map(|end| at(&format!("2026-01-02T12:00:{end}")))
    );
    assert_eq!(decoder.take_tally().total_rejected(), 0);
    assert!(
        recorded
            .iter()
            .step_by(2)
            .all(|recorded| is_recorded_time(&recorded.seen))
    );
}

#[test]
fn the_clock_of_a_tag_block_is_a_time_of_the_logger() {
    let (recorded, _) = read(&format!("\\c:1767355200*5F\\{HEADING}\n"));
    assert_eq!(
        recorded[0].seen.reading,
        Reading::Time(at("2026-01-02T12:00:00Z"))
    );
    assert_eq!(recorded[1].seen.stated, None);
}

#[test]
fn without_a_logger_the_receivers_give_the_time() {
    let rmc = sentence("GPRMC,120000,A,4330.0,N,00515.0,W,5.0,90.0,020126,,");
    let (recorded, _) = read(&format!("{HEADING}\n{rmc}\n{HEADING}\n"));
    let noon = at("2026-01-02T12:00:00Z");
    assert_eq!(headings(&recorded), [(None, 274.07), (Some(noon), 274.07)]);
}

#[test]
fn a_time_of_day_belongs_to_the_day_of_the_receiver() {
    let zda = sentence("GPZDA,235958,02,01,2026,00,00");
    let text = format!("23:59:59 {zda}\n23:59:59.5 {HEADING}\n00:00:01 {HEADING}\n");
    let (recorded, _) = read(&text);
    let times: Vec<_> = headings(&recorded)
        .into_iter()
        .map(|(at, _)| at.unwrap())
        .collect();
    assert_eq!(
        times,
        [at("2026-01-02T23:59:59.5Z"), at("2026-01-03T00:00:01Z")]
    );
}

#[test]
fn deltas_give_their_own_times_and_readings() {
    let delta = |time: &str, value: f64| {
        format!(
            r#"{{"context":"vessels.urn:mrn:imo:mmsi:230099999","updates":[{{"$source":"can0.4","timestamp":"{time}","values":[{{"path":"navigation.headingCompass","value":{value}}}]}}]}}"#
        )
    };
    let first = delta("2026-01-02T12:00:00.000Z", 1.5);
    let second = delta("2026-01-02T12:00:01.000Z", 1.6);
    let (recorded, _) = read(&format!("{first}\n{second}\n"));
    let noon = at("2026-01-02T12:00:00Z");
    let later = at("2026-01-02T12:00:01Z");
    assert_eq!(
        headings(&recorded),
        [(Some(noon), 85.94), (Some(later), 91.67)]
    );
    assert!(
        recorded
            .iter()
            .all(|recorded| recorded.seen.stated.is_none())
    );

    // The logger's own times count before those of the deltas.
    let (recorded, _) = read(&format!("1767355260000;I;{first}\n"));
    assert_eq!(
        headings(&recorded),
        [(Some(at("2026-01-02T12:01:00Z")), 85.94)]
    );
    let quoted = first.replace('"', "\"\"");
    let (recorded, _) = read(&format!("1767355260000,\"{quoted}\"\n"));
    assert_eq!(headings(&recorded).len(), 1);
}

#[test]
fn what_was_not_understood_is_counted_with_its_first_line() {
    let beyond = sentence("GPHDT,999,T");
    let text = format!(
        "# a remark\nDear diary,\n\n{HEADING}\n$GPHDT,274.08,T*03\n$GPHDT,274.07,T\n\
         $GPHDT,274.06,T\n{{\"updates\": 5}}\n{beyond}\n"
    );
    let (_, mut decoder) = read(&text);
    let lines = decoder.take_not_understood();
    let lines: Vec<_> = lines
        .iter()
        .map(|(reason, lines)| (reason, lines.count, lines.line, lines.example.as_str()))
        .collect();
    assert_eq!(
        lines,
        [
            ("bad delta", 1, 8, "{\"updates\": 5}"),
            ("bad field", 1, 9, beyond.as_str()),
            ("no checksum", 2, 6, "$GPHDT,274.07,T"),
            ("not a sentence", 1, 2, "Dear diary,"),
            ("wrong checksum", 1, 5, "$GPHDT,274.08,T*03"),
        ]
    );
}

#[test]
fn a_date_1024_weeks_behind_the_logger_is_corrected_and_reported() {
    // 2026-01-02 less 7,168 days is 2006-05-19.
    let rmc = sentence("GPRMC,120000,A,4330.0,N,00515.0,W,5.0,90.0,190506,,");
    let (recorded, decoder) = read(&format!("2026-01-02T12:00:00Z {rmc}\n"));
    let noon = at("2026-01-02T12:00:00Z");
    let Reading::Fix { time, .. } = recorded[1].seen.reading else {
        panic!("{recorded:?}");
    };
    assert_eq!(time, Some(noon));
    let stated = at("2006-05-19T12:00:00Z");
    let corrected = noon;
    assert_eq!(decoder.roll_over(), Some(RollOver { stated, corrected }));

    let plan = Plan {
        roll_overs: 1,
        ..Plan::default()
    };
    let (recorded, _) = read_with(rmc.as_bytes(), plan);
    assert_eq!(recorded[0].at, Some(noon));
    // What the logger has corrected already is not corrected again.
    let (_, decoder) = read_with(format!("2026-01-02T12:00:00Z {rmc}\n").as_bytes(), plan);
    assert_eq!(decoder.roll_over(), Some(RollOver { stated, corrected }));
}

#[test]
fn a_receiver_that_rolls_over_within_a_recording_goes_on_with_its_date() {
    let rmc = |time: &str, date: &str| {
        sentence(&format!(
            "GPRMC,{time},A,4330.0,N,00515.0,W,5.0,90.0,{date},,"
        )) + "\n"
    };
    let text = rmc("115959", "020126") + &rmc("120000", "190506") + &rmc("120001", "190506");
    let (recorded, decoder) = read(&text);
    let last = recorded.last().unwrap();
    assert_eq!(last.at, Some(at("2026-01-02T12:00:01Z")));
    let corrected = at("2026-01-02T12:00:00Z");
    assert_eq!(decoder.roll_over().unwrap().corrected, corrected);
    // Another date is another fault.
    let text = rmc("115959", "020126") + &rmc("120000", "190106");
    assert_eq!(read(&text).1.roll_over(), None);
}

#[test]
fn sentences_of_a_recording_without_any_checksum_are_read() {
    let folder = TempDir::new().unwrap();
    let text = "2014-08-01T00:00:00.3Z $GPGLL,2200.097,S,01756.346,W,000000,A\n\
                2014-08-01T00:00:01.3Z \"$GPVTG,220.6,T,,M,009.7,N,018.0,K\"\n";
    let survey = |text: &str| Survey::of(&file(&folder, text.as_bytes()), None).unwrap();
    let plan = survey(text).plan();
    assert!(plan.without_checksums);
    let (recorded, mut decoder) = read_with(text.as_bytes(), plan);
    assert_eq!(decoder.take_tally().total_read(), 2);
    let fixes = recorded
        .iter()
        .filter(|recorded| matches!(recorded.seen.reading, Reading::Fix { .. }));
    assert_eq!(fixes.count(), 1);
    // Where others have one, its lack is damage.
    let hdt = sentence("HEHDT,218.3,T");
    let mixed = format!("{text}{hdt}\n");
    assert!(!survey(&mixed).plan().without_checksums);
    assert!(!survey("no sentence at all\n").plan().without_checksums);
}

#[test]
fn a_survey_finds_the_zone_of_the_logger_and_the_order_of_its_dates() {
    let folder = TempDir::new().unwrap();
    let zda = sentence("GPZDA,120000,03,02,2026,00,00");
    let text = format!("03/02/2026,14:00:00.3,{zda}\n").repeat(3);
    let survey = Survey::of(&file(&folder, text.as_bytes()), None).unwrap();
    assert_eq!(survey.order, Some(DateOrder::DayFirst));
    assert_eq!(survey.clock, LoggerClock::Ahead(7_200_300_000));
    let plan = survey.plan();
    let (recorded, _) = read_with(text.as_bytes(), plan);
    assert_eq!(
        recorded[0].seen.reading,
        Reading::Time(at("2026-02-03T12:00:00Z"))
    );

    let text = format!("02/03/2026,12:00:00.3,{zda}\n");
    let survey = Survey::of(&file(&folder, text.as_bytes()), None).unwrap();
    assert_eq!(survey.order, Some(DateOrder::MonthFirst));
    assert_eq!(survey.clock, LoggerClock::Agrees);

    // Only one order has such a day.
    let text = format!("31/03/2026,12:00:00,{HEADING}\n");
    let survey = Survey::of(&file(&folder, text.as_bytes()), None).unwrap();
    assert_eq!(survey.order, Some(DateOrder::DayFirst));
    let text = format!("02/03/2026,12:00:00,{HEADING}\n");
    let survey = Survey::of(&file(&folder, text.as_bytes()), None).unwrap();
    assert_eq!((survey.order, survey.clock), (None, LoggerClock::Unknown));
}

#[test]
fn gzip_is_read_as_its_content_even_if_it_was_cut_short() {
    let folder = TempDir::new().unwrap();
    let text = format!("{HEADING}\n").repeat(20_000);
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gzip.write_all(text.as_bytes()).unwrap();
    let gzip = gzip.finish().unwrap();
    let whole = |bytes: &[u8]| {
        let path = file(&folder, bytes);
        let mut reader = RecordingReader::open(&path, "log".into(), Plan::default()).unwrap();
        let mut count = 0;
        while let Some(chunk) = reader.next_chunk() {
            count += chunk.recorded.len();
        }
        (count, reader.problem().map(str::to_owned))
    };
    assert_eq!(whole(&gzip), (20_000, None));
    assert_eq!(whole(&[&gzip[..], &gzip[..]].concat()), (40_000, None));
    let (count, problem) = whole(&gzip[..gzip.len() / 2]);
    assert!(count > 100 && count < 20_000, "{count}");
    assert!(problem.is_some());
}

proptest! {
    #[test]
    fn no_bytes_cause_a_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..300),
        chunk in 1_usize..50,
    ) {
        let mut decoder = decoder::Decoder::new("log".into(), Plan::default());
        for chunk in bytes.chunks(chunk) {
            decoder.chunk(chunk);
        }
        decoder.finish();
    }

    #[test]
    fn no_delta_like_text_causes_a_panic(text in r#"[0-9:;,\-TZ]{0,20}\{"updates":[\{\}\[\]",:a-z0-9\.$]{0,60}"#) {
        read(&text);
    }
}
