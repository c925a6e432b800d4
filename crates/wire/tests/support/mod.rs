//! Days of sailing for tests, benchmarks and vectors: the samples depend on the
//! seed alone.

// Each program that includes this uses a part of it.
#![allow(dead_code)]

use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::sample::{Sample, SourceId};
use binnacle_compass::time::Timestamp;
use binnacle_wire::alert::{ShipAlert, ShipAlertState};
use binnacle_wire::batch::{Batch, StreamId};
use binnacle_wire::reasons;
use std::collections::BTreeMap;
use uuid::Uuid;

/// Knuth's linear congruential generator, from 0 up to 1.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    pub(crate) fn uniform(&mut self) -> f64 {
        self.next() as f64 / f64::from(1_u32 << 31)
    }

    /// Nearly normal, standard deviation 1: twelve uniforms less their mean.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Ten-minute means along legs of some hours: a gyro with a Schuler swing, a
/// compass with deviation and noise, varying speed. About one sample in five is
/// missing, as after turns.
pub(crate) fn voyage(seed: u64, count: usize) -> Vec<Sample> {
    let mut dice = Dice(seed);
    let mut time = Timestamp::parse("2026-10-01T00:00:05Z").expect("a date");
    let (mut lat, mut lon) = (36.0, -6.0);
    let (mut heading, mut left) = (250.0, 0_u32);
    let mut sog_kn: f64 = 14.0;
    let mut samples = Vec::with_capacity(count);
    while samples.len() < count {
        if left == 0 {
            heading += 120.0 * (dice.uniform() - 0.5);
            left = 6 + (dice.uniform() * 60.0) as u32;
        }
        left -= 1;
        let missing = dice.uniform() < 0.2;
        let windows: u16 = if dice.uniform() < 0.7 {
            60
        } else {
            6 * (3 + dice.next() % 7) as u16
        };
        let (sin, cos) = f64::to_radians(heading).sin_cos();
        lat += sog_kn / 360.0 * cos;
        lon += sog_kn / 360.0 * sin / f64::to_radians(lat).cos();
        sog_kn += 0.1 * dice.normal();
        time = time.plus_seconds(600.0);
        if lat.abs() > 60.0 {
            heading = 180.0 - heading;
        }
        if missing {
            continue;
        }
        let swing = 0.4 * (time.micros() as f64 / 5.064e9 * std::f64::consts::TAU).sin();
        let ship = heading + 0.2 * dice.normal();
        let deviation = 2.5 * sin - 1.5 * cos + 0.3;
        let compass = CompassHeading::new(ship + 4.0 - deviation + 0.15 * dice.normal());
        let middle = time.plus_seconds(5.0 * (f64::from(windows) / 2.0).floor() - 150.0);
        let position = Position::new(lat, (lon + 540.0).rem_euclid(360.0) - 180.0);
        samples.push(Sample {
            gyro: TrueHeading::new(ship + swing + 0.05 * dice.normal()),
            sog_kn: Some(sog_kn.abs()),
            rate_of_turn_deg_min: Some(0.3 * dice.normal()),
            spread_deg: Some((0.35 + 0.1 * dice.normal()).abs()),
            windows,
            ..Sample::new(middle, position.expect("at sea"), compass.expect("finite"))
        });
    }
    samples
}

/// Returns a [`voyage`] with the drift of a current and of the wind, the roll of a ship in
/// changing weather, a list, and the day's temperatures.
pub(crate) fn voyage_with_motion(seed: u64, count: usize) -> Vec<Sample> {
    let mut dice = Dice(seed.wrapping_mul(7_919) + 1);
    let (mut drift_deg, mut roll_spread_deg, mut air_c) = (0.0, 2.0, 15.0);
    let mut samples = voyage(seed, count);
    for sample in &mut samples {
        drift_deg += -0.05 * drift_deg + 0.35 * dice.normal();
        roll_spread_deg += 0.03 * (2.0 - roll_spread_deg) + 0.15 * dice.normal();
        air_c += 0.01 * (15.0 - air_c) + 0.1 * dice.normal();
        let gyro = sample.gyro.expect("every sample has one").degrees();
        sample.cog = CourseOverGround::new(gyro + drift_deg + 0.4 * dice.normal());
        sample.roll_deg = Some(0.4 + 0.15 * drift_deg + 0.1 * dice.normal());
        sample.roll_spread_deg = Some((roll_spread_deg + 0.2 * dice.normal()).abs());
        sample.temperature_c = Some(air_c);
        sample.gyro_source = Some(SourceId::from_name("bridge HE THS"));
    }
    samples
}

/// A batch as an agent seals it.
pub(crate) fn batch(seq: u64, samples: Vec<Sample>) -> Batch {
    let tally = [
        (reasons::ACCEPTED, 1_931),
        (reasons::SETTLING, 83),
        (reasons::TURNING, 37),
        (reasons::SWINGING, 12),
    ];
    Batch {
        stream: StreamId(Uuid::from_u128(0x0193_4f2a_7c00_7000_8000_0000_0000_002a)),
        seq,
        samples,
        tally: tally.map(|(name, count)| (name.to_owned(), count)).into(),
        alerts: Vec::new(),
        thinned: None,
    }
}

/// An alert of a vessel whose compass and gyro differ.
pub(crate) fn alert(revision: u32) -> ShipAlert {
    let since = Timestamp::parse("2026-10-01T04:00:00Z").expect("a date");
    ShipAlert {
        id: Uuid::from_u128(0x0193_4f2a_7c00_4000_8000_0000_0000_00a1),
        revision,
        state: match revision {
            1 => ShipAlertState::Open,
            2 => ShipAlertState::Agree,
            _ => ShipAlertState::NotJudged,
        },
        since,
        at: since.plus_seconds(300.0 * f64::from(revision)),
        gyro_departure_deg: (revision != 2).then_some(-28.4),
        satellite_departure_deg: (revision > 1).then_some(0.3),
        limit_deg: 3.9,
        model_version: 4,
    }
}

/// A batch with nothing in it but a tally.
pub(crate) fn empty() -> Batch {
    Batch {
        tally: BTreeMap::from([("iceberg".to_owned(), 3)]),
        ..batch(1, Vec::new())
    }
}
