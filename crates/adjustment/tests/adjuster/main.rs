//! An adjuster who knows only the words of the steps, at a binnacle that knows only the
//! direction of north-seeking poles. For all signs of the ship, the compass then shows each
//! step's prediction, and in the end the plan's.

#![allow(clippy::unwrap_used)] // a test's

mod hand;
mod handbook;
mod world;

use binnacle_adjustment::adjust::{
    Adjustment, Circumstances, Limits, Plan, VerticalReading, Water, plan,
};
use binnacle_adjustment::berth::{Alignment, BerthReading, ReadingErrors};
use binnacle_adjustment::binnacle::{Binnacle, SHIPPED};
use binnacle_compass::angle::MagneticHeading;
use binnacle_compass::model::{Model, Parameters, ReferenceGrade};
use binnacle_compass::ship::EarthField;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use world::{Hardware, Lying, Ship, compass_deg};

const NORTHERN: (f64, f64) = (22_000.0, 41_000.0);
const SOUTHERN: (f64, f64) = (19_000.0, -33_000.0);

/// A class A binnacle with a tray per axis, a pair of spheres and a bar of two pieces, all
/// of which slew.
fn written(setting: &Value) -> (Binnacle, Hardware) {
    let mut design: Value = serde_json::from_str(SHIPPED[0].1).unwrap();
    design["needle_moment_am2"] = json!(0.0);
    for rack in ["fore_and_aft", "athwartship"] {
        design[rack]["at_once"] = json!(1);
        design[rack]["off_centre_mm"] = json!(0);
    }
    let marks = [260.0, 290.0, 320.0, 350.0];
    let marks = marks.map(|mm| json!({ "mark_mm": mm, "centre_mm": mm }));
    design["quadrantal"]["marks"] = json!(marks);
    design["quadrantal"]["slews_deg"] = json!([-70, -20, 0, 20, 70, 90]);
    design["flinders"]["slews_deg"] = json!([-20, 0, 20]);
    let depths = |field: &str, list: &str| -> Vec<f64> {
        let holes = design[field][list].as_array().unwrap().iter();
        holes
            .map(|h| h["below_card_mm"].as_f64().unwrap() / 1e3)
            .collect()
    };
    let bar_c = BTreeMap::from([(200, 0.0152), (400, 0.0701)]);
    let hardware = Hardware {
        moment_am2: 1.0,
        length_m: 0.2,
        depths_m: [
            depths("fore_and_aft", "holes"),
            depths("athwartship", "holes"),
            depths("heeling", "positions"),
        ],
        sphere_radius_m: 0.0889,
        bar_axis_m: 0.3,
        bar_c,
    };
    design["heeling"]["magnet"] = json!("200 mm");
    let calibration = hardware.bar_c.iter().map(|(length_mm, c)| {
        json!({ "corrector": "flinders", "length_mm": length_mm, "c": c, "sd": 0.01 })
    });
    let form = json!({
        "version": 1,
        "serial": "by words",
        "type": design,
        "aboard": {
            "magnets": [{ "magnet": "200 mm", "count": 12 }],
            "quadrantal": ["7 inch"],
            "flinders_pieces_mm": [200, 200]
        },
        "setting": setting,
        "calibration": calibration.collect::<Vec<Value>>()
    });
    (serde_json::from_value(form).unwrap(), hardware)
}

/// Converts the setting to the notes of an observer.
fn noted(setting: &Value) -> world::Binnacle {
    let mut noted = world::Binnacle::default();
    for (axis, field) in [("forward", "fore_and_aft"), ("starboard", "athwartship")] {
        for tray in setting[field].as_array().into_iter().flatten() {
            let red = tray["red"].as_str().unwrap().to_owned();
            let count = tray["count"].as_u64().unwrap() as u8;
            let hole = tray["hole"].as_u64().unwrap() as u16;
            noted.magnets.insert((axis, hole), (count, red));
        }
    }
    let number = |field: &str, part: &str| setting[field][part].as_f64();
    noted.spheres = number("quadrantal", "mark_mm").map(|mm| (mm / 1e3, 0.0));
    noted.bar = number("flinders", "length_mm").map(|mm| (mm / 1e3, 0.0));
    noted.bucket = number("heeling", "position").map(|position| {
        let red = setting["heeling"]["red"].as_str().unwrap().to_owned();
        (position as u16, 1, red)
    });
    noted
}

/// A ship at a berth, with the binnacle in its setting.
struct Case {
    ship: Ship,
    binnacle: Binnacle,
    hardware: Hardware,
    found: world::Binnacle,
    berth: (f64, f64),
    magnetic_deg: f64,
}

impl Case {
    fn new(ship: Ship, setting: &Value, berth: (f64, f64), magnetic_deg: f64) -> Case {
        let found = noted(setting);
        let (binnacle, hardware) = written(setting);
        Case {
            ship,
            binnacle,
            hardware,
            found,
            berth,
            magnetic_deg,
        }
    }

    fn compass(&self, standing: &world::Binnacle, place: (f64, f64), lying: Lying) -> f64 {
        compass_deg(&self.ship, standing, &self.hardware, place, lying)
    }

    /// Model of the ship by a fit without errors.
    fn model(&self) -> Model {
        let head_north = Lying {
            magnetic_deg: 0.0,
            heel_deg: 0.0,
        };
        let read = |earth: [f64; 3]| {
            world::read(&self.ship, &self.found, &self.hardware, earth, head_north)
        };
        let b = read([0.0; 3]);
        let chi = |row: usize, column: usize| {
            let mut earth = [0.0; 3];
            earth[column] = 1e5;
            let unit = if row == column { 1.0 } else { 0.0 };
            (read(earth)[row] - b[row]) / 1e5 - unit
        };
        let lambda = 1.0 + f64::midpoint(chi(0, 0), chi(1, 1));
        let seven = [
            b[0],
            chi(0, 2),
            b[1],
            chi(1, 2),
            chi(0, 0) - chi(1, 1),
            chi(0, 1),
            chi(1, 0),
        ];
        let mut covariance = [[0.0; 8]; 8];
        let sds = [20.0, 5e-4, 20.0, 5e-4, 1e-3, 1e-3, 1e-3, 0.2_f64];
        for (index, sd) in sds.into_iter().enumerate() {
            covariance[index][index] = sd.powi(2);
        }
        Model {
            parameters_over_lambda: Parameters::from_array(seven.map(|part| part / lambda)),
            constant_deg: 0.0,
            covariance: Some(covariance),
            identifiable: None,
            rms_deg: None,
            samples_used: 100,
            samples_rejected: 0,
            quality: None,
            reference_grade: ReferenceGrade::Heading,
            mean_h_nt: None,
            needles: None,
        }
    }

    fn plan(&self, waters: &[Water]) -> Plan {
        let (h_nt, z_nt) = self.berth;
        let model = self.model();
        let earth = [h_nt, 0.0, z_nt];
        let [x, y, down_nt] =
            world::read(&self.ship, &self.found, &self.hardware, earth, self.level());
        let errors = ReadingErrors {
            field_sd_nt: 100.0,
            heading_sd_deg: 0.3,
            alignment_sd_deg: 0.2,
            tilt_sd_deg: 0.1,
        };
        let heading = MagneticHeading::new(self.magnetic_deg).unwrap();
        let outcome = plan(&Adjustment {
            model: &model,
            earth: EarthField { h_nt, z_nt },
            reading: &BerthReading::new(heading, [x, y], errors, Alignment::Keel).unwrap(),
            scale_sd: 0.003,
            compass_deg: None,
            vertical: Some(VerticalReading { down_nt }),
            binnacle: &self.binnacle,
            now: None,
            waters,
            circumstances: Circumstances::default(),
            limits: Limits {
                residual_deg: 20.0,
                band_deg: 20.0,
                ..Limits::default()
            },
        });
        let mut outcome = outcome.unwrap();
        assert!(!outcome.plans.is_empty(), "{:?}", outcome.refusals);
        outcome.plans.remove(0)
    }

    fn level(&self) -> Lying {
        Lying {
            magnetic_deg: self.magnetic_deg,
            heel_deg: 0.0,
        }
    }

    /// Heeling error on north, degrees of deviation, east positive, per degree of heel to
    /// starboard.
    fn heeling_error(&self, standing: &world::Binnacle) -> f64 {
        let heeled = |heel_deg: f64| {
            let lying = Lying {
                magnetic_deg: 0.0,
                heel_deg,
            };
            // Deviation is magnetic less compass.
            -wrapped(self.compass(standing, self.berth, lying))
        };
        (heeled(0.5) - heeled(-0.5)) / 1.0
    }

    /// Returns the deviation on a compass heading.
    fn deviation(&self, standing: &world::Binnacle, place: (f64, f64), compass_deg: f64) -> f64 {
        let mut deviation = 0.0;
        for _ in 0..60 {
            let lying = Lying {
                magnetic_deg: compass_deg + deviation,
                heel_deg: 0.0,
            };
            let shown = self.compass(standing, place, lying);
            deviation += 0.7 * wrapped(compass_deg - shown);
        }
        deviation
    }
}

fn wrapped(degrees: f64) -> f64 {
    (degrees + 180.0).rem_euclid(360.0) - 180.0
}

fn water(name: &str, (h_nt, z_nt): (f64, f64)) -> Water {
    Water {
        name: name.to_owned(),
        h_nt,
        z_nt,
        weight: 1.0,
    }
}

/// Every sign of hard and soft iron, in both hemispheres, on headings all round.
#[test]
fn whatever_the_signs_the_compass_shows_what_the_words_predict() {
    let standing = json!({
        "fore_and_aft": [{ "hole": 6, "magnet": "200 mm", "count": 2, "red": "aft" }],
        "athwartship": [{ "hole": 7, "magnet": "200 mm", "count": 1, "red": "port" }],
        "quadrantal": { "size": "7 inch", "mark_mm": 320 },
        "flinders": { "length_mm": 200, "side": "forward" },
        "heeling": { "position": 4, "count": 1, "red": "up" }
    });
    let waters = [water("north", NORTHERN), water("south", SOUTHERN)];
    let mut seen = std::collections::BTreeSet::new();
    for signs in 0..16_u32 {
        let sign = |bit: u32| if signs & (1 << bit) == 0 { 1.0 } else { -1.0 };
        // The fifth sign of a plan's coefficients is determined by the others.
        let odd = sign(0) * sign(1) * sign(2);
        let (weak, strong) = (-0.06, -0.17);
        let (fore, across) = if odd > 0.0 {
            (weak, strong)
        } else {
            (strong, weak)
        };
        let e = 0.02 * sign(3);
        let ship = Ship {
            hard_nt: [3_000.0 * sign(0), 2_600.0 * sign(1), 2_400.0 * sign(2)],
            // Induction by the earth's field along each axis.
            soft: [
                [fore, e, 0.0],
                [e, across, 0.0],
                [-0.045 * sign(1), 0.02 * sign(2), -0.05],
            ],
        };
        let berth = if sign(2) * sign(3) > 0.0 {
            NORTHERN
        } else {
            SOUTHERN
        };
        let magnetic_deg = 11.0 + 22.5 * f64::from(signs);
        let case = Case::new(ship, &standing, berth, magnetic_deg);
        let plan = case.plan(&waters);
        let mut binnacle = case.found.clone();
        for step in &plan.steps {
            hand::done(&mut binnacle, &step.words);
            seen.insert(kinds(&step.words));
            let shown = case.compass(&binnacle, berth, case.level());
            let off = wrapped(step.expected_compass_deg - shown);
            assert!(off.abs() < 0.5, "{signs:04b} {}: {off}", step.words);
        }
        let (mut before, mut after) = (0.0_f64, 0.0_f64);
        for (table, place) in plan.after.iter().zip([berth, NORTHERN, SOUTHERN]) {
            for row in &table.rows {
                let left = case.deviation(&binnacle, place, row.compass_deg);
                let off = wrapped(left - row.deviation_deg);
                assert!(off.abs() < 0.6, "{signs:04b} {}: {off}", table.place);
                after = after.max(left.abs());
                before = before.max(case.deviation(&case.found, place, row.compass_deg).abs());
            }
        }
        assert!(after < 0.5 * before, "{signs:04b}: {after} of {before}");
        for (standing, predicted) in [
            (&case.found, plan.heeling.before_deg_per_deg.unwrap()),
            (&binnacle, plan.heeling.after_deg_per_deg.unwrap()),
        ] {
            let truth = case.heeling_error(standing);
            let off = (truth - predicted).abs();
            assert!(
                off < 0.04 + 0.2 * truth.abs(),
                "{signs:04b}: J {truth} {predicted}"
            );
        }
    }
    for red in ["forward", "aft", "starboard", "port", "up", "down"] {
        assert!(
            seen.iter().any(|kinds| kinds.contains(red)),
            "no step had red {red}"
        );
    }
    for place in ["spheres aft", "spheres forward", "bar before", "bar abaft"] {
        assert!(seen.contains(place), "no step had {place}: {seen:?}");
    }
}

/// Kind of corrector of a step, so that all of them occur.
fn kinds(words: &str) -> String {
    let to = words.rsplit(" to ").next().unwrap();
    let kind = match words.split_once(':').unwrap().0 {
        "quadrantal correctors" if words.ends_with("aft") => "spheres aft",
        "quadrantal correctors" if words.ends_with("forward") => "spheres forward",
        "Flinders bar" if words.contains("abaft") => "bar abaft",
        "Flinders bar" => "bar before",
        _ => to.rsplit(' ').next().unwrap(),
    };
    kind.to_owned()
}
