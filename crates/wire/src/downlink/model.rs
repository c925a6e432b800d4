//! A model in a compact response: parameters as they are, the covariance by its
//! standard errors and the Cholesky factor of its correlations.
//!
//! The factor's rows have length 1. Each rounded entry therefore changes the
//! standard error of a deviation by no more than 2⁻¹⁶ of a parameter's own
//! share in it. This holds also where the large shares of two parameters all
//! but cancel; rounding the covariance itself would not.

use super::fields::{read_time, read_withdrawn, write_time, write_withdrawn};
use crate::codec::bits::{BitReader, BitWriter};
use crate::messages::ModelDownlink;
use binnacle_compass::model::{Covariance, Identifiable, Model, Parameters, ReferenceGrade};
use uuid::Uuid;

const HAS_REPLACES: u64 = 1;
const HAS_COVARIANCE: u64 = 2;
const HAS_IDENTIFIABLE: u64 = 4;
const HAS_RMS: u64 = 8;
/// Grade of course over ground; an earlier agent passes over it.
const BY_COURSE: u64 = 16;
/// Seven parameters and the constant.
const COUNT: usize = 8;
/// Value of an entry of 1 in the factor.
const ONE: f64 = 32_767.0;
const THOUSANDTHS_PER_DEG: f64 = 1_000.0;
/// The greatest distance from 1 that rounding leaves in a correlation with
/// itself; anything further away was not a covariance.
const SLACK: f64 = 1e-4;
/// The largest credible residual.
const RMS_MAX_DEG: f64 = 180.0;

/// Writes the part; `None` when a number is not finite or out of range, or when the model has
/// the needles' part of D and E, which this form does not carry.
pub(super) fn encode(sent: &ModelDownlink) -> Option<Vec<u8>> {
    let model = &sent.model;
    if model.needles.is_some() {
        return None;
    }
    let mut writer = BitWriter::default();
    writer.bytes(sent.id.as_bytes());
    writer.varint(u64::from(sent.version));
    write_time(&mut writer, sent.data_until)?;
    let flag = |present: bool, flag| if present { flag } else { 0 };
    let flags = flag(sent.replaces.is_some(), HAS_REPLACES)
        | flag(model.covariance.is_some(), HAS_COVARIANCE)
        | flag(model.identifiable.is_some(), HAS_IDENTIFIABLE)
        | flag(model.rms_deg.is_some(), HAS_RMS)
        | flag(!model.reference_grade.is_heading(), BY_COURSE);
    writer.varint(flags);
    if let Some(replaces) = &sent.replaces {
        write_withdrawn(&mut writer, replaces)?;
    }
    writer.varint(model.samples_used);
    writer.varint(model.samples_rejected);
    for value in values(&model.parameters_over_lambda, model.constant_deg) {
        write_float(&mut writer, value)?;
    }
    if let Some(covariance) = &model.covariance {
        write_covariance(&mut writer, covariance)?;
    }
    if let Some(identifiable) = model.identifiable {
        let bits = identifiable_flags(identifiable);
        let byte = (0..COUNT).fold(0, |byte, i| byte | (u64::from(bits[i]) << i));
        writer.bits(byte, 8);
    }
    if let Some(rms_deg) = model.rms_deg {
        if !(0.0..=RMS_MAX_DEG).contains(&rms_deg) {
            return None;
        }
        writer.varint((rms_deg * THOUSANDTHS_PER_DEG).round() as u64);
    }
    Some(writer.into_bytes())
}

/// Reads the bytes of [`encode`]; fields that a later server appended are
/// ignored.
pub(super) fn read(reader: &mut BitReader<'_>) -> Option<ModelDownlink> {
    let id = Uuid::from_u64_pair(reader.bits(64).ok()?, reader.bits(64).ok()?);
    let version = u32::try_from(reader.varint().ok()?).ok()?;
    let data_until = read_time(reader)?;
    let flags = reader.varint().ok()?;
    let replaces = match flags & HAS_REPLACES {
        0 => None,
        _ => Some(read_withdrawn(reader)?),
    };
    let (samples_used, samples_rejected) = (reader.varint().ok()?, reader.varint().ok()?);
    let mut numbers = [0.0; COUNT];
    for number in &mut numbers {
        *number = read_float(reader)?;
    }
    let covariance = match flags & HAS_COVARIANCE {
        0 => None,
        _ => Some(read_covariance(reader)?),
    };
    let identifiable = match flags & HAS_IDENTIFIABLE {
        0 => None,
        _ => Some(identifiable(reader.bits(8).ok()?)),
    };
    let rms_deg = match flags & HAS_RMS {
        0 => None,
        _ => Some(reader.varint().ok()? as f64 / THOUSANDTHS_PER_DEG),
    };
    if rms_deg.is_some_and(|rms| rms > RMS_MAX_DEG) {
        return None;
    }
    let [
        bx_nt,
        chi13,
        by_nt,
        chi23,
        chi11_minus_chi22,
        chi12,
        chi21,
        constant_deg,
    ] = numbers;
    let parameters_over_lambda = Parameters {
        bx_nt,
        chi13,
        by_nt,
        chi23,
        chi11_minus_chi22,
        chi12,
        chi21,
    };
    Some(ModelDownlink {
        id,
        version,
        data_until,
        replaces,
        model: Model {
            parameters_over_lambda,
            constant_deg,
            covariance,
            identifiable,
            rms_deg,
            samples_used,
            samples_rejected,
            quality: None,
            reference_grade: match flags & BY_COURSE {
                0 => ReferenceGrade::Heading,
                _ => ReferenceGrade::CourseOverGround,
            },
            mean_h_nt: None,
            needles: None,
        },
    })
}

fn values(p: &Parameters, constant_deg: f64) -> [f64; COUNT] {
    [
        p.bx_nt,
        p.chi13,
        p.by_nt,
        p.chi23,
        p.chi11_minus_chi22,
        p.chi12,
        p.chi21,
        constant_deg,
    ]
}

fn identifiable_flags(of: Identifiable) -> [bool; COUNT] {
    [
        of.bx_nt,
        of.chi13,
        of.by_nt,
        of.chi23,
        of.chi11_minus_chi22,
        of.chi12,
        of.chi21,
        of.constant_deg,
    ]
}

fn identifiable(byte: u64) -> Identifiable {
    let known = |index: u32| byte >> index & 1 == 1;
    Identifiable {
        bx_nt: known(0),
        chi13: known(1),
        by_nt: known(2),
        chi23: known(3),
        chi11_minus_chi22: known(4),
        chi12: known(5),
        chi21: known(6),
        constant_deg: known(7),
    }
}

fn write_float(writer: &mut BitWriter, value: f64) -> Option<()> {
    let single = value as f32;
    if !single.is_finite() {
        return None;
    }
    writer.bytes(&single.to_le_bytes());
    Some(())
}

fn read_float(reader: &mut BitReader<'_>) -> Option<f64> {
    let bytes: [u8; 4] = reader.bytes(4).ok()?.try_into().ok()?;
    let single = f32::from_le_bytes(bytes);
    single.is_finite().then_some(f64::from(single))
}

fn write_covariance(writer: &mut BitWriter, covariance: &Covariance) -> Option<()> {
    let mut errors = [0.0; COUNT];
    for (index, error) in errors.iter_mut().enumerate() {
        // Rounding may make the variance of an exactly known parameter
        // negative.
        *error = covariance[index][index].max(0.0).sqrt();
        write_float(writer, *error)?;
    }
    for (index, row) in factor(covariance, &errors).iter().enumerate() {
        let length: f64 = row.iter().map(|entry| entry * entry).sum();
        let is_sound = errors[index] == 0.0 || (length - 1.0).abs() < SLACK;
        if !is_sound {
            return None;
        }
        for entry in &row[..=index] {
            writer.bytes(&((entry * ONE).round() as i16).to_le_bytes());
        }
    }
    Some(())
}

/// The lower Cholesky factor of the correlations.
fn factor(covariance: &Covariance, errors: &[f64; COUNT]) -> [[f64; COUNT]; COUNT] {
    let mut factor = [[0.0; COUNT]; COUNT];
    for row in 0..COUNT {
        for column in 0..=row {
            let scale = errors[row] * errors[column];
            if scale == 0.0 {
                continue;
            }
            let known: f64 = (0..column)
                .map(|k| factor[row][k] * factor[column][k])
                .sum();
            let left = covariance[row][column] / scale - known;
            factor[row][column] = if column == row {
                left.max(0.0).sqrt()
            } else if factor[column][column] > 0.0 {
                left / factor[column][column]
            } else {
                0.0
            };
        }
    }
    factor
}

fn read_covariance(reader: &mut BitReader<'_>) -> Option<Covariance> {
    let mut errors = [0.0; COUNT];
    for error in &mut errors {
        *error = read_float(reader)?;
    }
    let mut factor = [[0.0; COUNT]; COUNT];
    for (index, row) in factor.iter_mut().enumerate() {
        for entry in &mut row[..=index] {
            let bytes: [u8; 2] = reader.bytes(2).ok()?.try_into().ok()?;
            *entry = f64::from(i16::from_le_bytes(bytes)) / ONE * errors[index];
        }
    }
    let mut covariance = [[0.0; COUNT]; COUNT];
    for (row, of_row) in factor.iter().enumerate() {
        for (column, of_column) in factor.iter().enumerate() {
            covariance[row][column] = of_row.iter().zip(of_column).map(|(a, b)| a * b).sum();
        }
    }
    Some(covariance)
}
