//! Port calls from CSV and iCalendar: accepted files, and faults with their
//! lines.

#![allow(clippy::unwrap_used)] // helpers of tests

use binnacle_schedule::calls::{FileErrors, MAX_LISTED, PortCall, csv, escape_formula, ics};
use binnacle_schedule::time::Instant;
use std::io::{BufReader, Read};

fn now() -> Instant {
    Instant::parse("2026-11-21T00:00:00Z").unwrap()
}

fn read_csv(text: &str) -> Result<csv::Rows, FileErrors> {
    let mut faults = FileErrors::default();
    match csv::read(text.as_bytes(), None, now(), &mut faults) {
        Ok(rows) => faults.into_result(rows),
        Err(fault) => {
            faults.push(fault);
            Err(faults)
        }
    }
}

fn csv_calls(text: &str) -> Vec<PortCall> {
    let read = read_csv(text).unwrap();
    read.calls.into_iter().map(|located| located.call).collect()
}

fn csv_complaint(text: &str) -> String {
    read_csv(text).unwrap_err().to_string()
}

const HEADER: &str = "id,vessel,port,eta,etd,eta_uncertainty_h\n";

#[test]
fn calls_are_read_from_csv_and_written_back() {
    let text = format!(
        "\u{feff}{HEADER}c1,v1,nl rtm,2026-12-01T06:00:00+01:00,2026-12-02T18:00:00Z,6\r\n\n"
    );
    let calls = csv_calls(&text);
    assert_eq!(calls[0].port.to_string(), "NLRTM");
    assert_eq!(calls[0].eta.to_string(), "2026-12-01T05:00:00Z");
    let mut out = Vec::new();
    csv::write(&calls, &mut out).unwrap();
    assert_eq!(csv_calls(std::str::from_utf8(&out).unwrap()), calls);
}

#[test]
fn a_port_may_stand_by_its_name_and_a_time_without_seconds() {
    let calls =
        csv_calls("vessel,port,eta,etd\nv1,Bilbao,2026-12-01T06:00Z,2026-12-02 18:30+01:00\n");
    assert_eq!(calls[0].port.to_string(), "ESBIO");
    assert_eq!(calls[0].eta.to_string(), "2026-12-01T06:00:00Z");
    assert_eq!(calls[0].etd.to_string(), "2026-12-02T17:30:00Z");
    for (port, eta, complaint) in [
        (
            "Rotterdam",
            "2026-12-01T06:00Z",
            "several ports (NLRTM, USRAJ): write the code",
        ),
        (
            "Rotterdm",
            "2026-12-01T06:00Z",
            "\"Rotterdm\" is neither a UN/LOCODE",
        ),
        (
            "Bilbao",
            "2026-12-01 06:00",
            "eta: \"2026-12-01 06:00\" has no time zone",
        ),
        (
            "Bilbao",
            "1 Dec 2026",
            "eta: \"1 Dec 2026\" is not an RFC 3339 time",
        ),
    ] {
        let text = format!("vessel,port,eta,etd\nv1,{port},{eta},2026-12-03T06:00Z\n");
        let said = csv_complaint(&text);
        assert!(said.contains(complaint), "{said}");
    }
}

#[test]
fn each_fault_of_a_csv_is_named_with_line_and_column() {
    let cases = [
        (
            "c,v,NLRTM,2026-12-01T06:00:00,2026-12-02T18:00:00Z,",
            "line 2: eta: \"2026-12-01T06:00:00\" has no time zone",
        ),
        (
            "c,v,NLRTM,2026-12-01T06:00:00Z,2026-11-20T18:00:00Z,",
            "line 2: etd: 2026-11-20T18:00:00Z is not after eta",
        ),
        (
            "c,v,NLRTM,9999-12-01T06:00:00Z,9999-12-02T18:00:00Z,",
            "line 2: eta: 9999-12-01T06:00:00Z is more than 730 days ahead",
        ),
        (
            "c,v,XXXXX,2026-12-01T06:00:00Z,2026-12-02T18:00:00Z,",
            "line 2: port: XXXXX is not a sea port",
        ),
        (
            "c,v,NLRTM,2026-12-01T06:00:00Z,2026-12-02T18:00:00Z,six",
            "line 2: eta_uncertainty_h: \"six\" is not a number",
        ),
        (
            "c,v,NLRTM,2026-12-01T06:00:00Z,2026-12-02T18:00:00Z,NaN",
            "line 2: eta_uncertainty_h: \"NaN\" is not a number",
        ),
        (
            "c,v,NLRTM,2026-12-01T06:00:00Z",
            "line 2: row: 4 fields, where the first line has 6",
        ),
        (
            "c,,NLRTM,2026-12-01T06:00:00Z,2026-12-02T18:00:00Z,",
            "line 2: vessel: is empty",
        ),
        (
            "\"c,v,NLRTM,2026-12-01T06:00:00Z,2026-12-02T18:00:00Z,",
            "line 2: row: a quote is not closed",
        ),
    ];
    for (row, expected) in cases {
        let said = csv_complaint(&format!("{HEADER}{row}\n"));
        assert!(said.starts_with(expected), "{said}\nis not\n{expected}");
    }
    assert_eq!(csv_complaint(""), "line 1: row: the file is empty");
    assert_eq!(
        csv_complaint("port,eta\n"),
        "line 1: etd: the column is missing"
    );
    assert!(csv_complaint("port,eta,etd,colour\n").starts_with("line 1: colour: is not a column"));
}

#[test]
fn every_bad_row_of_a_csv_is_named() {
    let good = "c,v,NLRTM,2026-12-01T06:00:00Z,2026-12-02T18:00:00Z,\n";
    let said = csv_complaint(&format!(
        "{HEADER}d,v,NLRTM,soon,2026-12-02T18:00:00Z,\n{good}e,v,XXXXX,2026-12-01T06:00:00Z,\
         2026-12-02T18:00:00Z,\nf,v\n{good}"
    ));
    let lines: Vec<&str> = said.split("; line ").collect();
    let begins = [
        "line 2: eta: ",
        "4: port: XXXXX",
        "5: row: 2 fields",
        "6: id: \"c\"",
    ];
    assert_eq!(lines.len(), begins.len(), "{said}");
    for (line, begins) in lines.iter().zip(begins) {
        assert!(line.starts_with(begins), "{said}");
    }
}

#[test]
fn of_many_bad_rows_the_first_are_named_and_the_others_counted() {
    let bad = "c,v,NLRTM,soon,2026-12-02T18:00:00Z,\n";
    let said = csv_complaint(&format!("{HEADER}{}", bad.repeat(MAX_LISTED + 3)));
    assert_eq!(said.matches("line ").count(), MAX_LISTED);
    assert!(said.contains("line 51: eta"), "{said}");
    assert!(said.ends_with("; and 3 more"), "{said}");
    let said = csv_complaint(&format!("{HEADER}{}", bad.repeat(csv::MAX_CALLS + 5)));
    assert!(said.ends_with("; and 49951 more"), "{said}");
}

#[test]
fn fifty_megabytes_without_a_line_end_are_refused_after_a_line() {
    let mut read = 0_usize;
    let endless = std::io::repeat(b'a').take(50_000_000);
    let counted = Counted {
        inner: endless,
        read: &mut read,
    };
    let error = csv::read(
        BufReader::new(counted),
        None,
        now(),
        &mut FileErrors::default(),
    )
    .unwrap_err();
    assert_eq!(error.detail, "is longer than 4096 bytes");
    assert!(read <= 16_384, "{read}");
}

struct Counted<'a, R> {
    inner: R,
    read: &'a mut usize,
}

impl<R: Read> Read for Counted<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let got = self.inner.read(buffer)?;
        *self.read += got;
        Ok(got)
    }
}

#[test]
fn a_csv_of_too_many_calls_is_refused_at_the_first_too_many() {
    let row = |at: usize| format!("{at},v,NLRTM,2026-12-01T06:00:00Z,2026-12-02T18:00:00Z,\n");
    let rows: String = (0..csv::MAX_CALLS + 5).map(row).collect();
    let text = format!("{HEADER}{rows}");
    assert_eq!(
        csv_complaint(&text),
        "line 50002: row: more than 50000 calls"
    );
}

#[test]
fn an_exported_cell_is_no_formula_and_reads_back() {
    let text = format!("{HEADER}=1+1,@v,NLRTM,2026-12-01T06:00:00Z,2026-12-02T18:00:00Z,\n");
    let calls = csv_calls(&text);
    let mut out = Vec::new();
    csv::write(&calls, &mut out).unwrap();
    let written = String::from_utf8(out.clone()).unwrap();
    assert!(written.contains("\n'=1+1,'@v,"), "{written}");
    assert_eq!(csv_calls(std::str::from_utf8(&out).unwrap()), calls);
    for harmless in ["", "c1", "'c1", "a=b"] {
        assert_eq!(escape_formula(harmless), harmless);
    }
    assert_eq!(escape_formula("'=1"), "''=1");
}

/// Madrid as calendars define it.
const MADRID: &str = "BEGIN:VTIMEZONE\r\nTZID:Europe/Madrid\r\n\
    BEGIN:DAYLIGHT\r\nTZOFFSETFROM:+0100\r\nTZOFFSETTO:+0200\r\nDTSTART:19700329T020000\r\nRRULE:FREQ=YEARLY;BYMONTH=3;BYDAY=-1SU\r\nEND:DAYLIGHT\r\n\
    BEGIN:STANDARD\r\nTZOFFSETFROM:+0200\r\nTZOFFSETTO:+0100\r\nDTSTART:19701025T030000\r\nRRULE:FREQ=YEARLY;BYMONTH=10;BYDAY=-1SU\r\nEND:STANDARD\r\n\
    END:VTIMEZONE\r\n";

fn calendar(start: &str, end: &str, more: &str) -> String {
    format!(
        "BEGIN:VCALENDAR\r\nVERSION:2.0\r\n{MADRID}BEGIN:VEVENT\r\nUID:c1@agent\r\n{start}\r\n{end}\r\n{more}\r\nEND:VEVENT\r\nEND:VCALENDAR\r\n"
    )
}

const END: &str = "DTEND:20270802T180000Z";

fn eta_of(start: &str) -> String {
    let month = &start.rsplit_once(':').unwrap().1[..6];
    let end = format!("DTEND:{month}30T180000Z");
    let text = calendar(start, &end, "LOCATION:Bilbao\\, ESBIO");
    ics::read(&text, "v", now()).unwrap().calls[0]
        .call
        .eta
        .to_string()
}

#[test]
fn a_calendars_times_are_taken_in_their_zone_summer_and_winter() {
    assert_eq!(eta_of("DTSTART:20270701T060000Z"), "2027-07-01T06:00:00Z");
    assert_eq!(
        eta_of("DTSTART;TZID=Europe/Madrid:20270701T060000"),
        "2027-07-01T04:00:00Z"
    );
    assert_eq!(
        eta_of("DTSTART;TZID=\"Europe/Madrid\":20270101T060000"),
        "2027-01-01T05:00:00Z"
    );
    // The last Sunday of March 2027 is the 28th; that of October 2026 was the
    // 25th.
    assert_eq!(
        eta_of("DTSTART;TZID=Europe/Madrid:20270328T013000"),
        "2027-03-28T00:30:00Z"
    );
    assert_eq!(
        eta_of("DTSTART;TZID=Europe/Madrid:20270328T033000"),
        "2027-03-28T01:30:00Z"
    );
}

#[test]
fn a_time_outside_the_calendars_years_is_refused_with_its_line() {
    for start in [
        "DTSTART:00000101T000000Z",
        "DTSTART;TZID=Europe/Madrid:00010101T003000",
        "DTSTART:99991231T235960Z",
    ] {
        let text = calendar(start, END, "LOCATION:ESBIO");
        let error = ics::read(&text, "v", now()).unwrap_err();
        assert_eq!(error.field, "DTSTART");
        assert!(
            error.detail.contains("outside the years 1 to 9999"),
            "{error}"
        );
    }
}

/// The port of a call in a calendar with the lines `more`, or the fault.
fn port_of(more: &str) -> Result<String, String> {
    let text = calendar("DTSTART:20270701T060000Z", END, more);
    ics::read(&text, "v", now())
        .map(|calendar| calendar.calls[0].call.port.to_string())
        .map_err(|error| error.to_string())
}

#[test]
fn a_port_is_found_by_code_or_by_a_name_that_only_one_has() {
    assert_eq!(
        port_of("SUMMARY:Call at ES BIO\\, berth 3").unwrap(),
        "ESBIO"
    );
    assert_eq!(
        port_of("X-UNLOCODE:NLRTM\r\nLOCATION:somewhere").unwrap(),
        "NLRTM"
    );
    assert_eq!(
        port_of("LOCATION:Jebel Ali\\, terminal 2").unwrap(),
        "AEJEA"
    );
    // A folded line goes on.
    assert_eq!(port_of("LOCATION:Jebel\r\n  Ali").unwrap(), "AEJEA");
    assert!(
        port_of("LOCATION:Nowhere")
            .unwrap_err()
            .contains("LOCATION: \"Nowhere\" is not a known port")
    );
    assert!(
        port_of("LOCATION:Newport")
            .unwrap_err()
            .contains("write the UN/LOCODE")
    );
}

/// CLARA and GRAND are codes of ports in Chile and Greece.
#[test]
fn a_ships_name_and_a_part_of_a_ports_name_are_no_port() {
    assert_eq!(
        port_of("SUMMARY:CLARA MAERSK at Bilbao\r\nLOCATION:Bilbao").unwrap(),
        "ESBIO"
    );
    assert_eq!(
        port_of("SUMMARY:GRAND PIONEER calls\r\nLOCATION:Antwerp (BEANR)").unwrap(),
        "BEANR"
    );
    assert_eq!(
        port_of("LOCATION:Georgetown\\, Grand Cayman (KYGEC)").unwrap(),
        "KYGEC"
    );
    assert_eq!(port_of("LOCATION:ES BIO Bilbao").unwrap(), "ESBIO");
    // Two ports share the name: the summary may choose one, but no third.
    assert_eq!(
        port_of("SUMMARY:Nao\\, NLRTM\r\nLOCATION:Rotterdam").unwrap(),
        "NLRTM"
    );
    for refused in [
        "SUMMARY:CLARA MAERSK at Rotterdam\r\nLOCATION:Rotterdam",
        "SUMMARY:GRAND PIONEER calls",
        "SUMMARY:CLARA",
        "SUMMARY:Arrival at GRAND HARBOUR",
        "LOCATION:GEORGETOWN\\, GRAND CAYMAN",
        "LOCATION:CLARA MAERSK",
        "LOCATION:NLRTM\\, BEANR",
        "LOCATION:Bilbao (NLRTM)",
        "X-UNLOCODE:XXXXX\r\nLOCATION:NLRTM",
    ] {
        assert!(port_of(refused).is_err(), "{refused}");
    }
}

#[test]
fn a_missing_property_is_refused_with_its_line() {
    let said = |start: &str, end: &str, more: &str| {
        ics::read(&calendar(start, end, more), "v", now())
            .unwrap_err()
            .to_string()
    };
    let (start, port) = ("DTSTART:20270701T060000Z", "LOCATION:NLRTM");
    assert_eq!(
        said("DTSTART:20270701T060000", END, port),
        "line 20: DTSTART: \"20270701T060000\" has no time zone; write Z for UTC"
    );
    assert!(said("DTSTART;VALUE=DATE:20270701", END, port).contains("is a whole day"));
    assert!(
        said("DTSTART;TZID=Mars/North:20270701T060000", END, port).contains("has no VTIMEZONE")
    );
    assert!(said(start, "DTEND:20270601T000000Z", port).starts_with("line 21: DTEND: 2027-06-01"));
    assert!(said(start, "SUMMARY:x", port).contains("DTEND: is missing"));
    assert!(said(start, END, "LOCATION:NLRTM\r\nRRULE:FREQ=DAILY").contains("does not repeat"));
    assert!(ics::read("hello", "v", now()).is_err());
    assert!(ics::read("", "v", now()).is_err());
}

#[test]
fn an_event_may_have_a_duration_instead_of_an_end() {
    let start = "DTSTART;TZID=Europe/Madrid:20270701T060000";
    let read = |lasts: &str| ics::read(&calendar(start, lasts, "LOCATION:NLRTM"), "v", now());
    let etd = read("DURATION:P1DT12H").unwrap().calls[0].call.etd;
    assert_eq!(etd.to_string(), "2027-07-02T16:00:00Z");
    let said = |lasts: &str| read(lasts).unwrap_err().to_string();
    assert!(said("DURATION:-P1D").starts_with("line 21: DURATION: \"-P1D\" is not a duration"));
    assert!(said("DURATION:P4294967295W").contains("of a year at most"));
    assert!(said("DURATION:PT0S").starts_with("line 21: DURATION: "));
}

#[test]
fn a_time_zone_of_more_offsets_than_any_in_use_is_refused() {
    let offset =
        "BEGIN:STANDARD\r\nDTSTART:19000101T000000\r\nTZOFFSETTO:+0100\r\nEND:STANDARD\r\n";
    let of = |offsets: usize| {
        let zone = format!(
            "BEGIN:VTIMEZONE\r\nTZID:Z\r\n{}END:VTIMEZONE\r\n",
            offset.repeat(offsets)
        );
        ics::read(
            &format!("BEGIN:VCALENDAR\r\n{zone}END:VCALENDAR\r\n"),
            "v",
            now(),
        )
    };
    assert!(of(200).is_ok());
    let error = of(201).unwrap_err().to_string();
    assert!(error.contains("more than 200 offsets"), "{error}");
}

#[test]
fn a_cancelled_event_is_no_call() {
    let text = calendar(
        "DTSTART:20270701T060000Z",
        END,
        "LOCATION:NLRTM\r\nSTATUS:CANCELLED",
    );
    let read = ics::read(&text, "v", now()).unwrap();
    assert_eq!((read.calls.len(), read.over), (0, 0));
    assert_eq!(read.cancelled, ["c1@agent"]);
}

/// Programs that export a ship's calls go on exporting the one that it has
/// left.
#[test]
fn a_past_row_is_skipped() {
    let over = "c,v,NLRTM,2026-11-01T06:00:00Z,2026-11-20T18:00:00Z,\n";
    let ahead = "d,v,NLRTM,2026-12-01T06:00:00Z,2026-12-02T18:00:00Z,\n";
    let text = format!("{HEADER}{over}{ahead}");
    let read = read_csv(&text).unwrap();
    let calls: Vec<(usize, &str)> = read
        .calls
        .iter()
        .map(|located| (located.line, located.call.id.as_str()))
        .collect();
    assert_eq!((calls, read.over), (vec![(3, "d")], 1));
}

#[test]
fn a_past_call_is_counted_and_left_out() {
    let past = calendar(
        "DTSTART:20260701T060000Z",
        "DTEND:20260702T060000Z",
        "LOCATION:NLRTM",
    );
    let read = ics::read(&past, "v", now()).unwrap();
    assert_eq!((read.calls.len(), read.over), (0, 1));
}

#[test]
fn a_call_that_stands_in_a_file_twice_is_refused_with_both_lines() {
    let row = "c,v,NLRTM,2026-12-01T06:00:00Z,2026-12-02T18:00:00Z,\n";
    let other = row.replacen(",v,", ",w,", 1);
    let said = csv_complaint(&format!("{HEADER}{row}{other}{row}"));
    assert_eq!(said, "line 4: id: \"c\" is already on line 2");
}
