//! Effects of the logbook on an analysis.

use super::*;

#[test]
fn an_adjustment_begins_an_epoch_and_cargo_is_left_out() {
    let logbook = [
        LogbookEntry {
            from: time(5000),
            to: None,
            kind: LogbookKind::Adjustment,
            cargo: None,
            note: "new magnets".into(),
        },
        LogbookEntry {
            from: time(100),
            to: Some(time(995)),
            kind: LogbookKind::MagneticCargo,
            cargo: None,
            note: String::new(),
        },
        LogbookEntry {
            from: time(300),
            to: None,
            kind: LogbookKind::Note,
            cargo: None,
            note: String::new(),
        },
    ];
    let analysis = analyse_with(&voyage(), &logbook, &AnalysisSettings::default());
    assert_eq!(analysis.epochs.len(), 2);
    assert_eq!(analysis.epochs[0].to, Some(time(5000)));
    assert_eq!(analysis.epochs[1].from, Some(time(5000)));
    assert_eq!(analysis.epochs[1].data_from, Some(time(5000)));
    assert_eq!(analysis.epochs[1].begun_by, Some(LogbookKind::Adjustment));
    let left_out = analysis
        .samples
        .iter()
        .filter(|s| s.reason == Some(SampleReason::MagneticCargo))
        .count();
    assert_eq!(left_out, 90);
    assert!(
        analysis
            .samples
            .iter()
            .all(|s| s.used == s.reason.is_none())
    );
}

/// Makes an entry for a stretch of the voyage, in minutes.
fn entry(kind: LogbookKind, from: i64, to: Option<i64>) -> LogbookEntry {
    LogbookEntry {
        from: time(from),
        to: to.map(time),
        kind,
        cargo: None,
        note: String::new(),
    }
}

fn left_out_for(logbook: &[LogbookEntry], reason: SampleReason) -> usize {
    let analysis = analyse_with(&voyage(), logbook, &AnalysisSettings::default());
    let samples = analysis.samples.iter();
    samples.filter(|s| s.reason == Some(reason)).count()
}

#[test]
fn cargo_and_berth_leave_out_the_samples_of_their_time_once_however_they_overlap() {
    let logbook = [
        entry(LogbookKind::MagneticCargo, 3000, Some(3990)),
        entry(LogbookKind::MagneticCargo, 3500, Some(4490)),
        entry(LogbookKind::Berth, 2500, Some(3490)),
        entry(LogbookKind::Berth, -600, Some(-10)),
    ];
    let mut reversed = logbook.to_vec();
    reversed.reverse();
    for logbook in [&logbook[..], &reversed] {
        assert_eq!(left_out_for(logbook, SampleReason::MagneticCargo), 150);
        assert_eq!(left_out_for(logbook, SampleReason::Berth), 50);
    }
}

#[test]
fn cargo_goes_on_until_it_is_discharged_but_a_berth_only_until_she_sails() {
    let open = [entry(LogbookKind::MagneticCargo, 9000, None)];
    assert_eq!(left_out_for(&open, SampleReason::MagneticCargo), 100);
    let open = [entry(LogbookKind::Berth, 9000, None)];
    assert_eq!(left_out_for(&open, SampleReason::Berth), 0, "at 14 knots");
    let mut samples = voyage();
    for (sample, sog_kn) in samples[990..].iter_mut().zip([None, Some(0.3)]) {
        sample.sog_kn = sog_kn;
    }
    let analysis = analyse_with(&samples, &open, &AnalysisSettings::default());
    let reasons: Vec<_> = analysis.samples[989..993]
        .iter()
        .map(|s| s.reason)
        .collect();
    let berth = Some(SampleReason::Berth);
    assert_eq!(reasons, [None, berth, berth, None]);
}

#[test]
fn work_on_ship_or_compass_opens_an_epoch_and_a_blow_does_not() {
    use LogbookKind as K;
    let opens = |kind| {
        let logbook = [entry(kind, 5000, None)];
        analyse_with(&voyage()[400..600], &logbook, &AnalysisSettings::default())
            .epochs
            .len()
            == 2
    };
    for kind in [
        K::Adjustment,
        K::CorrectorChange,
        K::CompassMoved,
        K::Repair,
        K::DryDocking,
        K::Welding,
        K::Degaussing,
    ] {
        assert!(opens(kind), "{kind:?}");
    }
    for kind in [K::Lightning, K::Shock, K::MagneticCargo, K::Berth, K::Note] {
        assert!(!opens(kind), "{kind:?}");
    }
}

#[test]
fn an_adjustment_before_the_first_sample_costs_none() {
    let logbook = [entry(LogbookKind::Adjustment, -1000, None)];
    let analysis = analyse_with(&voyage(), &logbook, &AnalysisSettings::default());
    let model = analysis.current_epoch().unwrap().model.as_ref().unwrap();
    assert_eq!(model.samples_used, 1000);
}

#[test]
fn an_entry_is_read_as_it_always_was_and_refused_where_it_cannot_be() {
    let read = |json: &str| serde_json::from_str::<LogbookEntry>(json);
    let plain = r#"{"from":"2026-03-01T00:00:00Z","kind":"magnetic_cargo"}"#;
    let expected = entry(LogbookKind::MagneticCargo, 0, None);
    assert_eq!(read(plain).unwrap(), expected);
    let back = serde_json::to_string(&expected).unwrap();
    assert_eq!(read(&back).unwrap(), expected);
    let steel = r#"{"from":"2026-03-01T00:00:00Z","kind":"magnetic_cargo","cargo":"steel"}"#;
    assert_eq!(read(steel).unwrap().cargo, Some(Cargo::Steel));

    let refusal = |json: &str| read(json).unwrap_err().to_string();
    let turned = plain.replace("kind", r#"to":"2026-02-28T00:00:00Z","kind"#);
    let reported = refusal(&turned);
    assert!(
        reported.starts_with("to: 2026-02-28T00:00:00Z is before from"),
        "{reported}"
    );
    let reported = refusal(&steel.replace("magnetic_cargo", "shock"));
    assert!(reported.starts_with("cargo: "), "{reported}");
    assert!(read(&plain.replace("magnetic_cargo", "ufo")).is_err());
}

#[test]
fn after_a_repair_what_was_learnt_before_still_counts() {
    // A year in both hemispheres, then a few hours in one place.
    let samples: Vec<Sample> = voyage()
        .into_iter()
        .filter(|s| s.time < time(9000))
        .collect();
    let few: Vec<Sample> = (0..60_i32)
        .map(|i| sample(9000 + 10 * i64::from(i), 30.0, f64::from(i * 47 % 360)))
        .collect();
    let all: Vec<Sample> = samples.iter().chain(&few).copied().collect();
    let repair = LogbookEntry {
        from: time(9000),
        to: None,
        kind: LogbookKind::Repair,
        cargo: None,
        note: String::new(),
    };
    let moved = LogbookEntry {
        kind: LogbookKind::CompassMoved,
        ..repair.clone()
    };
    let chi13_sd = |entry: &LogbookEntry| {
        let analysis = analyse_with(
            &all,
            std::slice::from_ref(entry),
            &AnalysisSettings::default(),
        );
        analysis.epochs[1]
            .model
            .as_ref()
            .unwrap()
            .covariance
            .unwrap()[1][1]
            .sqrt()
    };
    assert!(chi13_sd(&repair) < 0.6 * chi13_sd(&moved));
}
