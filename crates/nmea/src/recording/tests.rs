//! Lines as known loggers write them.

use super::*;
use crate::parse_tagged;
use proptest::prelude::*;

const HEADING: &str = "$GPHDT,274.07,T*03";
/// 2014-08-01T00:00:00Z.
const MIDNIGHT: i64 = 1_406_851_200_000_000;
const STAMPED: i64 = MIDNIGHT + 183_000;

fn stamp_of(before: &str) -> Option<Stamp> {
    let line = format!("{before}{HEADING}");
    let recorded = split(line.as_bytes(), DateOrder::MonthFirst).unwrap();
    assert_eq!(recorded.content, HEADING.as_bytes(), "{before}");
    recorded.stamp
}

#[test]
fn the_time_of_every_usual_prefix_is_read() {
    for before in [
        "2014-08-01T00:00:00.183000Z ",
        "gyr1 2014-08-01T00:00:00.183000Z ",
        "INNAV\t2014-08-01T00:00:00.183Z\tSEAPATH330\t",
        "2014-08-01T02:00:00.183+02:00\t",
        "2014-07-31T19:30:00.183-0430 ",
        "2014-08-01 00:00:00.183 ",
        "2014-08-01 00:00:00,183 - INFO - ",
        "2014-08-01 00:00:00.183 +0000 COM3: ",
        "[2014-08-01 00:00:00.183] [NMEA1] ",
        "2014/08/01 00:00:00.183,",
        "2014.08.01_00:00:00:183 ",
        "08/01/2014,00:00:00.183,",
        "8/1/2014,00:00:00.183,",
        "8/1/2014 12:00:00.183 AM ",
        "01.08.2014 00:00:00.183 ",
        "01-08-2014 00:00:00.183;",
        "01-Aug-2014 00:00:00.183 ",
        "Fri Aug  1 00:00:00.183 2014 ",
        "1 August 2014 00:00:00.183 ",
        "20140801T000000.183Z ",
        "20140801 000000.183 ",
        "20140801-00:00:00.183 ",
        "2014:213:00:00:00.183 ",
        "gyr1+2014:213:00:00:00.183+",
        "14+213:00:00:00.183 ",
        "2014-213T00:00:00.183Z ",
        "1406851200.183 ",
        "(1406851200.183000) ",
        "1406851200183,",
        "1406851200183;N;",
        "1406851200183000 ",
        "1406851200183000000\t",
        "\"2014-08-01T00:00:00.183Z\",\"gyro\",\"",
        "17,\"2014-08-01 00:00:00.183\",\"COM3\",\"",
        "{\"timestamp\":\"2014-08-01T00:00:00.183Z\",\"data\":\"",
        "time=1406851200.183 port=gyro ",
        "2014-08-01T00:00:00.183Z,NMEA0183,GPHDT,\"",
    ] {
        assert_eq!(stamp_of(before), Some(Stamp::Instant(STAMPED)), "{before}");
    }
}

#[test]
fn a_time_behind_the_sentence_is_read_too() {
    for behind in [
        ",1406851200.183",
        " 2014-08-01T00:00:00.183Z",
        "\",\"2014-08-01 00:00:00.183\"",
    ] {
        let line = format!("{HEADING}{behind}");
        let recorded = split(line.as_bytes(), DateOrder::MonthFirst).unwrap();
        assert_eq!(recorded.content, HEADING.as_bytes());
        assert_eq!(recorded.stamp, Some(Stamp::Instant(STAMPED)), "{behind}");
    }
}

#[test]
fn a_time_of_day_has_no_date() {
    for before in ["00:00:00.183 ", "[00:00:00.183] GYRO ", "00:00:00,183,"] {
        assert_eq!(
            stamp_of(before),
            Some(Stamp::TimeOfDay(183_000)),
            "{before}"
        );
    }
}

#[test]
fn a_name_or_a_number_is_no_time() {
    for before in [
        "",
        "gyro ",
        "12 ",
        "2014 ",
        "COM3,17,",
        "2014-13-01 ",
        "99:00:00 ",
        "000000 ",
    ] {
        assert_eq!(stamp_of(before), None, "{before}");
    }
}

#[test]
fn day_and_month_stand_in_the_order_asked_for() {
    let read = |prefix: &str, order| read_stamp(prefix.as_bytes(), order);
    let september = Stamp::Instant(MIDNIGHT + 38 * moment::MICROS_A_DAY);
    assert_eq!(
        read("08/09/2014,00:00:00,", DateOrder::DayFirst),
        Some(september)
    );
    let instant = |order| match read("15/08/2014 00:00:00 ", order) {
        Some(Stamp::Instant(at)) => Some(at),
        _ => None,
    };
    assert_eq!(instant(DateOrder::MonthFirst), None);
    assert_eq!(
        instant(DateOrder::DayFirst),
        Some(MIDNIGHT + 14 * moment::MICROS_A_DAY)
    );
}

#[test]
fn tag_blocks_and_quotes_stay_out_of_the_sentence() {
    let tagged = format!("17;\\c:1767355200*5F\\{HEADING}");
    let recorded = split(tagged.as_bytes(), DateOrder::MonthFirst).unwrap();
    assert_eq!(recorded.content, &tagged.as_bytes()[3..]);
    assert!(parse_tagged(recorded.content).is_ok());
    let spoilt = split(
        b"\"12:00:00\",\"$GPHDT,274.07,T\",\"COM3\"",
        DateOrder::MonthFirst,
    );
    assert_eq!(spoilt.unwrap().content, b"$GPHDT,274.07,T");
}

#[test]
fn a_second_sentence_of_a_line_is_in_the_rest() {
    let line = format!("{HEADING} 2014-08-01 00:00:00.183 {HEADING}");
    let first = split(line.as_bytes(), DateOrder::MonthFirst).unwrap();
    let second = split(first.rest, DateOrder::MonthFirst).unwrap();
    assert_eq!(
        (second.content, second.rest),
        (HEADING.as_bytes(), &b""[..])
    );
    assert_eq!(second.stamp, Some(Stamp::Instant(STAMPED)));
}

#[test]
fn deltas_are_distinguished_from_sentences_in_json() {
    let delta = r#"{"updates":[{"$source":"n2k.1","values":[]}]}"#;
    let line = format!("1406851200183;I;{delta}");
    let recorded = split(line.as_bytes(), DateOrder::MonthFirst).unwrap();
    assert_eq!(recorded.format, LineFormat::Delta);
    assert_eq!(recorded.content, delta.as_bytes());
    assert_eq!(recorded.stamp, Some(Stamp::Instant(STAMPED)));
    let sentence = split(br#"{"data":"$GPHDT,274.07,T*03"}"#, DateOrder::MonthFirst).unwrap();
    assert_eq!(sentence.format, LineFormat::Sentence);
    assert_eq!(split(br#"{"temperature": 3}"#, DateOrder::MonthFirst), None);
}

#[test]
fn text_has_no_content() {
    for line in [
        "",
        "# Name: Saab",
        "time,type,message",
        "Dear diary,",
        "C:\\logs\\x",
    ] {
        assert_eq!(
            split(line.as_bytes(), DateOrder::MonthFirst),
            None,
            "{line}"
        );
    }
}

proptest! {
    #[test]
    fn no_bytes_cause_a_panic(line in prop::collection::vec(any::<u8>(), 0..200)) {
        for order in [DateOrder::MonthFirst, DateOrder::DayFirst] {
            if let Some(recorded) = split(&line, order) {
                prop_assert!(recorded.content.len() + recorded.rest.len() <= line.len());
                prop_assert!(!recorded.content.is_empty());
            }
            read_stamp(&line, order);
        }
    }

    #[test]
    fn no_prefix_of_time_like_text_causes_a_panic(line in r"[0-9TZ:/,.+\- a-zA-Z\$\\\*]{0,60}") {
        split(line.as_bytes(), DateOrder::MonthFirst);
        split(line.as_bytes(), DateOrder::DayFirst);
    }
}
