//! Ranking of candidates: the sectors of heading here, and the bands of magnetic latitude
//! with the best three headings in each.

use super::knowledge::{Knowledge, SECTORS, Slope, Visit, Waters, slopes};
use super::question::{AdviceError, NOTICEABLE_DEG, Question};
use super::ranges::{Ends, ranges};
use super::watch::{WATCHES, errors_of_watches};
use binnacle_compass::coverage::{
    Coverage, HEADING_STEP_DEG, MAGNETIC_LATITUDE_STEP_DEG, magnetic_latitude_band_deg,
};
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::result::{Advice, Band, HeadingRange, HeadingSuggestion, LatitudeSuggestion};
use binnacle_compass::ship::EarthField;

/// Bands of magnetic latitude that ships sail in, by their southern edges.
const SAILED_DEG: std::ops::RangeInclusive<i16> = -60..=50;
/// Horizontal field of the dipole at its equator, nT (IGRF-14, 2025: √(g₁₀² + g₁₁² +
/// h₁₁²)); the vertical field at its pole is twice that.
const DIPOLE_NT: f64 = 29_700.0;

/// Returns the other waters in which the band is to be narrow; none where headings are
/// ambiguous in all of those that were not asked for by name.
pub(super) fn waters_elsewhere(question: &Question<'_>) -> Result<Option<Waters>, DeviationError> {
    let mut all: Vec<Slope> = Vec::new();
    for earth in question.elsewhere {
        all.extend(slopes(question.model, *earth)?);
    }
    if question.elsewhere.is_empty() {
        let own = magnetic_latitude_band_deg(question.here.h_nt, question.here.z_nt);
        for (_, earth) in sailed(question.coverage).filter(|(from, _)| *from != own) {
            all.extend(slopes(question.model, earth).into_iter().flatten());
        }
    }
    Ok((!all.is_empty()).then(|| Waters::new(all)))
}

/// Returns the bands of magnetic latitude, from south to north, with the field in the
/// middle of the data there, or of a dipole where there are none.
fn sailed(coverage: &Coverage) -> impl Iterator<Item = (i16, EarthField)> + '_ {
    let step = MAGNETIC_LATITUDE_STEP_DEG;
    SAILED_DEG.step_by(step as usize).map(move |from| {
        let with_data = coverage.bands.iter().find(|band| {
            band.magnetic_latitude_from_deg == from && coverage.magnetic_latitude_step_deg == step
        });
        let earth = with_data.map_or_else(
            || {
                let (sin, cos) = (f64::from(from) + f64::from(step) / 2.0)
                    .to_radians()
                    .sin_cos();
                EarthField {
                    h_nt: DIPOLE_NT * cos,
                    z_nt: 2.0 * DIPOLE_NT * sin,
                }
            },
            |band| EarthField {
                h_nt: f64::midpoint(band.h_nt_from, band.h_nt_to),
                z_nt: f64::midpoint(band.z_nt_from, band.z_nt_to),
            },
        );
        (from, earth)
    })
}

pub(super) fn heading_advice(
    question: &Question<'_>,
    known: &Knowledge,
    own: &[Slope; SECTORS],
) -> Result<Advice<HeadingSuggestion>, AdviceError> {
    let waters = Waters::new(own.to_vec());
    let fresh = visit(question, known, question.here)?;
    let gains: Vec<f64> = own.iter().map(|slope| fresh.gain(slope, &waters)).collect();
    let suggestions = ranges(&gains, Ends::Joined).into_iter().map(|run| {
        let outcomes = run.iter().map(|&sector| {
            let mut visit = fresh.clone();
            bands_after(&mut visit, [&own[sector]; WATCHES], &waters)
        });
        let (after_one, after_three) = worst_of(outcomes);
        HeadingSuggestion {
            range: heading_range(&run),
            after_one,
            after_three,
        }
    });
    Ok(advice(known, &waters, suggestions, |s| s.after_three))
}

pub(super) fn latitude_advice(
    question: &Question<'_>,
    known: &Knowledge,
    waters: &Waters,
) -> Result<Advice<LatitudeSuggestion>, AdviceError> {
    let mut visits = Vec::new();
    for (from, earth) in sailed(question.coverage) {
        // Where headings are ambiguous nothing can be observed.
        let Ok(there) = slopes(question.model, earth) else {
            continue;
        };
        let best = best_visit(visit(question, known, earth)?, &there, waters);
        visits.push((from, best));
    }
    let now = known.band(waters).rms_deg;
    let gains: Vec<f64> = visits
        .iter()
        .map(|(_, best)| now - best.after_three.rms_deg)
        .collect();
    let suggestions = ranges(&gains, Ends::Apart).into_iter().map(|run| {
        let peak = run
            .iter()
            .copied()
            .max_by(|&a, &b| gains[a].total_cmp(&gains[b]));
        let peak = &visits[peak.expect("a range is not empty")].1;
        let (after_one, after_three) = worst_of(
            run.iter()
                .map(|&at| (visits[at].1.after_one, visits[at].1.after_three)),
        );
        LatitudeSuggestion {
            magnetic_latitude_from_deg: visits[run[0]].0,
            magnetic_latitude_to_deg: visits[run[run.len() - 1]].0 + MAGNETIC_LATITUDE_STEP_DEG,
            headings: peak
                .sectors
                .iter()
                .map(|&sector| heading_range(&[sector]))
                .collect(),
            after_one,
            after_three,
        }
    });
    Ok(advice(known, waters, suggestions, |s| s.after_three))
}

fn advice<S>(
    known: &Knowledge,
    waters: &Waters,
    suggestions: impl Iterator<Item = S>,
    after_three: impl Fn(&S) -> Band,
) -> Advice<S> {
    let band = known.band(waters);
    Advice {
        band,
        narrows_at_most_deg: (band.rms_deg - known.floor_deg()).max(0.0),
        suggestions: suggestions
            .filter(|s| band.rms_deg - after_three(s).rms_deg >= NOTICEABLE_DEG)
            .collect(),
    }
}

fn visit(
    question: &Question<'_>,
    known: &Knowledge,
    earth: EarthField,
) -> Result<Visit, AdviceError> {
    let errors = errors_of_watches(question.noise, question.gyro_share, earth);
    Visit::new(known, errors).ok_or(AdviceError::NotNoise)
}

/// Headings of a visit, each the best after those before, and their effect.
struct BestVisit {
    sectors: [usize; WATCHES],
    after_one: Band,
    after_three: Band,
}

fn best_visit(mut visit: Visit, slopes: &[Slope; SECTORS], waters: &Waters) -> BestVisit {
    let mut planned = visit.clone();
    let sectors = [(); WATCHES].map(|()| {
        let gains = slopes.iter().map(|slope| planned.gain(slope, waters));
        let (best, _) = gains
            .enumerate()
            .fold((0, f64::NEG_INFINITY), |best, (sector, gain)| {
                if gain > best.1 { (sector, gain) } else { best }
            });
        planned.watch(&slopes[best]);
        best
    });
    let (after_one, after_three) = bands_after(&mut visit, sectors.map(|s| &slopes[s]), waters);
    BestVisit {
        sectors,
        after_one,
        after_three,
    }
}

/// Returns the band after the first and after the last of some watches.
fn bands_after(visit: &mut Visit, watches: [&Slope; WATCHES], waters: &Waters) -> (Band, Band) {
    let after = watches.map(|slope| {
        visit.watch(slope);
        visit.knowledge.band(waters)
    });
    (after[0], after[WATCHES - 1])
}

/// Returns the widest bands of some outcomes.
fn worst_of(outcomes: impl Iterator<Item = (Band, Band)>) -> (Band, Band) {
    let wider = |a: Band, b: Band| Band {
        rms_deg: a.rms_deg.max(b.rms_deg),
        worst_deg: a.worst_deg.max(b.worst_deg),
    };
    outcomes
        .reduce(|a, b| (wider(a.0, b.0), wider(a.1, b.1)))
        .expect("a range is not empty")
}

/// Returns the range of neighbouring sectors in their order.
fn heading_range(run: &[usize]) -> HeadingRange {
    if run.len() == SECTORS {
        return HeadingRange {
            heading_from_deg: 0,
            heading_to_deg: 360,
        };
    }
    HeadingRange {
        heading_from_deg: run[0] as u16 * HEADING_STEP_DEG,
        heading_to_deg: (run[run.len() - 1] as u16 + 1) * HEADING_STEP_DEG,
    }
}
