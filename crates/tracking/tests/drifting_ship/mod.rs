//! Ships without gyro and satellite compass, in tidal streams, ocean currents and wind.
//!
//! The generator shares nothing with the analysis but the earth's field: the ship's needle
//! follows Poisson's equations, her motion is a sum of vectors, and her leeway is the balance
//! of wind on hull and water under it.

use binnacle_compass::angle::{CompassHeading, CourseOverGround, wrap_180};
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Time between samples, seconds.
const STEP_S: f64 = 600.0;
/// Period of the semidiurnal tide, seconds.
const TIDE_S: f64 = 12.42 * 3600.0;
/// Turn of a ship at sea in one sample, degrees.
const TURN_DEG: f64 = 150.0;

/// Plan of a simulated voyage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    pub(crate) days: f64,
    /// Day on which the compass is turned in its seat, and the angle, degrees.
    pub(crate) realigned: Option<(f64, f64)>,
    /// True for a ship that never has way on.
    pub(crate) drifts: bool,
}

/// Simulated ship with her samples.
pub(crate) struct Voyage {
    pub(crate) samples: Vec<Sample>,
    ship: Ship,
    h_nt: f64,
    z_nt: f64,
}

/// Ship's magnetism: permanent field, Poisson's coefficients, and the compass's zero.
#[derive(Clone, Copy, Debug)]
struct Ship {
    permanent_nt: [f64; 2],
    /// a, b, c, d, e, f.
    poisson: [f64; 6],
    zero_deg: f64,
}

impl Ship {
    fn random(rng: &mut ChaCha8Rng) -> Ship {
        let half = 0.01 * normal(rng);
        Ship {
            permanent_nt: [1500.0 * normal(rng), 1500.0 * normal(rng)],
            poisson: [
                half,
                0.008 * normal(rng),
                0.012 * normal(rng),
                0.008 * normal(rng),
                -half,
                0.006 * normal(rng),
            ],
            zero_deg: 0.6 * normal(rng),
        }
    }

    /// Returns the compass heading on a magnetic heading.
    fn compass_deg(&self, magnetic_deg: f64, h_nt: f64, z_nt: f64) -> f64 {
        let (sin, cos) = magnetic_deg.to_radians().sin_cos();
        let (x, y) = (h_nt * cos, -h_nt * sin);
        let [a, b, c, d, e, f] = self.poisson;
        let forward = x + a * x + b * y + c * z_nt + self.permanent_nt[0];
        let starboard = y + d * x + e * y + f * z_nt + self.permanent_nt[1];
        (-starboard).atan2(forward).to_degrees() - self.zero_deg
    }

    /// Returns the deviation on a compass heading, by bisection on the circle.
    fn deviation_deg(&self, compass_deg: f64, h_nt: f64, z_nt: f64) -> f64 {
        let off = |deviation_deg: f64| {
            let there = self.compass_deg(compass_deg + deviation_deg, h_nt, z_nt);
            wrap_180(there - compass_deg)
        };
        let (mut low, mut high) = (-60.0, 60.0);
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if off(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        f64::midpoint(low, high)
    }
}

impl Voyage {
    /// Returns the true deviation on a compass heading at the last place.
    pub(crate) fn deviation_deg(&self, compass_deg: f64) -> f64 {
        self.ship.deviation_deg(compass_deg, self.h_nt, self.z_nt)
    }
}

/// Process that wanders about zero with a memory.
#[derive(Clone, Copy, Debug)]
struct Wander {
    value: f64,
    sd: f64,
    memory: f64,
}

impl Wander {
    fn new(sd: f64, memory: f64, rng: &mut ChaCha8Rng) -> Wander {
        let value = sd * normal(rng);
        Wander { value, sd, memory }
    }

    fn step(&mut self, by: f64, rng: &mut ChaCha8Rng) -> f64 {
        let keep = (-by / self.memory).exp();
        self.value = keep * self.value + self.sd * (1.0 - keep * keep).sqrt() * normal(rng);
        self.value
    }
}

/// Water and wind around the ship, east and north.
struct Weather {
    /// Steady stream, and one that changes with the place, knots.
    steady_kn: [f64; 2],
    stream_kn: [Wander; 2],
    /// Tidal ellipse's axes, knots, with its strength along the way.
    tide_kn: [f64; 2],
    strength: Wander,
    /// Prevailing wind, and the weather's, metres a second.
    prevailing_ms: [f64; 2],
    wind_ms: [Wander; 2],
}

impl Weather {
    fn random(rng: &mut ChaCha8Rng) -> Weather {
        let [mut stream, mut wind] = [[0.0; 2]; 2];
        for (stream, wind) in stream.iter_mut().zip(&mut wind) {
            *stream = 0.15 * normal(rng);
            *wind = 2.5 * normal(rng);
        }
        Weather {
            steady_kn: stream,
            stream_kn: [0, 1].map(|_| Wander::new(0.35, 80.0, rng)),
            tide_kn: [0.7 * normal(rng), 0.7 * normal(rng)],
            strength: Wander::new(0.7, 40.0, rng),
            prevailing_ms: wind,
            wind_ms: [0, 1].map(|_| Wander::new(6.0, 2.0 * 86_400.0, rng)),
        }
    }

    /// Returns the current in knots and the wind in metres a second after a step.
    fn step(&mut self, time_s: f64, miles: f64, rng: &mut ChaCha8Rng) -> ([f64; 2], [f64; 2]) {
        let (sin, cos) = (TAU * time_s / TIDE_S).sin_cos();
        let strength = 1.0 + self.strength.step(miles, rng);
        let tide = [
            strength * self.tide_kn[0] * cos,
            strength * self.tide_kn[1] * sin,
        ];
        let current = std::array::from_fn(|i| {
            self.steady_kn[i] + self.stream_kn[i].step(miles, rng) + tide[i]
        });
        let wind =
            std::array::from_fn(|i| self.prevailing_ms[i] + self.wind_ms[i].step(STEP_S, rng));
        (current, wind)
    }
}

/// Part of a voyage.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    UnderWay,
    Manoeuvring,
    Drifting,
}

/// Sails a ship.
pub(crate) fn sail(seed: u64, plan: &Plan) -> Voyage {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let start = Timestamp::parse("2026-03-01T00:00:00Z").unwrap();
    let mut ship = Ship::random(rng);
    let mut weather = Weather::random(rng);
    let crab_deg = 0.5 * normal(rng);
    // Wind of 10 m/s on the beam sets a ship of 12 knots some two degrees to leeward.
    let windage = 0.6 * (0.5 * normal(rng)).exp();
    let service_kn = 9.0 + 6.0 * rng.random::<f64>();
    let mut swing = Wander::new(0.2, 1200.0, rng);
    let mut chart = Wander::new(0.2, 60.0, rng);
    let mut yaw = Wander::new(0.3, 1800.0, rng);
    let (mut lat, mut lon) = (48.0 + normal(rng), -8.0 + normal(rng));
    let (mut heading_deg, mut wanted_deg) = (360.0 * rng.random::<f64>(), 0.0);
    let (mut phase, mut left) = (Phase::Drifting, 6);
    let mut samples = Vec::new();
    let (mut h_nt, mut z_nt) = (0.0, 0.0);
    let mut miles = 0.0;
    for nth in 0..(plan.days * 86_400.0 / STEP_S) as usize {
        let time_s = STEP_S * nth as f64;
        if let Some((_, by_deg)) = plan
            .realigned
            .filter(|(day, _)| time_s / 86_400.0 >= *day && (time_s - STEP_S) / 86_400.0 < *day)
        {
            ship.zero_deg += by_deg;
        }
        if left == 0 {
            (phase, left) = next_phase(phase, plan, rng);
            wanted_deg = 360.0 * rng.random::<f64>();
            let out = ((lat - 48.0_f64) / 5.0).hypot((lon + 8.0) / 7.0);
            if out > 1.0 {
                let home = ((-8.0 - lon) * 0.67).atan2(48.0 - lat).to_degrees();
                wanted_deg = home + 60.0 * (rng.random::<f64>() - 0.5);
            }
        }
        left -= 1;
        let turn_deg = wrap_180(wanted_deg - heading_deg).clamp(-TURN_DEG, TURN_DEG);
        let speed_kn = match phase {
            Phase::UnderWay => service_kn,
            Phase::Manoeuvring => 3.0,
            Phase::Drifting => 0.0,
        };
        if phase == Phase::Drifting {
            heading_deg += 15.0 * normal(rng);
        } else {
            heading_deg += turn_deg;
        }
        // A leg is steered to a degree or so, and altered by a little.
        if rng.random::<f64>() < 0.02 {
            wanted_deg += 4.0 * normal(rng);
        }
        let true_deg = heading_deg + yaw.step(STEP_S, rng);
        let (current_kn, wind_ms) = weather.step(time_s, miles, rng);
        let over_ground_kn =
            over_ground(true_deg, speed_kn, current_kn, wind_ms, windage, crab_deg);
        let sog_kn = over_ground_kn[0].hypot(over_ground_kn[1]);
        let cog_deg = over_ground_kn[0].atan2(over_ground_kn[1]).to_degrees()
            + (0.12 / sog_kn.max(0.2)).to_degrees() * normal(rng);
        miles = sog_kn * STEP_S / 3600.0;
        lat += over_ground_kn[1] * STEP_S / 3600.0 / 60.0;
        lon += over_ground_kn[0] * STEP_S / 3600.0 / 60.0 / lat.to_radians().cos();
        let time = start.plus_seconds(time_s);
        let position = Position::new(lat, lon).unwrap();
        let here = field(FieldModel::Igrf14, position, 0.0, time).unwrap();
        (h_nt, z_nt) = (here.h_nt(), here.z_nt);
        let magnetic_deg =
            true_deg - here.declination().degrees_east() - chart.step(miles.max(0.01), rng);
        let compass_deg = ship.compass_deg(magnetic_deg, h_nt, z_nt)
            + swing.step(STEP_S, rng)
            + 0.2 * normal(rng);
        samples.push(Sample {
            sog_kn: Some(sog_kn),
            cog: CourseOverGround::new(cog_deg),
            rate_of_turn_deg_min: Some(turn_deg / 10.0 + 0.05 * normal(rng)),
            spread_deg: None,
            windows: 60,
            ..Sample::new(time, position, CompassHeading::new(compass_deg).unwrap())
        });
    }
    Voyage {
        samples,
        ship,
        h_nt,
        z_nt,
    }
}

fn next_phase(phase: Phase, plan: &Plan, rng: &mut ChaCha8Rng) -> (Phase, usize) {
    if plan.drifts {
        return (Phase::Drifting, 1000);
    }
    let chance = rng.random::<f64>();
    match phase {
        Phase::Drifting => (Phase::Manoeuvring, 4),
        Phase::UnderWay if chance < 0.06 => (Phase::Manoeuvring, 4),
        Phase::Manoeuvring if chance < 0.5 => (Phase::Drifting, 12 + (150.0 * chance) as usize),
        _ => (Phase::UnderWay, 6 + (60.0 * rng.random::<f64>()) as usize),
    }
}

/// Returns the velocity over the ground, east and north, knots.
fn over_ground(
    true_deg: f64,
    speed_kn: f64,
    current_kn: [f64; 2],
    wind_ms: [f64; 2],
    windage: f64,
    crab_deg: f64,
) -> [f64; 2] {
    let (sin, cos) = true_deg.to_radians().sin_cos();
    // Drag goes by the square of the speed, on the beam as on the bow.
    let across_ms = wind_ms[0] * cos - wind_ms[1] * sin;
    let speed_ms = speed_kn * 0.5144;
    let ahead_ms = speed_ms - (wind_ms[0] * sin + wind_ms[1] * cos);
    let side = windage * across_ms * across_ms.hypot(ahead_ms);
    let leeway_deg = side / speed_ms.max(1.5).powi(2) + crab_deg;
    let (sin, cos) = (true_deg + leeway_deg).to_radians().sin_cos();
    [
        current_kn[0] + speed_kn * sin,
        current_kn[1] + speed_kn * cos,
    ]
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
    radius * (TAU * rng.random::<f64>()).cos()
}
