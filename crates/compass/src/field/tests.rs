use super::*;

fn at(model: FieldModel, lat: f64, lon: f64, altitude_m: f64, year: f64) -> Field {
    let position = Position::new(lat, lon).unwrap();
    FieldAt::from_year(model, year)
        .unwrap()
        .at(position, altitude_m)
        .unwrap()
}

#[test]
fn igrf_is_within_a_fiftieth_of_a_nanotesla_of_its_reference() {
    let file = include_str!("../../data/igrf14_reference.csv");
    let mut reader = csv::Reader::from_reader(file.as_bytes());
    let mut rows = 0;
    for row in reader.records() {
        let row = row.unwrap();
        let number = |index: usize| row[index].parse::<f64>().unwrap();
        let time = Timestamp::parse(&format!("{}T00:00:00Z", &row[0])).unwrap();
        let position = Position::new(number(1), number(2)).unwrap();
        let found = field(FieldModel::Igrf14, position, number(3) * 1e3, time).unwrap();
        for (value, expected) in [
            (found.h_nt(), number(5)),
            (found.z_nt, number(6)),
            (found.x_nt, number(7)),
            (found.y_nt, number(8)),
        ] {
            assert!((value - expected).abs() < 0.02, "{row:?}: {found:?}");
        }
        let declination = found.declination().degrees_east();
        assert!((declination - number(4)).abs() < 1e-4, "{row:?}");
        rows += 1;
    }
    assert_eq!(rows, 206);
}

#[test]
fn wmm_is_within_a_thousandth_of_a_nanotesla_of_noaas_hundred_values() {
    let file = include_str!("../../data/WMM2025_TestValues.txt");
    let mut rows = 0;
    for line in file.lines().filter(|line| !line.starts_with('#')) {
        let row: Vec<f64> = line
            .split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect();
        let found = at(FieldModel::Wmm2025, row[2], row[3], row[1] * 1e3, row[0]);
        for (value, expected) in [
            (found.h_nt(), row[6]),
            (found.x_nt, row[7]),
            (found.y_nt, row[8]),
            (found.z_nt, row[9]),
            (found.f_nt(), row[10]),
        ] {
            assert!((value - expected).abs() < 0.001, "{line}: {found:?}");
        }
        let declination = found.declination().degrees_east();
        assert!((declination - row[4]).abs() < 0.006, "{line}");
        assert!((found.inclination_deg() - row[5]).abs() < 0.006, "{line}");
        rows += 1;
    }
    assert_eq!(rows, 100);
}

#[test]
fn no_component_leaps_at_a_pole_or_beside_it() {
    for model in [FieldModel::Igrf14, FieldModel::Wmm2025] {
        for pole in [90.0, -90.0] {
            for lon in [-180.0, -77.3, 0.0, 45.0, 90.0, 179.9] {
                let exact = at(model, pole, lon, 0.0, 2026.0);
                assert!(exact.f_nt().is_finite());
                for away in [1e-12, 1e-9, 1e-7] {
                    let beside = at(model, pole - pole.signum() * away, lon, 0.0, 2026.0);
                    assert!((beside.x_nt - exact.x_nt).abs() < 1e-3);
                    assert!((beside.y_nt - exact.y_nt).abs() < 1e-3);
                    assert!((beside.z_nt - exact.z_nt).abs() < 1e-3);
                }
            }
        }
    }
}

/// At the pole itself, all meridians give the same horizontal vector.
#[test]
fn all_meridians_agree_on_the_field_at_the_pole() {
    for (pole, turn) in [(90.0, -1.0), (-90.0, 1.0)] {
        let vector = |lon: f64| {
            let found = at(FieldModel::Igrf14, pole, lon, 0.0, 2020.0);
            let (sin, cos) = (turn * lon.to_radians()).sin_cos();
            (
                found.x_nt * cos - found.y_nt * sin,
                found.x_nt * sin + found.y_nt * cos,
                found.z_nt,
            )
        };
        let (x, y, z) = vector(0.0);
        for lon in [-170.0, -90.0, 33.0, 120.0] {
            let (x2, y2, z2) = vector(lon);
            assert!((x - x2).abs() < 1e-6 && (y - y2).abs() < 1e-6 && (z - z2).abs() < 1e-6);
        }
    }
}

#[test]
fn the_field_is_the_same_from_either_side_of_the_antimeridian() {
    for lat in [-60.0, 0.0, 52.5] {
        let west = at(FieldModel::Igrf14, lat, -180.0, 0.0, 2026.5);
        let east = at(FieldModel::Igrf14, lat, 180.0, 0.0, 2026.5);
        let beside = at(FieldModel::Igrf14, lat, 179.999_999_999, 0.0, 2026.5);
        assert_eq!(west, east);
        assert!((west.x_nt - beside.x_nt).abs() < 1e-4);
        assert!((west.y_nt - beside.y_nt).abs() < 1e-4);
    }
}

#[test]
fn variation_is_east_and_west_where_charts_have_it() {
    let variation = |lat, lon| {
        at(FieldModel::Igrf14, lat, lon, 0.0, 2026.0)
            .declination()
            .degrees_east()
    };
    assert!(
        (-27.0..-24.0).contains(&variation(-33.9, 18.4)),
        "Cape Town"
    );
    assert!((11.0..14.0).contains(&variation(-33.9, 151.2)), "Sydney");
    assert!((-14.0..-11.0).contains(&variation(40.7, -74.0)), "New York");
    assert!((14.0..17.0).contains(&variation(47.6, -122.3)), "Seattle");
    assert!((-9.0..-7.0).contains(&variation(35.6, 139.7)), "Tokyo");
}

#[test]
fn dip_is_down_in_the_north_and_up_in_the_south() {
    assert!(at(FieldModel::Igrf14, 55.0, 10.0, 0.0, 2026.0).inclination_deg() > 60.0);
    let hobart = at(FieldModel::Igrf14, -43.0, 147.0, 0.0, 2026.0);
    assert!(hobart.z_nt < -50_000.0 && hobart.magnetic_latitude_deg() < -45.0);
}

#[test]
fn the_two_models_agree_within_their_own_error() {
    for lat in (-80..=80).step_by(20) {
        for lon in (-180..180).step_by(30) {
            let (lat, lon) = (f64::from(lat), f64::from(lon));
            let igrf = at(FieldModel::Igrf14, lat, lon, 0.0, 2026.9);
            let wmm = at(FieldModel::Wmm2025, lat, lon, 0.0, 2026.9);
            assert!((igrf.h_nt() - wmm.h_nt()).abs() < 100.0);
            assert!((igrf.z_nt - wmm.z_nt).abs() < 100.0);
        }
    }
}

#[test]
fn a_date_outside_the_model_is_refused_by_name() {
    let position = Position::new(0.0, 0.0).unwrap();
    let time = Timestamp::parse("1850-06-01T00:00:00Z").unwrap();
    let refused = field(FieldModel::Igrf14, position, 0.0, time).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "igrf14 covers the years 1900 to 2030, not 1850.4137"
    );
    for (model, year) in [
        (FieldModel::Igrf14, 1899.99),
        (FieldModel::Igrf14, 2030.01),
        (FieldModel::Igrf14, f64::NAN),
        (FieldModel::Wmm2025, 2024.99),
        (FieldModel::Wmm2025, f64::INFINITY),
    ] {
        assert!(FieldAt::from_year(model, year).is_err(), "{model} {year}");
    }
    for (model, year) in [
        (FieldModel::Igrf14, 1900.0),
        (FieldModel::Igrf14, 2030.0),
        (FieldModel::Wmm2025, 2025.0),
        (FieldModel::Wmm2025, 2030.0),
    ] {
        assert!(FieldAt::from_year(model, year).is_ok(), "{model} {year}");
    }
}

#[test]
fn an_absurd_altitude_is_refused() {
    let model = FieldAt::from_year(FieldModel::Igrf14, 2026.0).unwrap();
    let position = Position::new(10.0, 20.0).unwrap();
    for altitude in [f64::NAN, f64::INFINITY, -6.4e6, 1e7] {
        let refused = model.at(position, altitude).unwrap_err();
        assert!(matches!(refused, FieldError::Altitude(_)));
    }
    assert!(model.at(position, -430.0).is_ok());
}

#[test]
fn a_model_is_named_the_same_in_commands_and_json() {
    for model in [FieldModel::Igrf14, FieldModel::Wmm2025] {
        assert_eq!(model.name().parse(), Ok(model));
        let json = serde_json::to_string(&model).unwrap();
        assert_eq!(json, format!("\"{model}\""));
    }
    assert!("wmm2020".parse::<FieldModel>().is_err());
}

#[test]
fn wmm_agrees_with_an_independent_implementation_at_random_places() {
    use kinavis_kernel::{Distance, GeodeticPoint, Height, Position as OtherPosition};
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2025);
    for _ in 0..2_000 {
        let (lat, lon) = (
            rng.random_range(-90.0..90.0),
            rng.random_range(-180.0..180.0),
        );
        let (altitude_m, year) = (
            rng.random_range(-500.0..90_000.0),
            rng.random_range(2025.0..2029.99),
        );
        let found = at(FieldModel::Wmm2025, lat, lon, altitude_m, year);
        let place = GeodeticPoint::new(
            OtherPosition::from_degrees(lat, lon).unwrap(),
            Height::above_ellipsoid(Distance::from_metres(altitude_m).unwrap()),
        );
        let year = kinavis_wmm::DecimalYear::new(year).unwrap();
        let other = kinavis_wmm::Wmm::WMM2025.field_in(place, year).unwrap();
        assert!((found.x_nt - other.north_nanotesla()).abs() < 1e-6);
        assert!((found.y_nt - other.east_nanotesla()).abs() < 1e-6);
        assert!((found.z_nt - other.down_nanotesla()).abs() < 1e-6);
    }
}

#[test]
fn the_field_moves_less_than_a_nanotesla_a_day() {
    let mut fastest = 0.0_f64;
    for lat in (-90..=90).step_by(5) {
        for lon in (-180..180).step_by(10) {
            let (lat, lon) = (f64::from(lat), f64::from(lon));
            for first in [1902.0, 1957.0, 2026.0] {
                let now = at(FieldModel::Igrf14, lat, lon, 0.0, first);
                let later = at(FieldModel::Igrf14, lat, lon, 0.0, first + 1.0 / 365.25);
                for moved in [
                    later.x_nt - now.x_nt,
                    later.y_nt - now.y_nt,
                    later.z_nt - now.z_nt,
                ] {
                    fastest = fastest.max(moved.abs());
                }
            }
        }
    }
    assert!((0.1..1.0).contains(&fastest), "{fastest}");
}
