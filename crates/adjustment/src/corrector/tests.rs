use super::*;
use crate::binnacle::tests::class_a;
use crate::binnacle::{
    Axis, BarSetting, Binnacle, BinnacleForm, HeelingSetting, PairSetting, Red, Side, Soft, Tray,
};
use proptest::prelude::*;

fn broadside_ut(distance_m: f64) -> f64 {
    let magnet = BarMagnet {
        centre: [0.0, 0.0, distance_m],
        moment: [1.0, 0.0, 0.0],
        length_m: 0.2,
    };
    magnet.field_nt([0.0; 3])[0] / 1e3
}

#[test]
fn a_magnet_broadside_is_as_strong_as_the_formula_says_and_points_against_its_red_end() {
    for (distance_m, field_ut) in [(0.25, 5.12), (0.30, 3.16), (0.40, 1.43)] {
        assert!(
            (broadside_ut(distance_m) + field_ut).abs() < 5e-3,
            "{distance_m}"
        );
    }
}

#[test]
fn a_magnet_end_on_is_twice_as_strong_from_afar_and_points_along_its_red_end() {
    let (h, length_m) = (0.4_f64, 0.15_f64);
    let magnet = BarMagnet {
        centre: [0.0, 0.0, h],
        moment: [0.0, 0.0, -1.5],
        length_m,
    };
    let expected = 200.0 * 1.5 * h / (h * h - length_m * length_m / 4.0).powi(2);
    // Red up: at the card above it the field points up.
    assert!((magnet.field_nt([0.0; 3])[2] + expected).abs() < 1e-9);
}

/// 7-inch spheres, λ 0.9 before: D in degrees, and more by a needle of 1.65 and 4 A·m².
#[test]
fn seven_inch_spheres_take_off_what_the_handbook_says() {
    for (inches, d_deg) in [(10.0, -7.7), (12.0, -4.5), (14.0, -2.9)] {
        let pair = Pair::new(3.5 * 0.0254, inches * 0.0254, 0.0);
        let chi = pair.effect(0.0).chi;
        let lambda = 0.9 + f64::midpoint(chi[0][0], chi[1][1]);
        let d = ((chi[0][0] - chi[1][1]) / 2.0 / lambda).to_degrees();
        assert!((d - d_deg).abs() < 0.051, "{inches}: {d}");
        assert!((lambda - 0.9 - pair.q()).abs() < 1e-12);
        assert!((chi[2][2] + 2.0 * pair.q()).abs() < 1e-12);
    }
    for (needle, d_deg) in [(1.65, -1.4), (4.0, -3.4)] {
        let effect = Pair::new(3.5 * 0.0254, 12.0 * 0.0254, 0.0).effect(needle);
        let lambda = 0.9 + f64::midpoint(effect.chi[0][0], effect.chi[1][1]);
        let at = |h_nt: f64| {
            let (with, without) = (effect.chi_at(h_nt), effect.chi);
            let more = |axis: usize| with[axis][axis] - without[axis][axis];
            assert!(
                (more(0) + more(1)).abs() < 1e-12,
                "needles add nothing to λ"
            );
            ((more(0) - more(1)) / 2.0 / lambda).to_degrees()
        };
        assert!((at(18_600.0) - d_deg).abs() < 0.06, "{}", at(18_600.0));
        assert!((at(37_200.0) * 2.0 - at(18_600.0)).abs() < 1e-9);
    }
}

#[test]
fn a_bar_of_75_mm_at_30_cm_gives_the_published_c_and_some_d() {
    for (length_m, c) in [(0.2, 0.015), (0.3, 0.038), (0.4, 0.070), (0.6, 0.144)] {
        let bar = Bar::new(length_m, 0.075, 0.3, 0.0);
        assert!((bar.c() - c).abs() < 6e-4, "{length_m}: {}", bar.c());
        let chi = bar.effect().chi;
        let d_deg = ((chi[0][0] - chi[1][1]) / 2.0 / 0.9).to_degrees();
        assert!((0.2..0.75).contains(&d_deg), "{length_m}: {d_deg}");
    }
    assert!((demagnetising(4.0) - 0.0664).abs() < 1e-12);
    assert!(demagnetising(0.1) <= 1.0 / 3.0 && demagnetising(100.0) > 0.0);
}

/// Direction of every corrector, as an adjuster knows it.
#[test]
fn every_corrector_cures_what_it_is_for() {
    let binnacle = class_a();
    let none = Iron::default();
    let of = |axis, red| {
        let tray = Tray {
            hole: 10,
            magnet: "200 mm".to_owned(),
            count: 1,
            red,
        };
        tray_effect(&binnacle, &none, axis, &tray).b_nt
    };
    assert!(
        of(Axis::ForeAndAft, Red::Forward)[0] < 0.0,
        "red forward cures +B"
    );
    assert!(of(Axis::ForeAndAft, Red::Aft)[0] > 0.0);
    assert!(
        of(Axis::Athwartship, Red::Starboard)[1] < 0.0,
        "red to starboard cures +C"
    );
    assert!(of(Axis::Athwartship, Red::Port)[1] > 0.0);
    let heeling = |red| {
        let set = HeelingSetting {
            position: 8,
            count: 1,
            red,
        };
        heeling_effect(&binnacle, &none, &set).b_nt
    };
    assert!(heeling(Red::Up)[2] < 0.0, "red up cures bz > 0");
    assert!(heeling(Red::Down)[2] > 0.0);
    let e = |slew_deg| {
        let chi = Pair::new(0.09, 0.3, slew_deg).effect(0.0).chi;
        f64::midpoint(chi[0][1], chi[1][0])
    };
    assert!(e(20.0) < 0.0, "starboard sphere aft cures +E");
    assert!(e(-20.0) > 0.0);
    let d = |slew_deg| {
        let chi = Pair::new(0.09, 0.3, slew_deg).effect(0.0).chi;
        chi[0][0] - chi[1][1]
    };
    assert!(d(0.0) < 0.0 && d(90.0) > 0.0);
    assert!(
        Bar::new(0.3, 0.075, 0.3, 0.0).effect().chi[0][2] > 0.0,
        "bar forward: +c"
    );
    assert!(Bar::new(0.3, 0.075, 0.3, 180.0).effect().chi[0][2] < 0.0);
}

/// The worked adjustment of Basterretxea-Iribar et al.: with holes 20 mm apart and hole 5
/// at 0.42 m, one moment explains both moves.
#[test]
fn the_papers_own_adjustment_is_of_one_moment() {
    // The magnets' length is not printed, and hardly counts far below the card.
    let per_am2 = |hole: f64| {
        let magnet = BarMagnet {
            centre: [0.0, 0.0, 0.42 + 0.02 * (5.0 - hole)],
            moment: [1.0, 0.0, 0.0],
            length_m: 0.1,
        };
        -magnet.field_nt([0.0; 3])[0]
    };
    // A pair, red aft, from hole 5 to 3: from 0.0034 to −0.0006 gauss.
    let fore_and_aft = -400.0 / (2.0 * (per_am2(3.0) - per_am2(5.0)));
    // One, red to port, from hole 7 to 3: from 0.0049 to 0.0004 gauss.
    let athwartship = -450.0 / (per_am2(3.0) - per_am2(7.0));
    for moment in [fore_and_aft, athwartship] {
        assert!(
            (0.4..0.75).contains(&moment),
            "{fore_and_aft} {athwartship}"
        );
    }
    // And the bar, 300 to 273 mm, took off a χ13 of 0.0038 or more.
    let taken = Bar::new(0.300, 0.075, 0.3, 0.0).c() - Bar::new(0.273, 0.075, 0.3, 0.0).c();
    assert!((0.0030..0.0095).contains(&taken), "{taken}");
}

#[test]
fn spheres_weaken_a_magnet_below_the_card_and_a_bar_takes_part() {
    let binnacle = class_a();
    let pair = Iron {
        pair: Some(Pair::new(0.09, 0.27, 0.0)),
        bar: None,
    };
    let bare = magnet_field(&binnacle, &Iron::default(), Axis::ForeAndAft, "200 mm", 10).unwrap();
    let seen = magnet_field(&binnacle, &pair, Axis::ForeAndAft, "200 mm", 10).unwrap();
    let share = seen[0] / bare[0];
    assert!((0.9..0.999).contains(&share), "{share}");
    let bar = Iron {
        pair: None,
        bar: Some(Bar::new(0.4, 0.075, 0.3, 0.0)),
    };
    // Red forward: the field lines go down forward of the card, into the bar's length.
    let seen = magnet_field(&binnacle, &bar, Axis::ForeAndAft, "200 mm", 10).unwrap();
    assert!((seen[0] - bare[0]).abs() > 1.0, "{seen:?} {bare:?}");
    // An athwartship magnet is at right angles to a bar forward of the card.
    let bare = magnet_field(&binnacle, &Iron::default(), Axis::Athwartship, "200 mm", 10).unwrap();
    let seen = magnet_field(&binnacle, &bar, Axis::Athwartship, "200 mm", 10).unwrap();
    assert!((seen[1] - bare[1]).abs() < 1e-6);
}

#[test]
fn what_was_measured_wins() {
    let mut form: BinnacleForm = class_a().into();
    form.calibration = vec![
        crate::binnacle::Calibrated::Magnet {
            axis: Axis::Athwartship,
            magnet: "200 mm".to_owned(),
            hole: 4,
            field_nt: 777.0,
            sd: 0.01,
        },
        crate::binnacle::Calibrated::Quadrantal {
            size: "7 inch".to_owned(),
            mark_mm: 300.0,
            q: 0.03,
            sd: 0.01,
        },
    ];
    let binnacle = Binnacle::try_from(form).unwrap();
    let none = Iron::default();
    let field = magnet_field(&binnacle, &none, Axis::Athwartship, "200 mm", 4).unwrap();
    assert!((field[1] + 777.0).abs() < 1e-9);
    let soft = Soft {
        quadrantal: Some(PairSetting {
            size: "7 inch".to_owned(),
            mark_mm: 300.0,
            slew_deg: 0.0,
        }),
        flinders: Some(BarSetting {
            length_mm: 300.0,
            side: Side::Aft,
            slew_deg: 0.0,
        }),
    };
    let iron = Iron::new(&binnacle, &soft);
    assert!((iron.pair.unwrap().q() - 0.03).abs() < 1e-12);
    assert!(iron.effect(0.0).chi[0][2] < 0.0);
}

proptest! {
    /// In a mirror along the keel, athwartship parts change their sign.
    #[test]
    fn the_mirror_image_of_iron_does_the_mirror_image(
        slew in -90.0..90.0_f64, azimuth in -180.0..180.0_f64, length in 0.1..0.6_f64,
    ) {
        let mirror = [1.0, -1.0, 1.0];
        let effect = |side: f64| {
            let iron = Iron {
                pair: Some(Pair::new(0.09, 0.3, side * slew)),
                bar: Some(Bar::new(length, 0.075, 0.3, side * azimuth)),
            };
            let magnet = BarMagnet {
                centre: [0.02, side * 0.05, 0.4],
                moment: [0.5, side * 0.7, 0.1],
                length_m: 0.2,
            };
            (iron.effect(2.0), iron.reflected(&magnet), magnet.field_nt([0.0; 3]))
        };
        let (one, other) = (effect(1.0), effect(-1.0));
        for row in 0..3 {
            for column in 0..3 {
                let mirrored = mirror[row] * mirror[column] * other.0.chi[row][column];
                prop_assert!((one.0.chi[row][column] - mirrored).abs() < 1e-12);
            }
            prop_assert!((one.1[row] - mirror[row] * other.1[row]).abs() < 1e-6);
            prop_assert!((one.2[row] - mirror[row] * other.2[row]).abs() < 1e-6);
        }
        prop_assert!((one.0.needle_nt[0][1] + other.0.needle_nt[0][1]).abs() < 1e-9);
    }

    /// A quarter turn moves forward to starboard.
    #[test]
    fn iron_turned_a_quarter_does_the_same_a_quarter_on(
        slew in -90.0..90.0_f64, azimuth in -180.0..180.0_f64,
    ) {
        let effect = |turn: f64| {
            Iron {
                pair: Some(Pair::new(0.09, 0.3, slew + turn)),
                bar: Some(Bar::new(0.3, 0.075, 0.3, azimuth + turn)),
            }
            .effect(2.0)
        };
        let (one, turned) = (effect(0.0).chi, effect(90.0).chi);
        prop_assert!((one[0][0] - turned[1][1]).abs() < 1e-12);
        prop_assert!((one[1][1] - turned[0][0]).abs() < 1e-12);
        prop_assert!((one[0][1] + turned[1][0]).abs() < 1e-12);
        prop_assert!((one[0][2] - turned[1][2]).abs() < 1e-12);
        prop_assert!((one[1][2] + turned[0][2]).abs() < 1e-12);
    }

    /// A setting's effect is the sum of its magnets' effects once the iron is set.
    #[test]
    fn magnets_with_red_ends_turned_do_the_opposite(hole in 1_u16..=20, count in 1_u8..=4) {
        let binnacle = class_a();
        let field = |red| {
            let mut setting = binnacle.setting.clone();
            setting.athwartship = vec![Tray { hole, magnet: "200 mm".to_owned(), count, red }];
            effect(&binnacle, &setting).b_nt
        };
        let mut without = binnacle.setting.clone();
        without.athwartship.clear();
        let without = effect(&binnacle, &without).b_nt;
        let (one, other) = (field(Red::Port), field(Red::Starboard));
        for axis in 0..3 {
            prop_assert!((one[axis] + other[axis] - 2.0 * without[axis]).abs() < 1e-6);
        }
    }
}
