//! Refusals of references by their readings alone, before any fit.

use super::reference::HeadingReading;
use super::shared_noise::{HeadingPair, check_independence};
use super::variation_check::{Row, check_variation};
use binnacle_compass::angle::TrueHeading;
use binnacle_compass::result::FitError;

/// Checks that no reference of these readings is made of the compass, and that each is a true
/// heading.
///
/// # Errors
/// [`FitError::ReferenceIsCompass`] and [`FitError::VariationMistaken`].
pub fn check_references(readings: &[HeadingReading]) -> Result<(), FitError> {
    type Source = fn(&HeadingReading) -> Option<TrueHeading>;
    let sources: [Source; 3] = [|r| r.gyro, |r| r.satellite, |r| r.unnamed];
    for source in sources {
        let pairs = readings
            .iter()
            .filter_map(|reading| Some(HeadingPair::of_reading(reading, source(reading)?)));
        check_independence(&pairs.collect::<Vec<_>>())?;
        let rows = readings
            .iter()
            .filter_map(|reading| Some(row(reading, source(reading)?)));
        check_variation(rows.collect())?;
    }
    Ok(())
}

/// Returns a reading's row by a reference as it stands.
fn row(reading: &HeadingReading, reference: TrueHeading) -> Row {
    let deviation = (reference - reading.variation) - reading.compass;
    Row {
        compass: reading.compass,
        deviation_deg: deviation.degrees_east(),
        variation: reading.variation,
        h_nt: reading.h_nt,
        z_nt: reading.z_nt,
    }
}
