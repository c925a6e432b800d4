//! Objective of the search: the worst residual with its band on any heading, weighted over
//! the waters, with two bounds for whole families of settings.
//!
//! On one heading, the residual is the angle of a vector that is linear in the magnets'
//! field b. Over a rectangle of b, it is least at a corner, or zero within. For any b, the
//! residuals on two opposite headings together are no better than the soft iron's alone:
//! the two vectors sum to twice it, and the vectors within an angle of north form a convex
//! cone (docs/science.md, §11). The band is that of the soft iron with magnets that leave no
//! B and C; it widens with every corrector that moves and with the error of λ.

use crate::adjust::inputs::Water;
use binnacle_compass::ship::ShipMagnetism;

/// Number of evaluated headings: every 5°.
const HEADINGS: usize = 72;
/// Stride of headings in the bound of a box.
const STRIDE: usize = 3;

/// Band beyond which no plan is acceptable, radians.
const WIDEST_BAND_RAD: f64 = 1.0;

/// A rectangle of horizontal fields, nT.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldBox {
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
}

impl FieldBox {
    /// Returns the longer side, nT.
    pub(crate) fn extent(self) -> f64 {
        (self.x[1] - self.x[0]).max(self.y[1] - self.y[0])
    }
}

/// Sine and cosine of a heading.
#[derive(Clone, Copy)]
struct Direction {
    sin: f64,
    cos: f64,
}

/// East and north parts of a horizontal field, nT.
#[derive(Clone, Copy)]
struct EastNorth {
    east: f64,
    north: f64,
}

/// Headings and their directions, with the model's constant.
pub(crate) struct HeadingGrid {
    /// Directions of the magnetic heading.
    heading: Vec<Direction>,
    /// Directions of the heading plus the constant, which turns the reading.
    read: Vec<Direction>,
}

/// A choice of soft iron in all the waters, to which magnets are added.
pub(crate) struct Objective<'a> {
    compass: &'a HeadingGrid,
    waters: Vec<WaterField>,
}

struct WaterField {
    weight: f64,
    /// East and north parts of the field on all headings, without the magnets, nT.
    fixed: Vec<EastNorth>,
    /// Tangents of the bands on all headings.
    bands: Vec<f64>,
}

impl HeadingGrid {
    pub(crate) fn new(constant_deg: f64) -> HeadingGrid {
        let angles = |turned: f64| {
            let step = std::f64::consts::TAU / HEADINGS as f64;
            (0..HEADINGS)
                .map(|i| Direction::new(i as f64 * step + turned))
                .collect()
        };
        HeadingGrid {
            heading: angles(0.0),
            read: angles(constant_deg.to_radians()),
        }
    }
}

impl<'a> Objective<'a> {
    /// Prepares a choice; `ship_at` gives the ship with this soft iron and without magnets
    /// at a horizontal field, and `band` half the 95 % band on a magnetic heading, radians.
    pub(crate) fn new(
        compass: &'a HeadingGrid,
        waters: &[Water],
        ship_at: impl Fn(f64) -> ShipMagnetism,
        band: impl Fn(&Water, f64) -> f64,
    ) -> Objective<'a> {
        let total: f64 = waters.iter().map(|water| water.weight).sum();
        let counted = waters.iter().filter(|water| water.weight > 0.0);
        let waters = counted.map(|water| {
            let ship = ship_at(water.h_nt);
            let fixed = compass
                .heading
                .iter()
                .zip(&compass.read)
                .map(|(heading, read)| {
                    let earth = [
                        water.h_nt * heading.cos,
                        -water.h_nt * heading.sin,
                        water.z_nt,
                    ];
                    let [x, y, _] = ship.field_at_compass(earth);
                    EastNorth::on_heading(*read, x, y)
                });
            WaterField {
                weight: water.weight / total,
                fixed: fixed.collect(),
                bands: (0..HEADINGS)
                    .map(|i| band(water, i as f64 * std::f64::consts::TAU / HEADINGS as f64))
                    .map(|band| band.min(WIDEST_BAND_RAD).tan())
                    .collect(),
            }
        });
        Objective {
            compass,
            waters: waters.collect(),
        }
    }

    /// Bounds the worst residual and band with any magnets, degrees.
    pub(crate) fn bound_for_iron(&self) -> f64 {
        self.weighted(|water| {
            let half = HEADINGS / 2;
            (0..half)
                .map(|i| {
                    let (one, other) = (water.fixed[i], water.fixed[i + half]);
                    // In the other heading's axes, north and the induced field are turned
                    // by half a circle; b is not, and drops out.
                    let band = water.bands[i].min(water.bands[i + half]);
                    widened(one.plus(other).tangent(), band)
                })
                .fold(0.0, f64::max)
        })
    }

    /// Returns the worst residual and band with magnets of this field, weighted over the
    /// waters, degrees.
    pub(crate) fn reach_deg(&self, b: [f64; 2]) -> f64 {
        self.weighted(|water| {
            let each = water.fixed.iter().zip(&self.compass.read);
            each.zip(&water.bands)
                .map(|((fixed, read), band)| widened(with(*fixed, *read, b).tangent(), *band))
                .fold(0.0, f64::max)
        })
    }

    /// Bounds the worst residual and band with magnets within the box, degrees.
    pub(crate) fn bound_deg(&self, within: &FieldBox) -> f64 {
        self.bound_by(STRIDE, within)
    }

    /// Bounds it by every heading, for small boxes.
    pub(crate) fn fine_bound_deg(&self, within: &FieldBox) -> f64 {
        self.bound_by(1, within)
    }

    fn bound_by(&self, stride: usize, within: &FieldBox) -> f64 {
        self.weighted(|water| {
            let each = water.fixed.iter().zip(&self.compass.read);
            each.zip(&water.bands)
                .step_by(stride)
                .map(|((fixed, read), band)| widened(least_tangent(*fixed, *read, within), *band))
                .fold(0.0, f64::max)
        })
    }

    fn weighted(&self, worst: impl Fn(&WaterField) -> f64) -> f64 {
        let each = self.waters.iter().map(|w| w.weight * worst(w).atan());
        each.sum::<f64>().to_degrees()
    }
}

impl Direction {
    fn new(radians: f64) -> Direction {
        let (sin, cos) = radians.sin_cos();
        Direction { sin, cos }
    }
}

impl EastNorth {
    /// Rotates a field in ship axes to its east and north parts on a heading.
    fn on_heading(Direction { sin, cos }: Direction, x: f64, y: f64) -> EastNorth {
        EastNorth {
            east: x * sin + y * cos,
            north: x * cos - y * sin,
        }
    }

    fn plus(self, other: EastNorth) -> EastNorth {
        EastNorth {
            east: self.east + other.east,
            north: self.north + other.north,
        }
    }

    /// Returns the tangent of the residual; infinite where the card would turn round.
    fn tangent(self) -> f64 {
        if self.north > 0.0 {
            self.east.abs() / self.north
        } else {
            f64::INFINITY
        }
    }
}

/// Returns the tangent of the sum of two angles, given by their tangents; infinite from a
/// right angle on.
fn widened(tangent: f64, band: f64) -> f64 {
    let left = 1.0 - tangent * band;
    if left > 0.0 {
        (tangent + band) / left
    } else {
        f64::INFINITY
    }
}

/// Adds magnets of the field [x, y].
fn with(fixed: EastNorth, read: Direction, [x, y]: [f64; 2]) -> EastNorth {
    fixed.plus(EastNorth::on_heading(read, x, y))
}

fn least_tangent(fixed: EastNorth, read: Direction, within: &FieldBox) -> f64 {
    let Direction { sin, cos } = read;
    let (mid_x, half_x) = (
        f64::midpoint(within.x[0], within.x[1]),
        (within.x[1] - within.x[0]) / 2.0,
    );
    let (mid_y, half_y) = (
        f64::midpoint(within.y[0], within.y[1]),
        (within.y[1] - within.y[0]) / 2.0,
    );
    let east = fixed.east + mid_x * sin + mid_y * cos;
    if east.abs() <= half_x * sin.abs() + half_y * cos.abs() {
        return 0.0;
    }
    let mut least = f64::INFINITY;
    for x in within.x {
        for y in within.y {
            let corner = with(fixed, read, [x, y]);
            if corner.north <= 0.0 {
                return 0.0;
            }
            least = least.min(corner.east.abs() / corner.north);
        }
    }
    least
}
