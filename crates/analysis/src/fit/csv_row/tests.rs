use super::*;
use crate::fit::observe_readings;
use crate::observation::Observation;

fn row() -> CsvRow {
    CsvRow {
        variation_deg: Some(-3.0),
        h_nt: Some(24_000.0),
        z_nt: Some(38_000.0),
        compass_deg: Some(358.0),
        gyro_deg: Some(1.0),
        ..CsvRow::default()
    }
}

fn read(row: &CsvRow) -> Result<HeadingReading, CsvRowError> {
    readings_from_csv(&[*row], GyroSpeedError::Corrected).map(|readings| readings[0])
}

fn observed(row: &CsvRow) -> Option<Observation> {
    observe_readings(&[read(row).unwrap()], 0.5)
        .unwrap()
        .observations[0]
}

#[test]
fn deviation_is_reference_less_variation_less_compass() {
    let observation = observed(&row()).unwrap();
    assert!((observation.deviation.degrees_east() - 6.0).abs() < 1e-9);
}

#[test]
fn the_field_comes_from_time_and_place_where_it_is_not_given() {
    let at_sea = CsvRow {
        time: Some(Timestamp::parse("2026-06-01T00:00:00Z").unwrap()),
        lat: Some(50.0),
        lon: Some(-20.0),
        compass_deg: Some(10.0),
        satellite_deg: Some(5.0),
        ..CsvRow::default()
    };
    let observation = observed(&at_sea).unwrap();
    assert!((15_000.0..25_000.0).contains(&observation.h_nt));
    assert!(observation.variation.degrees_east() < -3.0);
}

#[test]
fn a_row_without_a_reference_makes_no_observation() {
    let without = CsvRow {
        gyro_deg: None,
        ..row()
    };
    let rows = [without, row()];
    let readings = readings_from_csv(&rows, GyroSpeedError::Corrected).unwrap();
    let observations = observe_readings(&readings, 0.5).unwrap().observations;
    assert_eq!(observations.iter().flatten().count(), 1);
}

#[test]
#[allow(clippy::too_many_lines)] // a table
fn each_fault_names_its_column() {
    let faults = [
        (
            CsvRow {
                compass_deg: None,
                ..row()
            },
            "compass_deg",
        ),
        (
            CsvRow {
                compass_deg: Some(361.0),
                ..row()
            },
            "compass_deg",
        ),
        (
            CsvRow {
                compass_deg: Some(f64::NAN),
                ..row()
            },
            "compass_deg",
        ),
        (
            CsvRow {
                h_nt: None,
                ..row()
            },
            "h_nt",
        ),
        (
            CsvRow {
                h_nt: Some(-1.0),
                ..row()
            },
            "h_nt",
        ),
        (
            CsvRow {
                z_nt: Some(f64::NAN),
                ..row()
            },
            "z_nt",
        ),
        (
            CsvRow {
                variation_deg: Some(200.0),
                ..row()
            },
            "variation_deg",
        ),
        (
            CsvRow {
                lat: Some(95.0),
                lon: Some(0.0),
                ..row()
            },
            "lat",
        ),
        (
            CsvRow {
                lat: Some(5.0),
                lon: Some(999.0),
                ..row()
            },
            "lon",
        ),
        (
            CsvRow {
                lat: Some(5.0),
                ..row()
            },
            "lon",
        ),
        (
            CsvRow {
                gyro_deg: Some(-5.0),
                ..row()
            },
            "gyro_deg",
        ),
        (
            CsvRow {
                weight: Some(-1.0),
                ..row()
            },
            "weight",
        ),
        (
            CsvRow {
                variation_deg: None,
                lat: Some(5.0),
                lon: Some(5.0),
                ..row()
            },
            "time",
        ),
        (
            CsvRow {
                variation_deg: None,
                time: Some(Timestamp::parse("1850-01-01T00:00:00Z").unwrap()),
                lat: Some(5.0),
                lon: Some(5.0),
                ..row()
            },
            "time",
        ),
    ];
    for (row, column) in faults {
        let error = read(&row).unwrap_err();
        assert_eq!((error.column(), error.row()), (column, Some(0)), "{error}");
    }
}

#[test]
fn a_missing_column_is_named() {
    assert_eq!(
        check_columns(["time", "lat", "lon", "compass_deg", "gyro_deg"]),
        Ok(())
    );
    assert_eq!(
        check_columns([
            "variation_deg",
            "h_nt",
            "z_nt",
            "compass_deg",
            "reference_deg"
        ]),
        Ok(())
    );
    let by_course = ["time", "lat", "lon", "compass_deg", "cog_deg", "sog_kn"];
    assert_eq!(check_columns(by_course), Ok(()));
    for (header, missing) in [
        (vec!["time", "lat", "lon", "gyro_deg"], "compass_deg"),
        (vec!["time", "lat", "compass_deg", "gyro_deg"], "lon"),
        (
            vec!["variation_deg", "h_nt", "compass_deg", "gyro_deg"],
            "z_nt",
        ),
        (
            vec!["time", "lat", "lon", "compass_deg"],
            "gyro_deg, satellite_deg, reference_deg or cog_deg",
        ),
        (
            vec!["time", "lat", "lon", "compass_deg", "cog_deg"],
            "sog_kn",
        ),
        (
            vec![
                "variation_deg",
                "h_nt",
                "z_nt",
                "compass_deg",
                "cog_deg",
                "sog_kn",
            ],
            "time",
        ),
    ] {
        assert_eq!(
            check_columns(header),
            Err(CsvRowError::MissingColumn(missing))
        );
    }
}

#[test]
fn rows_count_once_and_in_any_order_alike() {
    let at = |minute: i64, compass: f64| CsvRow {
        time: Timestamp::from_micros(1_780_000_000_000_000 + minute * 60_000_000).ok(),
        compass_deg: Some(compass),
        ..row()
    };
    let read = |rows: &[CsvRow]| readings_from_csv(rows, GyroSpeedError::Corrected).unwrap();
    let once = read(&[at(0, 10.0), at(0, 11.0), at(5, 12.0)]);
    let again = read(&[
        at(5, 12.0),
        at(0, 11.0),
        at(0, 10.0),
        at(5, 12.0),
        at(0, 11.0),
    ]);
    assert_eq!(once.len(), 3);
    assert_eq!(once, again);
}

#[test]
fn a_row_without_a_time_counts_once_however_often_it_stands_there() {
    let rows = [
        row(),
        CsvRow {
            gyro_deg: Some(2.0),
            ..row()
        },
    ];
    let once = readings_from_csv(&rows, GyroSpeedError::Corrected).unwrap();
    let often = readings_from_csv(&rows.repeat(10), GyroSpeedError::Corrected).unwrap();
    assert_eq!(once.len(), 2);
    assert_eq!(once, often);
}

#[test]
fn a_number_of_three_hundred_digits_is_quoted_briefly() {
    for wild in [
        CsvRow {
            compass_deg: Some(1e308),
            ..row()
        },
        CsvRow {
            h_nt: Some(1e308),
            ..row()
        },
    ] {
        let complaint = read(&wild).unwrap_err().to_string();
        assert!(
            complaint.contains("1e308") && complaint.len() < 80,
            "{complaint}"
        );
    }
}
