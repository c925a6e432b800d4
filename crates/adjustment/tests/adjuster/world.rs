//! A compass among magnets and iron, in the world's axes: north, east, down.
//!
//! The ship's own axes are three vectors that turn with it. Every pole and sphere has its
//! place along them, and the card is horizontal with its north along the sum of all fields.
//! Nothing here comes from the crate.

use std::collections::BTreeMap;

pub(crate) type Vector = [f64; 3];

/// A ship without correctors: field of its hard iron, and field of its soft iron for the
/// earth's field along each of its axes; forward, starboard, down, nT.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ship {
    pub(crate) hard_nt: Vector,
    pub(crate) soft: [Vector; 3],
}

/// Correctors in the binnacle, as an observer would note them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Binnacle {
    /// Magnets by the hole's axis, `forward` or `starboard`, and by hole: number and
    /// direction of the red ends.
    pub(crate) magnets: BTreeMap<(&'static str, u16), (u8, String)>,
    /// Distance of the spheres' centres, m, and slew of the starboard one aft, degrees.
    pub(crate) spheres: Option<(f64, f64)>,
    /// Length of the bar, m, and its position, degrees clockwise from forward.
    pub(crate) bar: Option<(f64, f64)>,
    /// Position, number and red ends.
    pub(crate) bucket: Option<(u16, u8, String)>,
}

/// Properties of the correctors.
#[derive(Clone, Debug)]
pub(crate) struct Hardware {
    pub(crate) moment_am2: f64,
    pub(crate) length_m: f64,
    /// Depths of the holes, m, by number less one: fore-and-aft, athwartship, bucket.
    pub(crate) depths_m: [Vec<f64>; 3],
    pub(crate) sphere_radius_m: f64,
    pub(crate) bar_axis_m: f64,
    /// χ13 by the bar's length, mm, from its calibration.
    pub(crate) bar_c: BTreeMap<u32, f64>,
}

/// Attitude of the ship: magnetic heading, and heel to starboard, degrees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lying {
    pub(crate) magnetic_deg: f64,
    pub(crate) heel_deg: f64,
}

impl Lying {
    /// Axes of the ship in the world: forward, starboard, down.
    fn axes(self) -> [Vector; 3] {
        let (east, north) = self.magnetic_deg.to_radians().sin_cos();
        let (sin, cos) = self.heel_deg.to_radians().sin_cos();
        let level = [-east, north, 0.0];
        // Heeled to starboard, the starboard side points down.
        let starboard = sum(&[scaled(level, cos), [0.0, 0.0, sin]]);
        let down = sum(&[scaled(level, -sin), [0.0, 0.0, cos]]);
        [[north, east, 0.0], starboard, down]
    }
}

/// Compass heading, degrees, in the earth's field: horizontal and down.
pub(crate) fn compass_deg(
    ship: &Ship,
    binnacle: &Binnacle,
    hardware: &Hardware,
    earth: (f64, f64),
    lying: Lying,
) -> f64 {
    let [north, east, _] = field(ship, binnacle, hardware, [earth.0, 0.0, earth.1], lying);
    // North on the card is the field's direction; the bow's angle counts from there.
    (lying.magnetic_deg - east.atan2(north).to_degrees()).rem_euclid(360.0)
}

/// Field at the card along the ship's axes, nT, as a magnetometer measures it.
pub(crate) fn read(
    ship: &Ship,
    binnacle: &Binnacle,
    hardware: &Hardware,
    earth: Vector,
    lying: Lying,
) -> Vector {
    let field = field(ship, binnacle, hardware, earth, lying);
    lying.axes().map(|axis| dot(field, axis))
}

fn field(
    ship: &Ship,
    binnacle: &Binnacle,
    hardware: &Hardware,
    earth: Vector,
    lying: Lying,
) -> Vector {
    let axes = lying.axes();
    let of_ship = |along: Vector| {
        let parts: Vec<Vector> = (0..3).map(|i| scaled(axes[i], along[i])).collect();
        sum(&parts)
    };
    let mut all = vec![earth, of_ship(ship.hard_nt)];
    for (axis, induced) in axes.into_iter().zip(ship.soft) {
        all.push(scaled(of_ship(induced), dot(earth, axis)));
    }
    let poles = poles(binnacle, hardware, &axes);
    let of_magnets = |at: Vector| {
        let each: Vec<Vector> = poles.iter().map(|p| of_pole(*p, at)).collect();
        sum(&each)
    };
    all.push(of_magnets([0.0; 3]));
    if let Some((distance_m, aft_deg)) = binnacle.spheres {
        let (aft, abeam) = aft_deg.to_radians().sin_cos();
        let starboard_one = of_ship([-distance_m * aft, distance_m * abeam, 0.0]);
        for at in [starboard_one, scaled(starboard_one, -1.0)] {
            let met = sum(&[earth, of_magnets(at)]);
            let size = 0.985 * hardware.sphere_radius_m.powi(3);
            all.push(of_dipole(scaled(met, size), at));
        }
    }
    if let Some((length_m, clockwise_deg)) = binnacle.bar {
        let (right, ahead) = clockwise_deg.to_radians().sin_cos();
        let axis_m = hardware.bar_axis_m;
        let at = |down: f64| of_ship([axis_m * ahead, axis_m * right, down]);
        let along = (0..60).map(|i| length_m * ((f64::from(i) + 0.5) / 60.0 - 1.0 / 12.0));
        let of_magnets: f64 = along.map(|d| dot(of_magnets(at(d)), axes[2]) / 60.0).sum();
        let met_nt = dot(earth, axes[2]) + of_magnets;
        let (d, l) = (hardware.bar_axis_m, length_m * 5.0 / 6.0);
        let c = hardware.bar_c[&((length_m * 1e3).round() as u32)];
        let pole = c / (1.0 / (d * d) - d / (d * d + l * l).powf(1.5));
        // A field that points down makes the lower end north-seeking. The upper end, level
        // with the card, attracts the card's north.
        all.push(of_pole((at(0.0), -pole * met_nt), [0.0; 3]));
        all.push(of_pole((at(l), pole * met_nt), [0.0; 3]));
    }
    sum(&all)
}

/// Poles of all magnets: place from the card, m, and strength in nT m², red positive.
fn poles(binnacle: &Binnacle, hardware: &Hardware, axes: &[Vector; 3]) -> Vec<(Vector, f64)> {
    let mut all = Vec::new();
    let mut magnet = |depth_m: f64, count: u8, red: &str| {
        let towards = match red {
            "forward" => axes[0],
            "aft" => scaled(axes[0], -1.0),
            "starboard" => axes[1],
            "port" => scaled(axes[1], -1.0),
            "up" => scaled(axes[2], -1.0),
            "down" => axes[2],
            other => panic!("no red end points {other:?}"),
        };
        let middle = scaled(axes[2], depth_m);
        let half = scaled(towards, hardware.length_m / 2.0);
        let strength = 100.0 * hardware.moment_am2 / hardware.length_m * f64::from(count);
        all.push((sum(&[middle, half]), strength));
        all.push((sum(&[middle, scaled(half, -1.0)]), -strength));
    };
    for ((axis, hole), (count, red)) in &binnacle.magnets {
        let rack = usize::from(*axis == "starboard");
        magnet(hardware.depths_m[rack][usize::from(*hole) - 1], *count, red);
    }
    if let Some((position, count, red)) = &binnacle.bucket {
        magnet(
            hardware.depths_m[2][usize::from(*position) - 1],
            *count,
            red,
        );
    }
    all
}

/// Lines of force leave a red pole.
fn of_pole((from, strength): (Vector, f64), at: Vector) -> Vector {
    let way = sum(&[at, scaled(from, -1.0)]);
    scaled(way, strength * dot(way, way).powf(-1.5))
}

/// At the card, of a dipole at a place, in units in which its field is 1/r³.
fn of_dipole(moment: Vector, at: Vector) -> Vector {
    let r = dot(at, at).sqrt();
    let unit = scaled(at, 1.0 / r);
    let along = scaled(unit, 3.0 * dot(moment, unit));
    scaled(sum(&[along, scaled(moment, -1.0)]), r.powi(-3))
}

fn sum(all: &[Vector]) -> Vector {
    std::array::from_fn(|axis| all.iter().map(|part| part[axis]).sum())
}

fn scaled(vector: Vector, by: f64) -> Vector {
    vector.map(|part| by * part)
}

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}
