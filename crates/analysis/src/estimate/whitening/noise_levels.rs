//! How large each kind of noise is, from the data: restricted maximum
//! likelihood with a prior on every level.
//!
//! Restricted, because the unknowns are fitted to the same residuals; with a
//! prior, because a few days cannot show what wanders over weeks.

use super::filter::{Pass, whiten};
use super::likelihood_slopes::{Slopes, slopes};
use crate::estimate::noise_process::LEVELS;
use crate::estimate::rows::{Row, Station, UNKNOWNS};
use binnacle_compass::result::NoiseLevels;
use nalgebra::{SMatrix, SVector};

/// Standard deviations of the levels' logarithms over ships and instruments, in
/// the order of [`NoiseLevels`].
const LOG_SD: [f64; LEVELS] = [0.7, 0.6, 0.6, 0.5, 0.7, 0.5, 0.5, 0.6, 0.7];
/// Steps of the search at most, and how far one may move a level's logarithm.
const STEPS: u32 = 20;
const LARGEST_MOVE: f64 = 0.9;
/// A step that promises no more than this in −2 log likelihood is the last: while the
/// parameters are still rough, and in the end.
const LITTLE_TO_GAIN: f64 = 1.0;
const NOTHING_TO_GAIN: f64 = 0.2;
/// Levels of which the rows tell more than this (twice Fisher's information on the
/// logarithm) are as good as known: what the unknowns' fit takes from the residuals
/// does not matter to them.
const WELL_KNOWN: f64 = 300.0;
/// A step that makes things worse is halved, until it is this small a part.
const SMALLEST_PART: f64 = 0.05;
/// By how much a level's logarithm is moved to see what the unknowns' part in the
/// likelihood does.
const NUDGE: f64 = 0.05;
/// Rows of one stretch when there are too many for all to be looked at.
const STRETCH: usize = 1000;
/// Stretches that are looked at then.
const STRETCHES: usize = 4;

/// What is known of the unknowns beside the rows: information, and its pull at
/// where the rows were taken.
pub(crate) struct Pull {
    pub(crate) information: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    pub(crate) score: SVector<f64, UNKNOWNS>,
}

/// Levels, and what they say of the rows.
pub(crate) struct Found {
    pub(crate) levels: NoiseLevels,
    /// Slopes of the sum of log variance by the levels' logarithms.
    log_variance: [f64; LEVELS],
}

type Logs = SVector<f64, LEVELS>;

/// How well levels are sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sought {
    /// As if the unknowns were known where they are likeliest.
    Roughly,
    /// With what the unknowns' fit takes from the residuals.
    Fairly,
    /// The same, until nothing more is to be gained.
    Well,
}

/// The levels that make the rows likeliest, sought from `levels` by Fisher's scoring.
pub(crate) fn fit_levels(
    stations: &[Station],
    rows: &[Row],
    pull: &Pull,
    typical: &NoiseLevels,
    levels: &NoiseLevels,
    sought: Sought,
) -> Found {
    let search = Search {
        sought,
        stations,
        rows,
        pull,
        typical: logs_of(typical),
        moved: moved(stations, levels),
    };
    search.run(logs_of(levels))
}

struct Search<'a> {
    stations: &'a [Station],
    rows: &'a [Row],
    pull: &'a Pull,
    typical: Logs,
    /// The levels that are sought.
    moved: Vec<usize>,
    sought: Sought,
}

/// What the likelihood is at some levels.
struct Tried {
    logs: Logs,
    objective: f64,
    /// By how much the unknowns differ from where the rows were taken.
    known: [f64; UNKNOWNS],
    log_determinant: f64,
}

impl Search<'_> {
    fn run(&self, logs: Logs) -> Found {
        let mut found = Found {
            levels: levels_of(&logs),
            log_variance: [0.0; LEVELS],
        };
        let Some(mut here) = self.at(logs) else {
            return found;
        };
        let mut unknowns_part = None;
        for _ in 0..STEPS {
            let slopes = self.slopes(&here);
            found.log_variance = slopes.log_variance;
            // It hardly changes on the way.
            let part = unknowns_part.get_or_insert_with(|| self.unknowns_part(&here, &slopes));
            let Some((step, gain)) = self.step(&here, &slopes, part) else {
                break;
            };
            if gain < self.enough() {
                found.levels = levels_of(&(here.logs + step));
                break;
            }
            let Some(next) = self.descend(&here, &step) else {
                break;
            };
            here = next;
            found.levels = levels_of(&here.logs);
        }
        found
    }

    fn enough(&self) -> f64 {
        match self.sought {
            Sought::Roughly | Sought::Fairly => LITTLE_TO_GAIN,
            Sought::Well => NOTHING_TO_GAIN,
        }
    }

    /// None where the information is none.
    fn at(&self, logs: Logs) -> Option<Tried> {
        let pass = self.whiten(&logs);
        let factor = (self.pull.information + pass.information).cholesky()?;
        let score = self.pull.score + pass.score;
        let known = factor.solve(&score);
        let log_determinant = 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
        let far = self.moved.iter().map(|&k| self.far(&logs, k).powi(2));
        Some(Tried {
            logs,
            objective: pass.loss - score.dot(&known) + log_determinant + far.sum::<f64>(),
            known: known.into(),
            log_determinant,
        })
    }

    /// How far from usual a level is, in standard deviations.
    fn far(&self, logs: &Logs, k: usize) -> f64 {
        (logs[k] - self.typical[k]) / LOG_SD[k]
    }

    fn whiten(&self, logs: &Logs) -> Pass {
        whiten(self.stations, self.rows, &levels_of(logs))
    }

    /// Slopes at the unknowns that are likeliest there: moving with the levels, they
    /// add nothing to them.
    fn slopes(&self, here: &Tried) -> Slopes {
        let levels = levels_of(&here.logs);
        slopes(self.stations, self.rows, &levels, &self.moved, &here.known)
    }

    /// Slopes of the log determinant of the unknowns' information, where they matter.
    fn unknowns_part(&self, here: &Tried, slopes: &Slopes) -> Logs {
        let mut part = Logs::zeros();
        if self.sought == Sought::Roughly {
            return part;
        }
        let matters = |k: &&usize| slopes.information[**k][**k] < WELL_KNOWN;
        for &k in self.moved.iter().filter(matters) {
            let mut logs = here.logs;
            logs[k] += NUDGE;
            let information = self.pull.information + self.whiten(&logs).information;
            if let Some(factor) = information.cholesky() {
                let nudged = 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
                part[k] = (nudged - here.log_determinant) / NUDGE;
            }
        }
        part
    }

    /// A step and what it promises to gain.
    fn step(&self, here: &Tried, slopes: &Slopes, unknowns_part: &Logs) -> Option<(Logs, f64)> {
        let mut slope = Logs::from(slopes.loss) + unknowns_part;
        let mut curvature = SMatrix::from(slopes.information);
        for k in 0..LEVELS {
            if self.moved.contains(&k) {
                slope[k] += 2.0 * self.far(&here.logs, k) / LOG_SD[k];
                curvature[(k, k)] += 2.0 / LOG_SD[k].powi(2);
            } else {
                slope[k] = 0.0;
                curvature[(k, k)] = 1.0;
            }
        }
        let step = -curvature.cholesky()?.solve(&slope);
        let gain = -0.5 * step.dot(&slope);
        let largest = step.amax().max(LARGEST_MOVE);
        Some((step * (LARGEST_MOVE / largest), gain))
    }

    /// As much of a step as makes things better.
    fn descend(&self, here: &Tried, step: &Logs) -> Option<Tried> {
        let mut part = 1.0;
        while part > SMALLEST_PART {
            let next = self.at(here.logs + step * part);
            if let Some(next) = next.filter(|next| next.objective < here.objective) {
                return Some(next);
            }
            part /= 2.0;
        }
        None
    }
}

/// A level of zero (its logarithm is not finite) stays zero, and one that no row
/// shows stays what it usually is.
fn moved(stations: &[Station], levels: &NoiseLevels) -> Vec<usize> {
    let gyro = stations.iter().any(Station::reads_gyro);
    let satellite = stations.iter().any(Station::reads_satellite);
    let both = stations.iter().any(Station::reads_both);
    let shown = [true, gyro, gyro, gyro, true, true, true, satellite, both];
    let levels = levels.to_array();
    (0..LEVELS)
        .filter(|&k| shown[k] && levels[k] > 0.0)
        .collect()
}

fn logs_of(levels: &NoiseLevels) -> Logs {
    Logs::from(levels.to_array().map(f64::ln))
}

fn levels_of(logs: &Logs) -> NoiseLevels {
    NoiseLevels::from_array(std::array::from_fn(|k| logs[k].exp()))
}

impl Found {
    /// What part of the rows' noise is the compass's, of what tells rows apart: the
    /// trace of V⁻¹ V_compass over that of V⁻¹ V, where V is the noise's covariance.
    ///
    /// A row taken at a heading with so much of the reference in it has a residual
    /// that its slopes know nothing of; with any other, errors in the heading would
    /// lean on the fit.
    pub(crate) fn compass_share(&self, stations: &[Station], of_white: f64) -> f64 {
        let [white, _, _, _, swing, ..] = self.log_variance;
        let sum = |of: fn(&Station) -> f64| stations.iter().map(of).sum::<f64>();
        let by_level = self.levels.white_deg.powi(2) * sum(|s| s.white.factor);
        // What scatters is white as well, and the card's.
        let scatter = white * sum(|s| s.white.scatter) / by_level.max(f64::MIN_POSITIVE);
        // By the logarithm of the variance, which is twice the level's.
        let twice = of_white * white + scatter + swing;
        (twice / (2.0 * stations.len() as f64)).clamp(0.0, 1.0)
    }
}

/// Which of `rows` rows are looked at: evenly spread stretches; none where it is all.
pub(crate) fn looked_at(rows: usize) -> Option<impl Iterator<Item = usize>> {
    if rows <= STRETCH * STRETCHES {
        return None;
    }
    let spacing = (rows - STRETCH) / (STRETCHES - 1);
    Some((0..STRETCHES).flat_map(move |i| i * spacing..i * spacing + STRETCH))
}
