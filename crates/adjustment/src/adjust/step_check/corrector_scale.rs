//! Scale of a corrector's effect that explains the observed turn of the compass.
//!
//! Invariants: a scale belongs to the corrector and not to its place: to all magnets of a
//! kind in every hole, to a pair at every mark, to the bar's pieces at every length, for
//! formulas and calibrations alike. An implausible scale is rejected.

use crate::adjust::diagnosis::turn_sd_deg;
use crate::adjust::inputs::{AdjustError, Adjustment};
use crate::adjust::instructions::{Place, Step, compass_turn};
use crate::adjust::state::MagneticState;
use crate::binnacle::{
    BarSetting, Binnacle, BinnacleForm, Calibrated, PairSetting, Side, Soft, Tray,
};
use crate::corrector::Iron;
use std::ops::RangeInclusive;

/// Range of the search for a scale.
const SEARCH_RANGE: RangeInclusive<f64> = 0.1..=5.0;
/// Least scale of magnets, which lose strength with time.
const MIN_MAGNET_SCALE: f64 = 0.3;
/// Greatest gain of measured magnets, or more for a larger measurement error; magnets gain
/// no strength.
const MAX_GAIN_MEASURED: f64 = 0.25;
/// Greatest gain of magnets with only a catalogue's moment, which may be of another make.
const MAX_GAIN_NOMINAL: f64 = 1.0;
/// Least accepted change of soft iron, or more for a larger tolerance of its kind.
const MIN_IRON_SPREAD: f64 = 0.2;
/// Greatest plausible difference of a corrector, in standard deviations of its kind.
const PLAUSIBLE_SD: f64 = 5.0;
/// Least standard deviation of a turn used for a scale, degrees: two readings, and errors
/// of neighbouring correctors.
const MIN_TURN_SD_DEG: f64 = 0.5;
/// Convergence of the search, degrees.
const CONVERGED_DEG: f64 = 0.02;

/// Scale with its standard error, and the binnacle with the scaled corrector.
pub(crate) struct CorrectorScale {
    pub(crate) share: f64,
    pub(crate) share_sd: f64,
    pub(crate) binnacle: Binnacle,
}

/// Finds the scale of the step's corrector that explains the turn; none where no plausible
/// scale does.
pub(crate) fn find_scale(
    adjustment: &Adjustment<'_>,
    step: &Step,
    turned_deg: f64,
) -> Result<Option<CorrectorScale>, AdjustError> {
    let place = step.to.as_ref().or(step.from.as_ref());
    let Some(can_be) = place.and_then(|place| plausible_scales(adjustment.binnacle, place)) else {
        return Ok(None);
    };
    if !step.seen {
        return Ok(None);
    }
    let read_sd_deg = MIN_TURN_SD_DEG.max(turn_sd_deg(adjustment.earth.h_nt));
    let share_sd = (read_sd_deg / step.change_deg.abs()).min(0.5);
    let change = |share: f64| -> Result<Option<(f64, Binnacle)>, AdjustError> {
        let binnacle =
            place.and_then(|place| scale_corrector(adjustment.binnacle, place, share, share_sd));
        let Some(binnacle) = binnacle else {
            return Ok(None);
        };
        let state = MagneticState::new(&Adjustment {
            binnacle: &binnacle,
            ..adjustment.clone()
        })?;
        let (before, after) = (&step.setting_before, &step.setting_after);
        let turn = compass_turn(adjustment, &state, before, after);
        Ok(Some((turn.change_deg, binnacle)))
    };
    let mut known = (1.0, step.change_deg);
    let mut share = turned_deg / step.change_deg;
    for _ in 0..8 {
        if !SEARCH_RANGE.contains(&share) {
            return Ok(None);
        }
        let Some((found, binnacle)) = change(share)? else {
            return Ok(None);
        };
        if (found - turned_deg).abs() < CONVERGED_DEG {
            return Ok(can_be.contains(&share).then_some(CorrectorScale {
                share,
                share_sd,
                binnacle,
            }));
        }
        let slope = (found - known.1) / (share - known.0);
        known = (share, found);
        share += (turned_deg - found) / slope;
    }
    Ok(None)
}

/// Returns the plausible scales of a corrector.
fn plausible_scales(binnacle: &Binnacle, place: &Place) -> Option<RangeInclusive<f64>> {
    let design = &binnacle.design;
    match place {
        Place::Magnets(tray) => {
            let kind = design.magnet(&tray.magnet)?;
            let is_tested = binnacle
                .lot(&kind.name)
                .is_some_and(|lot| lot.tested_moment_am2.is_some());
            let is_calibrated = binnacle.calibration.iter().any(
                |entry| matches!(entry, Calibrated::Magnet { magnet, .. } if *magnet == kind.name),
            );
            let least = if is_tested || is_calibrated {
                MAX_GAIN_MEASURED
            } else {
                MAX_GAIN_NOMINAL
            };
            let more = least.max(PLAUSIBLE_SD * binnacle.moment(kind).sd);
            Some(MIN_MAGNET_SCALE..=1.0 + more)
        }
        Place::Pair(pair) => {
            let sizes = &design.quadrantal.as_ref()?.sizes;
            let size = sizes.iter().find(|size| size.name == pair.size)?;
            let measured = binnacle.calibrated_pair(&pair.size, pair.mark_mm);
            Some(iron_scales(
                measured.map_or(size.tolerance, |known| known.sd),
            ))
        }
        Place::Bar(bar) => {
            let holder = design.flinders.as_ref()?;
            let measured = binnacle.calibrated_bar(bar.length_mm);
            Some(iron_scales(
                measured.map_or(holder.tolerance, |known| known.sd),
            ))
        }
        Place::Bucket(_) => None,
    }
}

fn iron_scales(sd: f64) -> RangeInclusive<f64> {
    let more = MIN_IRON_SPREAD.max(PLAUSIBLE_SD * sd);
    1.0 - more.min(1.0 - MIN_MAGNET_SCALE)..=1.0 + more
}

/// Scales a corrector at all its places.
fn scale_corrector(binnacle: &Binnacle, place: &Place, share: f64, sd: f64) -> Option<Binnacle> {
    match place {
        Place::Magnets(tray) => scale_magnets(binnacle, tray, share, sd),
        Place::Pair(pair) => scale_pairs(binnacle, pair, share, sd),
        Place::Bar(_) => scale_bars(binnacle, share, sd),
        Place::Bucket(_) => None,
    }
}

fn scale_magnets(binnacle: &Binnacle, tray: &Tray, share: f64, sd: f64) -> Option<Binnacle> {
    let kind = binnacle.design.magnet(&tray.magnet)?;
    let moment_am2 = binnacle.moment(kind).am2 * share;
    let weighed = binnacle.with_moment(&kind.name, moment_am2, sd).ok()?;
    let mut form: BinnacleForm = weighed.into();
    let bucket = form.design.heeling.as_ref();
    let is_of_bucket = bucket.is_some_and(|bucket| bucket.magnet == kind.name);
    for entry in &mut form.calibration {
        match entry {
            Calibrated::Magnet {
                magnet,
                field_nt,
                sd: entry_sd,
                ..
            } if *magnet == kind.name => {
                *field_nt *= share;
                *entry_sd = sd;
            }
            Calibrated::Heeling { field_nt, .. } if is_of_bucket => *field_nt *= share,
            _ => {}
        }
    }
    Binnacle::try_from(form).ok()
}

fn scale_pairs(binnacle: &Binnacle, pair: &PairSetting, share: f64, sd: f64) -> Option<Binnacle> {
    let marks = &binnacle.design.quadrantal.as_ref()?.marks;
    let at_marks = marks.iter().filter_map(|mark| {
        let soft = Soft {
            quadrantal: Some(PairSetting {
                mark_mm: mark.mark_mm,
                ..pair.clone()
            }),
            flinders: None,
        };
        let found = Iron::new(binnacle, &soft).pair?;
        Some(Calibrated::Quadrantal {
            size: pair.size.clone(),
            mark_mm: mark.mark_mm,
            q: found.q() * share,
            sd,
        })
    });
    with_calibration(binnacle, at_marks.collect())
}

fn scale_bars(binnacle: &Binnacle, share: f64, sd: f64) -> Option<Binnacle> {
    let of_lengths = binnacle.bar_lengths().into_iter().filter_map(|(of_mm, _)| {
        let soft = Soft {
            quadrantal: None,
            flinders: Some(BarSetting {
                length_mm: of_mm,
                side: Side::Forward,
                slew_deg: 0.0,
            }),
        };
        let found = Iron::new(binnacle, &soft).bar?;
        Some(Calibrated::Flinders {
            length_mm: of_mm,
            c: found.c() * share,
            sd,
        })
    });
    with_calibration(binnacle, of_lengths.collect())
}

/// Replaces the calibration of these correctors.
fn with_calibration(binnacle: &Binnacle, entries: Vec<Calibrated>) -> Option<Binnacle> {
    let mut form: BinnacleForm = binnacle.clone().into();
    form.calibration
        .retain(|old| !entries.iter().any(|entry| entry.same_place(old)));
    form.calibration.extend(entries);
    Binnacle::try_from(form).ok()
}
