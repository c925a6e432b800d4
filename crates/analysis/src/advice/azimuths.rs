//! Effect of azimuths: they alone show the reference's own constant error.

use super::knowledge::{Knowledge, SECTORS, Slope, Waters};
use super::question::NOTICEABLE_DEG;
use binnacle_compass::result::AzimuthAdvice;

/// Standard error of an azimuth, degrees: a bearing by azimuth circle read to 0.6°, and the
/// circle's tilt of 0.6° at an altitude of 30°.
const STANDARD_ERROR_DEG: f64 = 0.7;
/// Number of azimuths of the larger effect: about one a day for three weeks.
const MANY: usize = 20;

/// Returns the effect of one azimuth and of twenty on the band here; none where it is hardly
/// noticed.
pub(super) fn azimuth_advice(known: &Knowledge, own: &[Slope; SECTORS]) -> Option<AzimuthAdvice> {
    let waters = Waters::new(own.to_vec());
    let open = known.with_reference();
    let after = |sectors: &mut dyn Iterator<Item = usize>| {
        let mut learnt = open.clone();
        for sector in sectors {
            learnt.learn(&(own[sector] / STANDARD_ERROR_DEG));
        }
        learnt.band(&waters)
    };
    let band = open.band(&waters);
    let after_one = (0..SECTORS)
        .map(|sector| after(&mut std::iter::once(sector)))
        .max_by(|a, b| a.rms_deg.total_cmp(&b.rms_deg))?;
    let after_twenty = after(&mut (0..MANY).map(|nth| nth * SECTORS / MANY));
    (band.rms_deg - after_twenty.rms_deg >= NOTICEABLE_DEG).then_some(AzimuthAdvice {
        standard_error_deg: STANDARD_ERROR_DEG,
        band,
        after_one,
        after_twenty,
    })
}
