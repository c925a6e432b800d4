//! The published fit on the published data: Basterretxea-Iribar, Sotés & Uriarte
//! 2016, table 2 (with `data/paper_table2.csv` as printed, in gauss and degrees).

#![allow(clippy::unwrap_used)] // all of this is tests

use binnacle_analysis::fit::{Observation, RobustOptions, fit_ols, fit_paper, fit_robust};
use binnacle_compass::angle::{CompassHeading, Deviation, Variation, wrap_180};
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::model::Model;
use binnacle_compass::result::FitError;
use binnacle_compass::ship::EarthField;

const NT_PER_GAUSS: f64 = 1e5;

/// The table as it was printed.
fn as_printed() -> Vec<Observation> {
    let text = include_str!("../../compass/data/paper_table2.csv");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader
        .records()
        .map(|record| {
            let record = record.unwrap();
            let number = |column: usize| record[column].parse::<f64>().unwrap();
            Observation {
                time: None,
                position: None,
                compass: CompassHeading::new(number(6)).unwrap(),
                deviation: Deviation::new(number(3)).unwrap(),
                variation: Variation::new(number(7)).unwrap(),
                h_nt: number(8) * NT_PER_GAUSS,
                z_nt: number(9) * NT_PER_GAUSS,
                gyro_share: 1.0,
                gyro_less_satellite_deg: None,
                sog_kn: None,
                windows: 60,
                spread_deg: None,
                weight: 1.0,
            }
        })
        .collect()
}

/// The table with the two slips that its deviations were computed with: Dakar's
/// vertical field ten times too large, and Bilbao's at 327.0° with Cape Town's sign.
fn with_the_slips() -> Vec<Observation> {
    let mut rows = as_printed();
    for row in &mut rows {
        if (row.z_nt - 4890.0).abs() < 1.0 {
            row.z_nt = 48_900.0;
        }
    }
    rows
}

fn assert_parameters(model: &Model, gauss: [f64; 7], within: f64) {
    let mut found = model.parameters_over_lambda.to_array();
    found[0] /= NT_PER_GAUSS;
    found[2] /= NT_PER_GAUSS;
    for (j, (found, expected)) in found.iter().zip(gauss).enumerate() {
        assert!(
            (found - expected).abs() < within,
            "parameter {j}: {found} for {expected}"
        );
    }
}

#[test]
fn with_its_two_slips_the_table_gives_the_papers_own_parameters() {
    let rows = with_the_slips();
    let model = fit_paper(&rows).unwrap();
    assert_parameters(
        &model,
        [0.0206, -0.0215, -0.0293, 0.0022, 0.0352, 0.0012, 0.0016],
        1e-4,
    );

    let mut worst = 0.0_f64;
    let mut squares = 0.0;
    for row in &rows {
        let earth = EarthField {
            h_nt: row.h_nt,
            z_nt: row.z_nt,
        };
        let predicted = Coefficients::new(&model.parameters_over_lambda, earth)
            .unwrap()
            .deviation_at_compass_rad(row.compass.radians())
            .unwrap();
        let residual = wrap_180(row.deviation.degrees_east() - predicted.to_degrees());
        worst = worst.max(residual.abs());
        squares += residual * residual;
    }
    let rms = (squares / rows.len() as f64).sqrt();
    assert!((rms - 0.020).abs() < 0.001, "rms {rms}");
    assert!(worst < 0.045, "worst {worst}");
    assert!((model.rms_deg.unwrap() - rms).abs() < 1e-9);
}

#[test]
fn residuals_in_angle_find_the_same_ship() {
    let rows = with_the_slips();
    let model = fit_ols(&rows).unwrap();
    assert_parameters(
        &model,
        [0.0206, -0.0215, -0.0293, 0.0022, 0.0352, 0.0012, 0.0016],
        1e-4,
    );
    // In angle nothing fits better than least squares in angle.
    assert!(model.rms_deg < fit_paper(&rows).unwrap().rms_deg);
    assert_eq!(
        fit_ols(&as_printed()[..7]).unwrap_err(),
        fit_paper(&as_printed()[..7]).unwrap_err()
    );
}

#[test]
fn as_printed_the_table_gives_these() {
    let model = fit_paper(&as_printed()).unwrap();
    assert_parameters(
        &model,
        [0.0208, -0.0222, -0.0283, 0.0001, 0.0377, 0.0013, 0.0001],
        0.5e-4,
    );
}

#[test]
fn at_one_dip_the_published_fit_has_no_solution_and_says_so() {
    let mut rows = as_printed();
    for row in &mut rows {
        (row.h_nt, row.z_nt) = (24_000.0, 39_000.0);
    }
    assert_eq!(fit_paper(&rows), Err(FitError::OneMagneticLatitude));
}

#[test]
fn seven_rows_are_too_few() {
    assert_eq!(
        fit_paper(&as_printed()[..7]),
        Err(FitError::TooFewSamples {
            found: 7,
            needed: 8
        })
    );
}

#[test]
fn the_products_fit_agrees_with_the_papers_where_the_data_do() {
    // Rows without times, and deviations rounded to a tenth of a degree.
    let rows = with_the_slips();
    let model = fit_robust(&rows, &RobustOptions::default()).unwrap().model;
    assert_eq!((model.samples_used, model.samples_rejected), (24, 0));
    assert!(model.rms_deg.unwrap() < 0.1, "{:?}", model.rms_deg);
    for row in &rows {
        let earth = EarthField {
            h_nt: row.h_nt,
            z_nt: row.z_nt,
        };
        let predicted = model.deviation(row.compass, earth).unwrap();
        let off = predicted.deviation.degrees_east() - row.deviation.degrees_east();
        assert!(off.abs() < 0.2, "{off} on {}", row.compass);
    }
}
