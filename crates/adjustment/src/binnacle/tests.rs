use super::*;

/// The larger shipped design, well stocked, with every kind of corrector set.
pub(crate) fn class_a() -> Binnacle {
    let design: Design = serde_json::from_str(SHIPPED[0].1).unwrap();
    Binnacle::try_from(form(design)).unwrap()
}

fn form(design: Design) -> BinnacleForm {
    let tray = |hole, red| Tray {
        hole,
        magnet: "200 mm".to_owned(),
        count: 2,
        red,
    };
    let lot = |magnet: &str, count| Lot {
        magnet: magnet.to_owned(),
        count,
        tested_moment_am2: None,
        tested_sd: None,
    };
    BinnacleForm {
        version: VERSION,
        serial: "1234".to_owned(),
        design,
        inventory: Inventory {
            magnets: vec![lot("200 mm", 12), lot("heeling 150 mm", 2)],
            quadrantal: ["5 inch", "7 inch", "8.5 inch"].map(str::to_owned).to_vec(),
            flinders_pieces_mm: vec![300.0, 150.0, 75.0, 75.0],
        },
        setting: Setting {
            fore_and_aft: vec![tray(5, Red::Aft)],
            athwartship: vec![tray(7, Red::Port)],
            quadrantal: Some(PairSetting {
                size: "7 inch".to_owned(),
                mark_mm: 320.0,
                slew_deg: 0.0,
            }),
            flinders: Some(BarSetting {
                length_mm: 225.0,
                side: Side::Forward,
                slew_deg: 0.0,
            }),
            heeling: Some(HeelingSetting {
                position: 4,
                count: 1,
                red: Red::Up,
            }),
        },
        calibration: Vec::new(),
    }
}

fn refused(change: impl FnOnce(&mut BinnacleForm)) -> BinnacleError {
    let mut form: BinnacleForm = class_a().into();
    change(&mut form);
    Binnacle::try_from(form).unwrap_err()
}

fn refused_design(change: impl FnOnce(&mut DesignForm)) -> BinnacleError {
    let mut form: DesignForm = class_a().design.clone().into();
    change(&mut form);
    Design::try_from(form).unwrap_err()
}

#[test]
fn every_design_shipped_reads_says_where_it_is_from_and_comes_back_as_it_went() {
    for (name, text) in SHIPPED {
        let design: Design = serde_json::from_str(text).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(design.provenance.contains("no maker's data"), "{name}");
        let again: serde_json::Value = serde_json::to_value(&design).unwrap();
        assert_eq!(serde_json::from_value::<Design>(again).unwrap(), design);
    }
}

#[test]
fn a_binnacle_comes_back_from_json_as_it_went() {
    let text = serde_json::to_string(&class_a()).unwrap();
    assert_eq!(serde_json::from_str::<Binnacle>(&text).unwrap(), class_a());
}

#[test]
fn a_hole_below_the_first_is_said_in_an_adjusters_words() {
    let text = serde_json::to_string(&class_a()).unwrap();
    let text = text.replacen("\"hole\":5", "\"hole\":-1", 1);
    let error = serde_json::from_str::<Binnacle>(&text).unwrap_err();
    let says = "there is no -1: holes and positions are numbered from 1";
    assert!(error.to_string().contains(says), "{error}");
}

#[test]
fn a_hole_that_does_not_exist_is_named() {
    let error = refused(|form| form.setting.athwartship[0].hole = 21);
    assert_eq!(
        error.to_string(),
        "setting.athwartship[0].hole: there is no hole 21: they are numbered 1 to 20"
    );
    assert_eq!(
        refused(|f| f.setting.athwartship[0].hole = 0).field,
        error.field
    );
}

#[test]
fn a_test_that_no_magnet_of_its_kind_can_have_is_refused() {
    let nominal = class_a().design.magnets[0].moment_am2;
    let tested = |moment| {
        let mut form: BinnacleForm = class_a().into();
        form.inventory.magnets[0].tested_moment_am2 = Some(moment);
        Binnacle::try_from(form)
    };
    let field = "aboard.magnets[0].tested_moment_am2";
    // What was written of old is read, and is not to be written again.
    for moment in [50.0, 2.1 * nominal, 0.09 * nominal] {
        let error = tested(moment).unwrap().check_tested_moments().unwrap_err();
        assert_eq!(error.field, field);
    }
    for moment in [-nominal, f64::NAN] {
        assert_eq!(tested(moment).unwrap_err().field, field);
    }
    for moment in [0.4 * nominal, nominal, 1.3 * nominal] {
        tested(moment).unwrap().check_tested_moments().unwrap();
    }
}

#[test]
fn an_empty_catalogue_is_named() {
    for (change, field) in [
        (
            (|f: &mut DesignForm| f.magnets.clear()) as fn(&mut DesignForm),
            "magnets",
        ),
        (|f| f.fore_and_aft.holes.clear(), "fore_and_aft.holes"),
        (|f| f.athwartship.magnets.clear(), "athwartship.magnets"),
        (
            |f| f.quadrantal.as_mut().unwrap().sizes.clear(),
            "quadrantal.sizes",
        ),
        (
            |f| f.quadrantal.as_mut().unwrap().marks.clear(),
            "quadrantal.marks",
        ),
        (
            |f| f.flinders.as_mut().unwrap().sides.clear(),
            "flinders.sides",
        ),
        (
            |f| f.heeling.as_mut().unwrap().positions.clear(),
            "heeling.positions",
        ),
    ] {
        let error = refused_design(change);
        assert_eq!(error.field, field);
        assert!(error.what.contains("is empty"), "{error}");
    }
}

#[test]
fn distances_that_cannot_be_are_named() {
    for value in [-20.0, 0.0, f64::NAN, f64::INFINITY, 1e5] {
        let error = refused_design(|f| f.athwartship.holes[3].below_card_mm = value);
        assert_eq!(error.field, "athwartship.holes[3].below_card_mm");
        let error = refused_design(|f| f.quadrantal.as_mut().unwrap().marks[2].centre_mm = value);
        assert_eq!(error.field, "quadrantal.marks[2].centre_mm");
        let error = refused_design(|f| f.magnets[0].moment_am2 = value.min(0.0));
        assert_eq!(error.field, "magnets[0].moment_am2");
    }
}

#[test]
fn positions_that_stand_twice_or_upside_down_are_named() {
    let error = refused_design(|f| {
        let depth = f.fore_and_aft.holes[4].below_card_mm;
        f.fore_and_aft.holes[5].below_card_mm = depth;
    });
    assert_eq!(error.field, "fore_and_aft.holes[5].below_card_mm");
    let error = refused_design(|f| f.fore_and_aft.holes.reverse());
    assert!(error.what.contains("from the bottom"), "{error}");
    let error = refused_design(|f| {
        let marks = &mut f.quadrantal.as_mut().unwrap().marks;
        marks[1].mark_mm = marks[0].mark_mm;
    });
    assert_eq!(error.field, "quadrantal.marks[1].mark_mm");
    let error = refused(|f| {
        let twice = f.setting.fore_and_aft[0].clone();
        f.setting.fore_and_aft.push(twice);
    });
    assert_eq!(error.field, "setting.fore_and_aft[1].hole");
}

#[test]
fn a_setting_with_what_is_not_on_board_is_named() {
    let error = refused(|f| f.inventory.magnets[0].count = 3);
    assert!(
        error
            .what
            .starts_with("4 magnets \"200 mm\" are set, but 3 are on board"),
        "{error}"
    );
    assert_eq!(
        refused(|f| f.inventory.quadrantal.clear()).field,
        "setting.quadrantal.size"
    );
    let error = refused(|f| f.inventory.flinders_pieces_mm.clear());
    assert_eq!(error.field, "setting.flinders.length_mm");
    let error = refused(|f| f.setting.fore_and_aft[0].red = Red::Port);
    assert_eq!(error.what, "port instead of forward or aft");
    let error = refused(|f| f.setting.heeling.as_mut().unwrap().red = Red::Aft);
    assert_eq!(error.field, "setting.heeling.red");
    let error = refused(|f| f.setting.quadrantal.as_mut().unwrap().slew_deg = 7.0);
    assert_eq!(error.field, "setting.quadrantal.slew_deg");
}

#[test]
fn a_form_of_another_version_and_a_field_misspelt_are_refused() {
    assert_eq!(refused(|f| f.version = 2).field, "version");
    let text = SHIPPED[1]
        .1
        .replace("\"off_centre_mm\"", "\"off_center_mm\"");
    let error = serde_json::from_str::<Design>(&text)
        .unwrap_err()
        .to_string();
    assert!(error.contains("off_center_mm"), "{error}");
}

#[test]
fn a_calibration_of_a_place_that_is_not_there_is_named() {
    let error = refused(|f| {
        f.calibration = vec![Calibrated::Heeling {
            position: 99,
            field_nt: 100.0,
        }];
    });
    assert_eq!(error.field, "calibration[0].position");
    let error = refused(|f| {
        let entry = Calibrated::Flinders {
            length_mm: 300.0,
            c: 0.04,
            sd: 0.02,
        };
        f.calibration = vec![entry.clone(), entry];
    });
    assert_eq!(error.field, "calibration[1]");
}

#[test]
fn a_bar_is_as_long_as_its_pieces_make_it() {
    let lengths: Vec<f64> = class_a().bar_lengths().iter().map(|(l, _)| *l).collect();
    assert_eq!(
        lengths,
        [75.0, 150.0, 225.0, 300.0, 375.0, 450.0, 525.0, 600.0]
    );
    // 150 mm is one piece rather than two.
    assert_eq!(class_a().bar_lengths()[1].1, [150.0]);
}
