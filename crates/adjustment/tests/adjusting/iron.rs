//! True effects of correctors, each a little off the catalogue's.

use super::random::Random;
use binnacle_adjustment::binnacle::{Axis, Binnacle, Setting, Side, Tray};

type Vector = [f64; 3];

/// Number of small dipoles in a magnet.
const PARTS: usize = 12;
/// 10⁻⁷ tesla in nT.
const MU: f64 = 100.0;

/// Every corrector on board with its own error, by standard deviations of the design.
pub(crate) struct Fitted {
    binnacle: Binnacle,
    /// Relative error of each magnet, by axis.
    moments: [Vec<f64>; 2],
    /// Error of each hole's height, mm, by axis.
    heights_mm: [Vec<f64>; 2],
    bucket: f64,
    /// Error of each size's pair.
    pairs: Vec<f64>,
    bar: f64,
    pub(crate) needle_am2: f64,
    /// Share of the stated moment that all magnets except the heeling ones have.
    pub(crate) lot_share: f64,
}

impl Fitted {
    pub(crate) fn new(rng: &mut Random, binnacle: &Binnacle) -> Fitted {
        let sd = binnacle.design.magnets[0].moment_tolerance;
        let mut axis = |axis: Axis| {
            let rack = binnacle.design.rack(axis);
            let moments = (0..16).map(|_| sd * rng.gaussian()).collect::<Vec<f64>>();
            let holes = rack
                .holes
                .iter()
                .map(|_| rack.position_sd_mm * rng.gaussian());
            (moments, holes.collect::<Vec<f64>>())
        };
        let (one, other) = (axis(Axis::ForeAndAft), axis(Axis::Athwartship));
        let iron = binnacle.design.quadrantal.as_ref().unwrap();
        let bar_sd = binnacle
            .design
            .flinders
            .as_ref()
            .map_or(0.0, |bar| bar.tolerance);
        Fitted {
            binnacle: binnacle.clone(),
            moments: [one.0, other.0],
            heights_mm: [one.1, other.1],
            bucket: sd * rng.gaussian(),
            pairs: iron
                .sizes
                .iter()
                .map(|s| s.tolerance * rng.gaussian())
                .collect(),
            bar: bar_sd * rng.gaussian(),
            needle_am2: binnacle.design.needle_moment_am2,
            lot_share: 1.0,
        }
    }

    /// Field of all correctors at the card in the earth's field, nT.
    pub(crate) fn field(&self, setting: &Setting, earth: Vector) -> Vector {
        let magnets = self.dipoles(setting);
        let direct = |at: Vector| {
            magnets.iter().fold([0.0; 3], |sum, (from, m)| {
                add(sum, dipole(*m, less(at, *from)))
            })
        };
        let mut sum = direct([0.0; 3]);
        if let Some((strength, n, r)) = self.pair(setting) {
            for side in [1.0, -1.0] {
                let at = n.map(|part| side * r * part);
                let met = add(earth, direct(at));
                // A sphere's dipole, in units with MU of one.
                let induced = met.map(|part| strength / MU * part);
                sum = add(sum, dipole(induced, at.map(|part| -part)));
            }
        }
        if let Some(bar) = self.bar_of(setting) {
            sum = add(sum, bar.field(earth, &direct));
        }
        sum
    }

    /// Field induced in the spheres by the needles, nT, for this direction of the card's
    /// north.
    pub(crate) fn of_needles(&self, setting: &Setting, card: [f64; 2]) -> [f64; 2] {
        let Some((strength, n, r)) = self.pair(setting) else {
            return [0.0; 2];
        };
        let needles = [card[0] * self.needle_am2, card[1] * self.needle_am2, 0.0];
        let mut sum = [0.0; 3];
        for side in [1.0, -1.0] {
            let at = n.map(|part| side * r * part);
            let met = dipole(needles, at);
            let induced = met.map(|part| strength / MU * part);
            sum = add(sum, dipole(induced, at.map(|part| -part)));
        }
        [sum[0], sum[1]]
    }

    fn dipoles(&self, setting: &Setting) -> Vec<(Vector, Vector)> {
        let mut all = Vec::new();
        for (index, axis) in Axis::BOTH.into_iter().enumerate() {
            let mut magnet = 0;
            for tray in setting.trays(axis) {
                for side in 0..tray.count {
                    all.extend(self.magnet(index, axis, tray, magnet, side));
                    magnet += 1;
                }
            }
        }
        let design = &self.binnacle.design;
        if let (Some(set), Some(bucket)) = (&setting.heeling, &design.heeling) {
            let kind = design.magnet(&bucket.magnet).unwrap();
            let place = bucket
                .positions
                .iter()
                .find(|p| p.number == set.position)
                .unwrap();
            let down = set.red.sign() * f64::from(set.count) * kind.moment_am2;
            let moment = [0.0, 0.0, down * (1.0 + self.bucket)];
            let middle = [0.0, 0.0, place.below_card_mm / 1e3];
            all.extend(row(middle, moment, kind.length_mm / 1e3));
        }
        all
    }

    fn magnet(
        &self,
        index: usize,
        axis: Axis,
        tray: &Tray,
        magnet: usize,
        side: u8,
    ) -> Vec<(Vector, Vector)> {
        let design = &self.binnacle.design;
        let rack = design.rack(axis);
        let kind = design.magnet(&tray.magnet).unwrap();
        let hole = rack.hole(tray.hole).unwrap();
        let height = hole.below_card_mm + self.heights_mm[index][usize::from(tray.hole) - 1];
        let off = rack.off_centre_mm / 1e3 * if side.is_multiple_of(2) { 1.0 } else { -1.0 };
        let own = self.lot_share * (1.0 + self.moments[index][magnet % 16]);
        let size = tray.red.sign() * kind.moment_am2 * own;
        let (middle, moment) = match axis {
            Axis::ForeAndAft => ([0.0, off, height / 1e3], [size, 0.0, 0.0]),
            Axis::Athwartship => ([off, 0.0, height / 1e3], [0.0, size, 0.0]),
        };
        row(middle, moment, kind.length_mm / 1e3)
    }

    /// a³κ of each sphere, the vector to one of them, and its distance.
    fn pair(&self, setting: &Setting) -> Option<(f64, Vector, f64)> {
        let set = setting.quadrantal.as_ref()?;
        let iron = self.binnacle.design.quadrantal.as_ref()?;
        let which = iron.sizes.iter().position(|size| size.name == set.size)?;
        let mark = iron
            .marks
            .iter()
            .find(|m| (m.mark_mm - set.mark_mm).abs() < 1e-6)?;
        let radius = iron.sizes[which].diameter_mm / 2e3;
        let slew = set.slew_deg.to_radians();
        let strength = 0.985 * radius.powi(3) * (1.0 + self.pairs[which]);
        Some((
            strength,
            [-slew.sin(), slew.cos(), 0.0],
            mark.centre_mm / 1e3,
        ))
    }

    fn bar_of(&self, setting: &Setting) -> Option<TrueBar> {
        let set = setting.flinders.as_ref()?;
        let holder = self.binnacle.design.flinders.as_ref()?;
        let side = if set.side == Side::Forward { 1.0 } else { -1.0 };
        Some(TrueBar {
            length: set.length_mm / 1e3,
            diameter: holder.diameter_mm / 1e3,
            ahead: side * holder.axis_mm / 1e3,
            share: 1.0 + self.bar,
        })
    }
}

struct TrueBar {
    length: f64,
    diameter: f64,
    /// Forward of the card, metres.
    ahead: f64,
    share: f64,
}

impl TrueBar {
    fn field(&self, earth: Vector, magnets: &impl Fn(Vector) -> Vector) -> Vector {
        let volume = std::f64::consts::PI * self.diameter.powi(2) / 4.0 * self.length;
        let steps = 20;
        let at = |i: i32| {
            let down = self.length * ((f64::from(i) + 0.5) / f64::from(steps) - 1.0 / 12.0);
            [self.ahead, 0.0, down]
        };
        let mean = (0..steps).map(|i| magnets(at(i))[2]).sum::<f64>() / f64::from(steps);
        // A pole of strength m/ℓ at the card's height and its opposite below.
        let along = demagnetising(self.length / self.diameter) + 6e-4;
        let poles = 5.0 / 6.0 * self.length;
        let strength = self.share * volume / along / (4.0 * std::f64::consts::PI) / poles;
        let strength = strength * (earth[2] + mean);
        let pole = |at: Vector, sign: f64| {
            let from = at.map(|part| -part);
            let distance = norm(from);
            from.map(|part| sign * strength * part / distance.powi(3))
        };
        let mut sum = add(
            pole([self.ahead, 0.0, 0.0], -1.0),
            pole([self.ahead, 0.0, poles], 1.0),
        );
        // Induction across the bar, as a string of dipoles.
        let across = (1.0 - demagnetising(self.length / self.diameter)) / 2.0 + 6e-4;
        let each = self.share * volume / f64::from(steps) / across / (4.0 * std::f64::consts::PI);
        let moment = [earth[0] * each / MU, earth[1] * each / MU, 0.0];
        for i in 0..steps {
            sum = add(sum, dipole(moment, at(i).map(|part| -part)));
        }
        sum
    }
}

/// Linear interpolation between logarithms of the printed values.
fn demagnetising(ratio: f64) -> f64 {
    let known = [
        (1.0_f64, 0.27_f64),
        (2.0, 0.141),
        (3.0, 0.0922),
        (4.0, 0.0664),
        (6.0, 0.0402),
        (8.0, 0.0275),
    ];
    for pair in known.windows(2) {
        let ((r0, n0), (r1, n1)) = (pair[0], pair[1]);
        if (r0..=r1 + 1e-9).contains(&ratio) {
            let t = (ratio.ln() - r0.ln()) / (r1.ln() - r0.ln());
            return (n0.ln() + t * (n1.ln() - n0.ln())).exp();
        }
    }
    panic!("no bar is {ratio} times as long as thick");
}

/// A magnet as a row of small dipoles.
fn row(middle: Vector, moment: Vector, length: f64) -> Vec<(Vector, Vector)> {
    let size = norm(moment);
    (0..PARTS)
        .map(|i| {
            let along = length * ((i as f64 + 0.5) / PARTS as f64 - 0.5);
            let at = std::array::from_fn(|axis| middle[axis] + along * moment[axis] / size);
            (at, moment.map(|part| part / PARTS as f64))
        })
        .collect()
}

/// The field of a dipole, nT, at a place seen from it.
fn dipole(moment: Vector, at: Vector) -> Vector {
    let distance = norm(at);
    let unit = at.map(|part| part / distance);
    let along: f64 = moment.iter().zip(unit).map(|(m, u)| m * u).sum();
    std::array::from_fn(|axis| MU * (3.0 * along * unit[axis] - moment[axis]) / distance.powi(3))
}

fn add(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|axis| a[axis] + b[axis])
}

fn less(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn norm(a: Vector) -> f64 {
    a.iter().map(|part| part * part).sum::<f64>().sqrt()
}
