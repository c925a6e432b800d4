//! Spherical harmonic synthesis, regular at the poles.
//!
//! Schmidt quasi-normalised Legendre functions of order 1 and up are divided by sin θ, Q =
//! P/sin θ, so that no term of the sum is ever divided by it (docs/science.md, eq. 1–3).
//! The outer loop runs over orders, the inner over degrees. Each recursion keeps three
//! numbers.

use super::Field;
use super::coefficients::{MAX_DEGREE, TERMS, Terms, term_index};
use crate::position::Position;
use std::sync::LazyLock;

/// WGS 84 equatorial radius, metres (NGA.STND.0036).
const EQUATOR_M: f64 = 6_378_137.0;
/// WGS 84 flattening.
const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// The models' reference sphere, metres.
const REFERENCE_M: f64 = 6_371_200.0;

/// Factors of the recursions, functions of degree and order alone.
struct Factors {
    /// (2n + 1)/√((n + 1)² − m²), from n to n + 1.
    cosine: [f64; TERMS],
    /// √(n² − m²)/√((n + 1)² − m²), from n to n + 1.
    before: [f64; TERMS],
    /// √(n² − m²)
    root: [f64; TERMS],
    /// √((2m − 1)/2m), from one diagonal to the next; 1 for m = 1.
    diagonal: [f64; MAX_DEGREE + 1],
}

static FACTORS: LazyLock<Factors> = LazyLock::new(|| {
    let mut factors = Factors {
        cosine: [0.0; TERMS],
        before: [0.0; TERMS],
        root: [0.0; TERMS],
        diagonal: [1.0; MAX_DEGREE + 1],
    };
    for order in 0..=MAX_DEGREE {
        let m = order as f64;
        if order > 1 {
            factors.diagonal[order] = ((2.0 * m - 1.0) / (2.0 * m)).sqrt();
        }
        for degree in order..=MAX_DEGREE {
            let n = degree as f64;
            let index = term_index(degree, order);
            let root = (n * n - m * m).sqrt();
            factors.root[index] = root;
            let next_root = ((n + 1.0).powi(2) - m * m).sqrt();
            factors.cosine[index] = (2.0 * n + 1.0) / next_root;
            factors.before[index] = root / next_root;
        }
    }
    factors
});

/// A geodetic position seen from the earth's centre.
struct Geocentric {
    /// Reference radius over distance from the centre.
    ratio: f64,
    /// Sine and cosine of the colatitude.
    sin: f64,
    cos: f64,
    /// Sine and cosine of geocentric less geodetic latitude.
    tilt_sin: f64,
    tilt_cos: f64,
}

impl Geocentric {
    fn new(lat_deg: f64, altitude_m: f64) -> Geocentric {
        let (lat_sin, lat_cos) = lat_deg.to_radians().sin_cos();
        let eccentricity = FLATTENING * (2.0 - FLATTENING);
        let normal = EQUATOR_M / (1.0 - eccentricity * lat_sin * lat_sin).sqrt();
        let from_axis = (normal + altitude_m) * lat_cos;
        let from_equator = (normal * (1.0 - eccentricity) + altitude_m) * lat_sin;
        let distance = from_axis.hypot(from_equator);
        let (sin, cos) = (from_axis / distance, from_equator / distance);
        Geocentric {
            ratio: REFERENCE_M / distance,
            sin,
            cos,
            tilt_sin: cos * lat_cos - sin * lat_sin,
            tilt_cos: sin * lat_cos + cos * lat_sin,
        }
    }
}

/// Computes the field at a place; finite for every position.
pub(super) fn synthesise(terms: &Terms, position: Position, altitude_m: f64) -> Field {
    let place = Geocentric::new(position.lat_deg(), altitude_m);
    let (north, east, down) = geocentric_field(terms, &place, position.lon_deg());
    Field {
        x_nt: north * place.tilt_cos - down * place.tilt_sin,
        y_nt: east,
        z_nt: north * place.tilt_sin + down * place.tilt_cos,
    }
}

/// Sums north, east and down in the geocentric frame.
fn geocentric_field(terms: &Terms, at: &Geocentric, lon_deg: f64) -> (f64, f64, f64) {
    let factors = &*FACTORS;
    // (a/r)^(n+2) for each degree.
    let mut powers = [0.0; MAX_DEGREE + 1];
    let mut power = at.ratio * at.ratio;
    for slot in &mut powers {
        *slot = power;
        power *= at.ratio;
    }

    let (mut north, down_zonal) = zonal(terms, factors, at, &powers);
    let (mut east, mut down) = (0.0, down_zonal);

    let (lon_sin, lon_cos) = lon_deg.to_radians().sin_cos();
    let (mut sin_m, mut cos_m) = (0.0, 1.0);
    let mut q_diagonal = 1.0;
    for order in 1..=MAX_DEGREE {
        (sin_m, cos_m) = (
            sin_m * lon_cos + cos_m * lon_sin,
            cos_m * lon_cos - sin_m * lon_sin,
        );
        if order > 1 {
            q_diagonal *= factors.diagonal[order] * at.sin;
        }
        let (mut q_before, mut q) = (0.0, q_diagonal);
        let range = term_index(order, order)..=term_index(MAX_DEGREE, order);
        let rows = terms.g[range.clone()]
            .iter()
            .zip(&terms.h[range.clone()])
            .zip(&factors.cosine[range.clone()])
            .zip(&factors.before[range.clone()])
            .zip(&factors.root[range])
            .zip(&powers[order..]);
        let mut n = order as f64;
        let (mut north_m, mut east_m, mut down_m) = (0.0, 0.0, 0.0);
        for (((((g, h), cosine), before), root), power) in rows {
            let in_phase = power * (g * cos_m + h * sin_m);
            let across = power * (g * sin_m - h * cos_m);
            // dP/dθ, which is n cos θ Q(n) − √(n² − m²) Q(n − 1).
            north_m += in_phase * (n * at.cos * q - root * q_before);
            east_m += across * q;
            n += 1.0;
            down_m += in_phase * n * q;
            let next = cosine * at.cos * q - before * q_before;
            q_before = q;
            q = next;
        }
        north += north_m;
        east += order as f64 * east_m;
        down -= at.sin * down_m;
    }
    (north, east, down)
}

/// Sums the terms of order 0, whose functions have no factor sin θ: north and down parts.
fn zonal(
    terms: &Terms,
    factors: &Factors,
    at: &Geocentric,
    powers: &[f64; MAX_DEGREE + 1],
) -> (f64, f64) {
    let (mut north, mut down) = (0.0, 0.0);
    let (mut p_before, mut p) = (0.0, 1.0);
    // The slope P′ = dP/d(cos θ) has its own regular recursion,
    // P′(n) = cos θ P′(n − 1) + n P(n − 1), and dP/dθ = −sin θ P′.
    let mut slope = 0.0;
    for (degree, power) in powers.iter().enumerate().skip(1) {
        let n = degree as f64;
        let index = term_index(degree, 0);
        slope = at.cos * slope + n * p;
        let next = factors.cosine[index - 1] * at.cos * p - factors.before[index - 1] * p_before;
        p_before = p;
        p = next;
        let strength = power * terms.g[index];
        north -= strength * at.sin * slope;
        down -= strength * (n + 1.0) * p;
    }
    (north, down)
}
