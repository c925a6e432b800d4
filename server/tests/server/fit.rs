//! The command `fit` with each of its methods.

use crate::run;
use binnacle_compass::angle::MagneticHeading;
use binnacle_compass::model::{Model, ReferenceGrade};
use binnacle_compass::ship::EarthField;
use binnacle_server_testing::program::{assert_refused, good, samples_csv};
use binnacle_server_testing::true_model;
use std::fmt::Write;

const METHODS: [&str; 3] = ["paper", "ols", "robust"];

/// Returns a CSV of all headings in Biscay and south of the equator, with field columns.
fn two_latitudes() -> String {
    let mut text = "variation_deg,h_nt,z_nt,compass_deg,reference_deg\n".to_owned();
    for (h_nt, z_nt) in [(24_000.0, 38_500.0), (27_000.0, -15_000.0)] {
        for step in 0..36 {
            let magnetic = MagneticHeading::new(f64::from(step) * 10.0).unwrap();
            let compass = true_model()
                .compass(magnetic, EarthField { h_nt, z_nt })
                .unwrap()
                .degrees();
            let reference = (magnetic.degrees() + 355.0) % 360.0;
            writeln!(text, "-5,{h_nt},{z_nt},{compass},{reference}").unwrap();
        }
    }
    text
}

#[test]
fn every_method_fits_a_perfect_swing() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("swing.csv"), two_latitudes()).unwrap();
    let fields = [(24_000.0, 38_500.0), (18_000.0, 45_000.0)];
    for method in METHODS {
        let arguments = ["fit", "swing.csv", "--json", "--method", method];
        let model: Model = serde_json::from_str(&good(&run(folder.path(), &arguments))).unwrap();
        assert_eq!((model.samples_used, model.samples_rejected), (72, 0));
        for (h_nt, z_nt) in fields {
            let earth = EarthField { h_nt, z_nt };
            for step in 0..24 {
                let magnetic = MagneticHeading::new(f64::from(step) * 15.0).unwrap();
                let compass = true_model().compass(magnetic, earth).unwrap();
                let found = model.deviation(compass, earth).unwrap().deviation;
                let off = magnetic.degrees() - compass.degrees() - found.degrees_east();
                let off = (off + 540.0) % 360.0 - 180.0;
                assert!(off.abs() < 0.1, "{method} on {compass}: {off}");
            }
        }
    }
}

#[test]
fn at_one_latitude_only_the_robust_method_fits() {
    let folder = tempfile::tempdir().unwrap();
    let one = two_latitudes()
        .lines()
        .take(37)
        .collect::<Vec<_>>()
        .join("\n");
    std::fs::write(folder.path().join("one.csv"), one).unwrap();
    for method in ["paper", "ols"] {
        let refused = run(folder.path(), &["fit", "one.csv", "--method", method]);
        assert_refused(&refused, &["one.csv", "one magnetic latitude"]);
    }
    samples_csv(folder.path());
    for file in ["one.csv", "samples.csv"] {
        let table = good(&run(folder.path(), &["fit", file, "--method", "robust"]));
        assert!(table.contains("chi13"), "{table}");
    }
}

/// A true heading made from the compass and the variation, in tenths.
#[test]
fn a_reference_that_is_the_compass_itself_is_refused_by_every_method() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "variation_deg,h_nt,z_nt,compass_deg,reference_deg\n".to_owned();
    for row in 0..80_i32 {
        let compass = f64::from(row * 997 % 3600) / 10.0;
        let reference = (compass + 355.0) % 360.0;
        writeln!(text, "-5,24000,38500,{compass:.1},{reference:.1}").unwrap();
    }
    std::fs::write(folder.path().join("copy.csv"), text).unwrap();
    for method in METHODS {
        let refused = run(folder.path(), &["fit", "copy.csv", "--method", method]);
        assert_refused(&refused, &["copy.csv", "the compass's own"]);
    }
}

#[test]
fn help_describes_the_methods() {
    let folder = tempfile::tempdir().unwrap();
    let help = good(&run(folder.path(), &["fit", "--help"]));
    for word in METHODS
        .into_iter()
        .chain(["least squares", "default: robust"])
    {
        assert!(help.contains(word), "{word:?} is not in {help}");
    }
    let refused = run(folder.path(), &["fit", "x.csv", "--method", "magic"]);
    assert_eq!(refused.status.code(), Some(2));
}

#[test]
fn a_bad_value_beside_the_headings_is_refused_by_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let columns = "variation_deg,h_nt,z_nt,compass_deg,gyro_deg";
    for (column, value) in [
        ("cog_deg", "361"),
        ("rate_of_turn_deg_min", "east"),
        ("roll_deg", "-91"),
        ("roll_spread_deg", "-1"),
        ("temperature_c", "273"),
        ("gyro_source", "1.5"),
        ("satellite_source", "70000"),
        ("position_reckoned", "maybe"),
    ] {
        let text = format!("{columns},{column}\n-3,24000,38000,10,9,{value}\n");
        std::fs::write(folder.path().join("bad.csv"), text).unwrap();
        for command in ["fit", "analyse"] {
            let refused = run(folder.path(), &[command, "bad.csv"]);
            assert_refused(&refused, &[&format!("bad.csv:2: {column}: ")]);
        }
    }
}

#[test]
fn rows_of_a_reckoned_position_are_in_no_estimate() {
    let folder = tempfile::tempdir().unwrap();
    samples_csv(folder.path());
    let plain = std::fs::read_to_string(folder.path().join("samples.csv")).unwrap();
    let mark = |(index, line): (usize, &str)| match index {
        0 => format!("{line},position_reckoned"),
        1..=5 => format!("{line},true"),
        6..=20 => format!("{line},false"),
        _ => format!("{line},"),
    };
    let marked: Vec<String> = plain.lines().enumerate().map(mark).collect();
    std::fs::write(folder.path().join("marked.csv"), marked.join("\n")).unwrap();
    let kept = plain.lines().enumerate();
    let kept = kept.filter(|(index, _)| !(1..=5).contains(index));
    let kept: Vec<&str> = kept.map(|(_, line)| line).collect();
    std::fs::write(folder.path().join("kept.csv"), kept.join("\n")).unwrap();
    let fit = |file: &str| -> Model {
        let printed = good(&run(folder.path(), &["fit", file, "--json"]));
        serde_json::from_str(&printed).unwrap()
    };
    let (marked, kept) = (fit("marked.csv"), fit("kept.csv"));
    assert_eq!(marked.samples_rejected, kept.samples_rejected + 5);
    let without_count = Model {
        samples_rejected: kept.samples_rejected,
        ..marked
    };
    assert_eq!(without_count, kept);
    let analysed = good(&run(folder.path(), &["analyse", "marked.csv"]));
    let analysed: serde_json::Value = serde_json::from_str(&analysed).unwrap();
    let samples = analysed["samples"].as_array().unwrap();
    let reckoned = samples
        .iter()
        .filter(|sample| sample["reason"] == "gnss_interference");
    assert_eq!(reckoned.count(), 5);
}

/// A course over ground on long straight runs, with a set and leeway of some degrees.
fn by_course() -> String {
    let mut text = "time,lat,lon,compass_deg,cog_deg,sog_kn\n".to_owned();
    for row in 0..720 {
        let heading = f64::from(row / 18 * 67 % 360);
        let (day, hour, minute) = (1 + row / 144, row / 6 % 24, row % 6 * 10);
        let magnetic = MagneticHeading::new(heading + 2.0).unwrap();
        let earth = EarthField {
            h_nt: 24_000.0,
            z_nt: 38_500.0,
        };
        let compass = true_model().compass(magnetic, earth).unwrap().degrees();
        let drift =
            2.0 * (heading.to_radians() + 0.4).sin() + 0.7 * f64::from(row * 37 % 11 - 5) / 5.0;
        let cog = (heading + drift + 360.0) % 360.0;
        writeln!(
            text,
            "2026-11-{day:02}T{hour:02}:{minute:02}:00Z,45,-8,{compass},{cog},12"
        )
        .unwrap();
    }
    text
}

#[test]
fn a_table_with_a_course_over_ground_alone_gives_a_model_of_that_grade() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("course.csv"), by_course()).unwrap();
    let model = good(&run(folder.path(), &["fit", "course.csv", "--json"]));
    let model: Model = serde_json::from_str(&model).unwrap();
    assert_eq!(model.reference_grade, ReferenceGrade::CourseOverGround);
    let text = good(&run(folder.path(), &["fit", "course.csv"]));
    assert!(text.contains("the course over ground on"), "{text}");
    for command in ["analyse", "validate"] {
        let text = good(&run(folder.path(), &[command, "course.csv"]));
        assert!(!text.is_empty());
    }
    assert_refused(
        &run(folder.path(), &["fit", "course.csv", "--method", "ols"]),
        &["course.csv", "--method robust"],
    );
}
