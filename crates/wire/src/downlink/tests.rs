use super::*;
use crate::messages::{CardWithdrawn, ModelDownlink};
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::model::{Covariance, Model};
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use proptest::prelude::*;
use serde_json::json;

/// The range of ships' parameters and constants, and of their worst standard
/// errors.
const SPREAD: [f64; 8] = [3000.0, 0.1, 3000.0, 0.1, 0.1, 0.02, 0.02, 3.0];

fn at(text: &str) -> Timestamp {
    Timestamp::parse(text).unwrap()
}

/// A model of eight numbers from −1 to 1, scaled to parameters and a constant.
fn model(of: [f64; 8], covariance: Option<&Covariance>) -> Model {
    let names = [
        "bx_nt",
        "chi13",
        "by_nt",
        "chi23",
        "chi11_minus_chi22",
        "chi12",
        "chi21",
    ];
    let scaled = |i: usize| json!(of[i] * SPREAD[i]);
    let parameters: serde_json::Map<_, _> =
        (0..7).map(|i| (names[i].to_owned(), scaled(i))).collect();
    let json = json!({
        "parameters_over_lambda": parameters, "constant_deg": scaled(7),
        "covariance": covariance, "rms_deg": 0.523, "samples_used": 2875,
        "samples_rejected": 14,
        "identifiable": {
            "bx_nt": false, "chi13": false, "by_nt": true, "chi23": true,
            "chi11_minus_chi22": true, "chi12": false, "chi21": false, "constant_deg": false,
        },
    });
    serde_json::from_value(json).unwrap()
}

/// A covariance with standard errors of a tenth of the spread at most. Its bx
/// and χ13, its by and χ23, and its A and the constant are all but perfectly
/// correlated.
fn covariance(factor: &[f64]) -> Covariance {
    let mut rows = [[0.0; 8]; 8];
    for (row, drawn) in rows.iter_mut().zip(factor.chunks(8)) {
        row.copy_from_slice(drawn);
    }
    for (row, spread) in rows.iter_mut().zip(SPREAD) {
        *row = row.map(|part| part * spread / 30.0);
    }
    for (known, bound) in [(0, 1), (2, 3)] {
        let known = rows[known];
        for (bound, known) in rows[bound].iter_mut().zip(known) {
            *bound = 0.001 * *bound - known / 40_000.0;
        }
    }
    let mut covariance = [[0.0; 8]; 8];
    for (i, a) in rows.iter().enumerate() {
        for (j, b) in rows.iter().enumerate() {
            covariance[i][j] = a.iter().zip(b).map(|(a, b)| a * b).sum();
        }
    }
    covariance
}

fn sent(model: Model) -> Downlink {
    Downlink {
        contiguous_seq: 12,
        model: Some(ModelDownlink {
            id: Uuid::from_u128(0x0193_4f2a_7c00_7000_8000_0000_0000_002a),
            version: 41,
            data_until: at("2026-11-20T00:00:05Z"),
            replaces: Some(CardWithdrawn {
                since: at("2026-11-02T00:00:00Z"),
                reason: "lightning_or_shock".to_owned(),
            }),
            model,
        }),
        unread: None,
        card_withdrawn: None,
        settings: None,
        server_time: at("2026-11-21T07:00:00Z"),
    }
}

proptest! {
    #[test]
    fn the_decoded_card_is_the_card_sent(
        of in prop::array::uniform8(-1.0..1.0_f64),
        factor in prop::collection::vec(-1.0..1.0_f64, 64),
        h_nt in 15_000.0..40_000.0_f64,
        z_nt in -60_000.0..60_000.0_f64,
    ) {
        let original = model(of.map(|part| part / 3.0), Some(&covariance(&factor)));
        let bytes = encode(&sent(original.clone())).unwrap();
        let decoded = decode(&bytes).unwrap().model.unwrap().model;
        for degrees in (0..360).step_by(10) {
            let compass = CompassHeading::new(f64::from(degrees)).unwrap();
            let earth = EarthField { h_nt, z_nt };
            let original = original.deviation(compass, earth).unwrap();
            let decoded = decoded.deviation(compass, earth).unwrap();
            let difference = original.deviation.degrees_east() - decoded.deviation.degrees_east();
            prop_assert!(difference.abs() < 0.001, "{difference}");
            let bands = original.band95_deg.unwrap() - decoded.band95_deg.unwrap();
            prop_assert!(bands.abs() < 0.005, "{bands}");
        }
    }

    #[test]
    fn any_bytes_are_decoded_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        decode(&bytes).ok();
        let mut sealed = [&MAGIC[..], &[FORM], &bytes].concat();
        sealed.extend(crc32fast::hash(&sealed).to_le_bytes());
        decode(&sealed).ok();
    }

    #[test]
    fn a_damaged_response_is_never_read(at in 0_usize..200, flip in 1_u8..=255) {
        let whole = encode(&sent(model([0.1; 8], None))).unwrap();
        let mut bytes = whole.clone();
        let at = at % bytes.len();
        bytes[at] ^= flip;
        prop_assert!(decode(&bytes).is_err());
        prop_assert!(decode(&whole[..at]).is_err());
    }
}

#[test]
fn a_response_comes_back_as_it_was_sent() {
    let mut downlink = sent(model([0.25; 8], None));
    let parameters = &mut downlink.model.as_mut().unwrap().model;
    // Numbers that single precision holds exactly.
    parameters.parameters_over_lambda = decode(&encode(&sent(parameters.clone())).unwrap())
        .unwrap()
        .model
        .unwrap()
        .model
        .parameters_over_lambda;
    downlink.settings = Some(Settings {
        version: 3,
        ..Settings::default()
    });
    downlink.card_withdrawn = Some(CardWithdrawn {
        since: at("2026-11-20T00:00:00Z"),
        reason: "corrector_change".to_owned(),
    });
    assert_eq!(decode(&encode(&downlink).unwrap()), Ok(downlink.clone()));
    downlink.model = None;
    downlink.settings = None;
    downlink.card_withdrawn = None;
    let bare = encode(&downlink).unwrap();
    assert_eq!(decode(&bare), Ok(downlink));
    assert_eq!(bare.len(), 13);
}

#[test]
fn a_whole_model_fits_into_two_hundred_bytes() {
    let mut downlink = sent(model([0.25; 8], Some(&covariance(&[0.5; 64]))));
    assert!(encode(&downlink).unwrap().len() < 230);
    downlink.model.as_mut().unwrap().replaces = None;
    let bytes = encode(&downlink).unwrap().len();
    assert!(bytes < 200, "{bytes}");
}

#[test]
fn parts_of_a_later_server_are_skipped() {
    let downlink = sent(model([0.25; 8], None));
    let whole = encode(&downlink).unwrap();
    let mut longer = whole[..whole.len() - CHECKSUM_BYTES].to_vec();
    longer.extend([77, 3, 1, 2, 3]);
    longer.extend(crc32fast::hash(&longer).to_le_bytes());
    assert_eq!(decode(&longer), decode(&whole));
}

#[test]
fn a_model_is_named_by_the_end_of_its_id() {
    let id: Uuid = "01934f2a-7c00-7000-8000-0000000a002b".parse().unwrap();
    assert_eq!(card_tag(id), "000a002b");
}

#[test]
fn a_later_form_and_other_bytes_have_their_own_errors() {
    let mut later = [&MAGIC[..], &[FORM + 1, 9, 9, 9]].concat();
    later.extend(crc32fast::hash(&later).to_le_bytes());
    assert_eq!(decode(&later), Err(DecodeError::Form(2)));
    assert_eq!(decode(b"<html>"), Err(DecodeError::BadMagic));
    assert_eq!(decode(b"BD"), Err(DecodeError::Damaged));
}

#[test]
fn a_model_with_nan_or_no_covariance_is_not_encoded() {
    let mut no_number = model([0.25; 8], None);
    no_number.parameters_over_lambda.bx_nt = f64::NAN;
    assert_eq!(encode(&sent(no_number)), None);
    let mut impossible = covariance(&[0.5; 64]);
    impossible[0][1] *= -3.0;
    impossible[1][0] *= -3.0;
    assert_eq!(encode(&sent(model([0.25; 8], Some(&impossible)))), None);
}
