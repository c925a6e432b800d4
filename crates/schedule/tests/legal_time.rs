//! Ports keep legal time: known days and hours, and the nights on which clocks
//! change.

#![allow(clippy::unwrap_used)] // helpers of tests

use binnacle_schedule::ports::{self, Port, PortCode};
use binnacle_schedule::time::Instant;
use binnacle_schedule::zone::Zone;
use chrono::{NaiveDate, NaiveDateTime};

fn port(code: &str) -> &'static Port {
    ports::find(PortCode::parse(code).unwrap()).unwrap()
}

fn instant(text: &str) -> Instant {
    Instant::parse(text).unwrap()
}

fn local(text: &str) -> NaiveDateTime {
    text.parse().unwrap()
}

fn zone(name: &str) -> Zone {
    Zone::find(name).unwrap()
}

#[test]
fn a_port_shows_its_countrys_time_in_winter_and_summer() {
    for (code, december, july) in [
        ("WSAPW", "+13:00", "+13:00"), // Apia, whose longitude says eleven behind
        ("ESVGO", "+01:00", "+02:00"), // Vigo
        ("PTPDL", "-01:00", "+00:00"), // Ponta Delgada
        ("PTFNC", "+00:00", "+01:00"), // Funchal
        ("ESLPA", "+00:00", "+01:00"), // Las Palmas
        ("USDUT", "-09:00", "-08:00"), // Dutch Harbor
        ("USANC", "-09:00", "-08:00"), // Anchorage
        ("USKUB", "-10:00", "-09:00"), // Adak
        ("USPNS", "-06:00", "-05:00"), // Pensacola, in the west of Florida
        ("USPFN", "-06:00", "-05:00"), // Panama City
        ("USPSJ", "-05:00", "-04:00"), // Port Saint Joe
        ("USMIA", "-05:00", "-04:00"), // Miami
        ("USEVV", "-06:00", "-05:00"), // Evansville
        ("USHNL", "-10:00", "-10:00"), // Honolulu
        ("CASJF", "-03:30", "-02:30"), // Saint John's
        ("CAGOO", "-04:00", "-03:00"), // Goose Bay, in the same province
        ("CAVAN", "-07:00", "-07:00"), // Vancouver: no change of clocks from 2026 on
        ("MXTIJ", "-08:00", "-07:00"), // Tijuana
        ("BRMAO", "-04:00", "-04:00"), // Manaus
        ("BRSSZ", "-03:00", "-03:00"), // Santos
        ("CLIPC", "-05:00", "-06:00"), // Easter Island
        ("ECAYO", "-06:00", "-06:00"), // Puerto Ayora
        ("KITRW", "+12:00", "+12:00"), // Tarawa
        ("KIEBI", "+13:00", "+13:00"), // Enderbury
        ("AUADL", "+10:30", "+09:30"), // Adelaide
        ("AUDRW", "+09:30", "+09:30"), // Darwin
        ("INBOM", "+05:30", "+05:30"), // Mumbai
        ("RUVVO", "+10:00", "+10:00"), // Vladivostok
        ("RUMCX", "+03:00", "+03:00"), // Makhachkala
        ("IDSUB", "+07:00", "+07:00"), // Surabaya
        ("IDBPN", "+08:00", "+08:00"), // Balikpapan
        ("CNSGH", "+08:00", "+08:00"), // Shanghai
        ("MACAS", "+00:00", "+00:00"), // Casablanca: no hour ahead from autumn 2026 on
        ("GBLON", "+00:00", "+01:00"), // London
    ] {
        let zone = port(code).zone;
        let offset = |at: &str| instant(at).in_zone(zone).format("%:z").to_string();
        assert_eq!(offset("2026-12-01T00:00:00Z"), december, "{code} {zone}");
        assert_eq!(offset("2027-07-01T00:00:00Z"), july, "{code} {zone}");
    }
}

#[test]
fn islands_at_the_date_line_are_on_their_own_side_of_it() {
    let noon = instant("2026-12-08T12:00:00Z");
    let date = |zone: Zone| noon.date(zone).to_string();
    assert_eq!(date(port("WSAPW").zone), "2026-12-09");
    assert_eq!(date(zone("Pacific/Kiritimati")), "2026-12-09");
    assert_eq!(date(zone("Pacific/Pago_Pago")), "2026-12-08");
    assert_eq!(
        noon.in_zone(zone("Pacific/Chatham")).to_rfc3339(),
        "2026-12-09T01:45:00+13:45"
    );
}

#[test]
fn a_place_that_unece_has_far_from_its_country_keeps_its_countrys_time() {
    // Viola, Louisiana and Midland, Western Australia are in the middle of oceans there.
    assert_eq!(port("USVIX").zone, zone("America/Chicago"));
    assert_eq!(port("AUMID").zone, zone("Australia/Perth"));
}

#[test]
fn a_working_day_begins_at_its_hour_on_either_side_of_a_change_of_clocks() {
    let vigo = port("ESVGO").zone;
    let day = |text: &str| -> NaiveDate { text.parse().unwrap() };
    for (on, begins) in [
        ("2026-07-15", "2026-07-15T06:00:00Z"),
        ("2026-10-24", "2026-10-24T06:00:00Z"),
        ("2026-10-25", "2026-10-25T07:00:00Z"),
        ("2026-12-08", "2026-12-08T07:00:00Z"),
    ] {
        assert_eq!(Instant::at(day(on), 8.0, vigo).to_string(), begins);
    }
    let adelaide = port("AUADL").zone;
    let opens = Instant::at(day("2026-12-08"), 7.25, adelaide);
    assert_eq!(opens.to_string(), "2026-12-07T20:45:00Z");
    // The day on which clocks go back is twenty-five hours long.
    let [from, to] = [day("2026-10-25"), day("2026-10-26")].map(|day| vigo.midnight(day));
    assert!((to.hours_since(from) - 25.0).abs() < 1e-9);
    assert_eq!(Instant::at(day("2026-10-25"), 24.0, vigo), to);
}

#[test]
fn a_time_that_clocks_skip_is_the_first_instant_after_it() {
    let madrid = zone("Europe/Madrid");
    for (shown, at) in [
        ("2026-03-29T01:59:59", "2026-03-29T00:59:59Z"),
        ("2026-03-29T02:00:00", "2026-03-29T01:00:00Z"),
        ("2026-03-29T02:30:00", "2026-03-29T01:00:00Z"),
        ("2026-03-29T02:59:59", "2026-03-29T01:00:00Z"),
        ("2026-03-29T03:00:00", "2026-03-29T01:00:00Z"),
        ("2026-03-29T03:30:00", "2026-03-29T01:30:00Z"),
    ] {
        assert_eq!(madrid.instant(local(shown)).to_string(), at, "{shown}");
    }
    // In Beirut they are put forward at midnight: that day begins at one.
    let beirut = zone("Asia/Beirut");
    let begins = beirut.midnight("2027-03-28".parse().unwrap());
    assert_eq!(
        begins.in_zone(beirut).to_rfc3339(),
        "2027-03-28T01:00:00+03:00"
    );
    // Samoa had no 30 December 2011 at all.
    let skipped = zone("Pacific/Apia").instant(local("2011-12-30T08:00:00"));
    assert_eq!(skipped.to_string(), "2011-12-30T10:00:00Z");
}

#[test]
fn a_time_that_clocks_show_twice_is_the_first() {
    for (name, shown, at) in [
        (
            "Europe/Madrid",
            "2026-10-25T02:30:00",
            "2026-10-25T00:30:00Z",
        ),
        (
            "Europe/Madrid",
            "2026-10-25T03:00:00",
            "2026-10-25T02:00:00Z",
        ),
        (
            "America/New_York",
            "2026-11-01T01:30:00",
            "2026-11-01T05:30:00Z",
        ),
        (
            "Australia/Lord_Howe",
            "2027-04-04T01:45:00",
            "2027-04-03T14:45:00Z",
        ),
    ] {
        assert_eq!(
            zone(name).instant(local(shown)).to_string(),
            at,
            "{name} {shown}"
        );
    }
}

#[test]
fn an_unknown_zone_is_refused_with_its_name() {
    for wrong in [
        "",
        "Europe/Atlantis",
        "europe/madrid",
        "UTC+1",
        "../etc/passwd",
    ] {
        let refused = Zone::find(wrong).unwrap_err().to_string();
        assert!(refused.ends_with("is not a time zone such as Europe/Madrid"));
    }
    assert!(serde_json::from_str::<Zone>("\"Nowhere\"").is_err());
    let madrid: Zone = serde_json::from_str("\"Europe/Madrid\"").unwrap();
    assert_eq!(serde_json::to_string(&madrid).unwrap(), "\"Europe/Madrid\"");
}

#[test]
fn the_ends_of_the_calendar_are_no_panic() {
    for at in ["0001-01-01T00:00:00Z", "9999-12-31T23:59:59Z"] {
        for name in ["Pacific/Kiritimati", "Pacific/Honolulu", "Europe/Madrid"] {
            let (at, zone) = (instant(at), zone(name));
            let there = zone.local(at);
            assert!(zone.instant(there).hours_since(at).abs() < 24.0);
            zone.midnight(at.date(zone));
            at.in_zone(zone);
        }
    }
}

mod laws {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A local time leads back to the instant, or to the first one that
        /// shows it.
        #[test]
        fn an_instant_is_found_again_by_its_local_time(
            which in 0_usize..10_000,
            hours in 0_i64..40 * 8766,
        ) {
            let ports = ports::all();
            let zone = ports[which % ports.len()].zone;
            let at = instant("2000-01-01T00:20:00Z").plus_hours(hours as f64);
            let found = zone.instant(zone.local(at));
            prop_assert_eq!(zone.local(found), zone.local(at));
            prop_assert!(found <= at && at.hours_since(found) < 24.1);
            let day = at.date(zone);
            prop_assert!(zone.midnight(day) <= at);
            prop_assert!(at < zone.midnight(day.succ_opt().unwrap()));
        }
    }
}
