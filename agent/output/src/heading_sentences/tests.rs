//! Sentences of valid and of withheld headings, their rate, and the age of their readings.

use super::*;

const NO_INTERVAL: Duration = Duration::ZERO;

fn sentences(config: &str) -> HeadingSentences {
    let config: OutputConfig = toml::from_str(config).unwrap();
    HeadingSentences::new(&config)
}

fn text_of(lines: &[Line]) -> String {
    let text = lines.iter().flat_map(|line| line.text.clone()).collect();
    String::from_utf8(text).unwrap()
}

fn text(corrected: &Heading, quality: Option<Quality>) -> String {
    let now = Instant::now();
    let mut sentences = sentences("");
    text_of(&sentences.due(corrected, quality, Trigger::Timer, NO_INTERVAL, now))
}

#[test]
fn east_and_west_stand_in_their_places() {
    let quality = Some(Quality {
        version: 3,
        age_days: 1.04,
    });
    let said = text(&Heading::from_degrees(1.0, -2.5, 4.0), quality);
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
    let said = text(&Heading::default(), None);
    assert!(said.starts_with("$IIHDG,,,,,*"), "{said}");
    assert!(said.contains("$IITHS,,V*"), "{said}");
    assert!(said.contains("$PBINQ,V,,,*"), "{said}");
}

#[test]
fn what_is_written_reads_back() {
    let said = text(&Heading::from_degrees(359.96, 0.1, -20.0), None);
    let hdg = binnacle_nmea::parse(said.lines().next().unwrap().as_bytes()).unwrap();
    let Data::Hdg(hdg) = hdg.data else {
        panic!("{said}")
    };
    assert_eq!(hdg.reading_deg, Some(0.0));
    assert_eq!(hdg.variation_deg_east, Some(-20.0));
}

#[test]
fn no_sentence_is_longer_than_its_line_is_reckoned_with() {
    let longest = Heading {
        standard_error_deg: Some(179.99),
        true_heading: TrueHeading::new(359.9),
        ..Heading::from_degrees(359.9, -179.9, -179.9)
    };
    let quality = Some(Quality {
        version: 9_999_999,
        age_days: 99_999.9,
    });
    let mut sentences = sentences("hdt = true");
    let now = Instant::now();
    let lines = sentences.due(&longest, quality, Trigger::Timer, NO_INTERVAL, now);
    assert_eq!(lines.len(), 4);
    for line in lines {
        let length = line.text.len();
        assert!(
            length <= line.kind.max_bytes() as usize,
            "{length} {line:?}"
        );
    }
}

#[test]
fn while_a_heading_is_withheld_nothing_can_be_read_as_one() {
    let withheld = Heading {
        true_heading: None,
        ..Heading::from_degrees(90.0, 2.0, 4.0)
    };
    let mut sentences = sentences("hdt = true");
    let now = Instant::now();
    let lines = sentences.due(&withheld, None, Trigger::Timer, NO_INTERVAL, now);
    let said = text_of(&lines);
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
    let mut sentences = sentences(config);
    let valid = Heading::from_degrees(90.0, 2.0, 4.0);
    let start = Instant::now();
    let mut count = |ms, heading: &Heading| {
        let now = start + Duration::from_millis(ms);
        let lines = sentences.due(heading, None, Trigger::Timer, NO_INTERVAL, now);
        let said = text_of(&lines);
        ["HDG", "THS", "HEHDT", "PBINQ"].map(|id| said.matches(id).count())
    };
    assert_eq!(count(0, &valid), [0, 1, 1, 1]);
    assert_eq!(count(190, &valid), [0, 0, 0, 0]);
    assert_eq!(count(205, &valid), [0, 0, 1, 0]);
    assert_eq!(count(405, &valid), [0, 0, 1, 0]);
    assert_eq!(count(1_000, &valid), [0, 0, 1, 1]);
    let withheld = Heading::default();
    assert_eq!(count(1_100, &withheld), [0, 1, 0, 1]);
    assert_eq!(count(1_300, &withheld), [0, 0, 0, 0]);
    // Given again, it takes no longer than its interval.
    assert_eq!(count(1_500, &valid), [0, 0, 1, 0]);
}

/// HDT sentences of half a minute, each with its time and the age of its reading.
fn simulate(interval_s: f64, readings_ms: &[u64], compass_interval_ms: u64) -> Vec<(u64, u64)> {
    let mut sentences = sentences(&format!(
        "hdg = false\nths = false\nhdt = {{ interval_s = {interval_s} }}"
    ));
    let compass_interval = Duration::from_millis(compass_interval_ms);
    let start = Instant::now();
    let valid = Heading::from_degrees(90.0, 2.0, 4.0);
    let ms = |now: Instant| now.saturating_duration_since(start).as_millis() as u64;
    let (mut sent, mut newest, mut now) = (Vec::new(), 0, start);
    let mut readings = readings_ms.iter().copied().peekable();
    while ms(now) < 30_000 {
        let timer = sentences.next_timer(compass_interval, now);
        // The clock goes on between two events.
        let timer = timer.max(now + Duration::from_millis(1));
        let reading = readings.peek().map(|at| start + Duration::from_millis(*at));
        let trigger = if reading.is_some_and(|reading| reading <= timer) {
            newest = readings.next().unwrap();
            now = start + Duration::from_millis(newest);
            Trigger::Reading
        } else {
            now = timer;
            Trigger::Timer
        };
        let lines = sentences.due(&valid, None, trigger, compass_interval, now);
        if lines.iter().any(|line| line.kind == SentenceKind::Hdt) {
            sent.push((ms(now), ms(now) - newest));
        }
    }
    sent
}

fn readings(first_ms: u64, period_ms: u64, jitter_ms: u64) -> Vec<u64> {
    let reading = |count: u64| {
        // A jitter that repeats after seven readings.
        let jitter = count * 3 % 7 * jitter_ms / 6;
        first_ms + count * period_ms + jitter
    };
    (0..31_000 / period_ms).map(reading).collect()
}

#[test]
fn at_ten_hertz_each_sentence_is_made_when_its_reading_arrives() {
    for first_ms in [0, 13, 37, 50, 71, 99] {
        for jitter_ms in [0, 10, 40] {
            let sent = simulate(0.1, &readings(first_ms, 100, jitter_ms), 100);
            assert!((290..=305).contains(&sent.len()), "{}", sent.len());
            // After a second the sentences follow the compass, whatever the phase.
            let late = sent.iter().filter(|(at, age)| *at > 1_000 && *age > 0);
            assert_eq!(late.count(), 0, "{first_ms} {jitter_ms}");
        }
    }
}

#[test]
fn a_compass_faster_than_the_output_does_not_raise_its_rate() {
    for period_ms in [20, 50, 70, 80, 95] {
        let sent = simulate(0.1, &readings(3, period_ms, 0), period_ms);
        assert!(
            (240..=309).contains(&sent.len()),
            "{period_ms}: {}",
            sent.len()
        );
        let oldest = sent.iter().skip(10).map(|(_, age)| *age).max();
        assert!(oldest < Some(period_ms), "{period_ms}: {oldest:?}");
    }
}

#[test]
fn a_compass_slower_than_the_output_is_repeated_at_the_outputs_rate() {
    let sent = simulate(0.1, &readings(3, 1_000, 0), 1_000);
    assert!((295..=307).contains(&sent.len()), "{}", sent.len());
    // A new reading is passed on within an interval.
    let latest = sent.iter().filter(|(_, age)| *age < 100).count();
    assert!(latest >= 30, "{latest}");
}

#[test]
fn a_silent_compass_is_heard_of_within_half_a_second() {
    let slow = sentences("interval_s = 60");
    let now = Instant::now();
    let mut sentences = slow;
    sentences.due(
        &Heading::from_degrees(1.0, 0.0, 0.0),
        None,
        Trigger::Timer,
        NO_INTERVAL,
        now,
    );
    assert_eq!(sentences.next_timer(NO_INTERVAL, now), now + LONGEST_PAUSE);
}
