//! One ship at sea, advanced step by step.
//!
//! Invariant: the same scenario, seed, ship, start and steps give bit-identical
//! readings. Slow quantities change once a minute of ship time, fast ones at
//! every step.

use crate::instruments::compass::{Compass, Exposure};
use crate::instruments::gyro::Gyro;
use crate::instruments::satellite::Satellite;
use crate::local_field::LocalField;
use crate::navigation::motion::Motion;
use crate::navigation::passage::{Order, Passage};
use crate::poisson::{Field, Magnetism};
use crate::random::Random;
use crate::scenario::{Event, Scenario, ShipPlan};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::field::FieldError;
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;

const MINUTE_S: f64 = 60.0;

/// Readings of the instruments at one instant, with the true values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Time of the reading.
    pub time: Timestamp,
    /// Position.
    pub position: Position,
    /// Speed over ground, knots.
    pub sog_kn: f64,
    /// Course over ground, degrees true.
    pub cog_deg: f64,
    /// Rate of turn, degrees a minute, starboard positive.
    pub rate_deg_min: f64,
    /// Roll, degrees, starboard down positive.
    pub roll_deg: f64,
    /// Raw reading of the magnetic compass, degrees, not wrapped.
    pub compass_deg: f64,
    /// Reading of the gyro, degrees, not wrapped.
    pub gyro_deg: f64,
    /// Reading of the satellite compass, degrees, not wrapped.
    pub satellite: SatelliteReading,
    /// True if the ship lies alongside.
    pub alongside: bool,
    /// The true heading.
    pub heading_deg: f64,
}

/// Reading of the satellite compass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SatelliteReading {
    /// The ship has none.
    Absent,
    /// It has lost its satellites.
    Lost,
    /// A heading, degrees, not wrapped.
    Heading(f64),
}

/// A ship under way in a scenario.
#[derive(Clone, Debug)]
pub struct Ship {
    plan: ShipPlan,
    start: Timestamp,
    elapsed_s: f64,
    minute_s: f64,
    run_nm: f64,
    passage: Passage,
    order: Order,
    motion: Motion,
    local_field: LocalField,
    magnetism: Magnetism,
    berth: Berth,
    compass: Compass,
    gyro: Gyro,
    satellite: Option<Satellite>,
}

/// Magnetic field of the quay: 0.1 to 1.5 µT at the compass, different at every
/// berth.
#[derive(Clone, Debug)]
struct Berth {
    steel: Option<Magnetism>,
    random: Random,
}

impl Ship {
    /// Creates a ship of the scenario at the start of its voyage.
    ///
    /// # Errors
    /// Fails when the earth's field is not known for that time.
    pub fn new(
        scenario: &Scenario,
        plan: &ShipPlan,
        seed: u64,
        start: Timestamp,
    ) -> Result<Ship, FieldError> {
        let mut motion = Motion::new(plan, seed);
        let local_field = LocalField::new(scenario, &plan.name, seed, start, motion.position)?;
        let mut passage = Passage::new(plan, seed);
        let order = passage.step(0.0, motion.position);
        motion.begin(order);
        let mut ship = Ship {
            plan: plan.clone(),
            start,
            elapsed_s: 0.0,
            minute_s: 0.0,
            run_nm: 0.0,
            passage,
            order,
            motion,
            local_field,
            magnetism: plan.magnetism,
            berth: Berth {
                steel: None,
                random: Random::new(seed, &plan.name, "berth"),
            },
            compass: Compass::new(plan, seed),
            gyro: Gyro::new(plan, seed),
            satellite: plan
                .satellite
                .map(|satellite| Satellite::new(plan, satellite, seed)),
        };
        ship.step_slow(0.0);
        Ok(ship)
    }

    /// The ship's plan.
    pub fn plan(&self) -> &ShipPlan {
        &self.plan
    }

    /// The start of the voyage.
    pub fn start(&self) -> Timestamp {
        self.start
    }

    /// The ship's time.
    pub fn time(&self) -> Timestamp {
        self.start.plus_seconds(self.elapsed_s)
    }

    /// The ship's position.
    pub fn position(&self) -> Position {
        self.motion.position
    }

    /// True if the ship lies alongside.
    pub fn is_alongside(&self) -> bool {
        self.passage.is_alongside()
    }

    /// The present true heading, degrees.
    pub fn heading_deg(&self) -> f64 {
        self.motion.heading_deg
    }

    /// The ship's own present magnetism, without that of a quay.
    pub fn magnetism(&self) -> Magnetism {
        self.magnetism
    }

    /// Charted variation here and now, degrees east.
    pub fn charted_variation_deg(&self) -> f64 {
        self.local_field.charted.declination().degrees_east()
    }

    /// Charted field here and now.
    pub fn charted_field(&self) -> Field {
        Field {
            h_nt: self.local_field.charted.h_nt(),
            z_nt: self.local_field.charted.z_nt,
        }
    }

    /// Returns the deviation of a perfect model on a compass reading, here and
    /// now, degrees east: true heading less charted variation less the reading,
    /// with the lubber line and without noise.
    pub fn deviation_deg(&self, compass_deg: f64) -> f64 {
        let card_deg = compass_deg - self.plan.alignment_deg;
        let magnetic = self.magnetism.magnetic_deg(self.charted_field(), card_deg);
        wrap_180(magnetic - compass_deg)
    }

    /// The compass reading here and now without any noise, degrees, not
    /// wrapped.
    pub fn quiet_compass_deg(&self) -> f64 {
        let magnetic = self.motion.heading_deg - self.charted_variation_deg();
        let deviation = self
            .magnetism
            .deviation_deg(self.charted_field(), magnetic, 0.0);
        magnetic - deviation + self.plan.alignment_deg
    }

    /// Advances by `dt` seconds and reads all instruments.
    pub fn step(&mut self, dt: f64) -> Reading {
        self.elapsed_s += dt;
        self.minute_s += dt;
        self.run_nm += self.motion.sog_kn * dt / 3600.0;
        if self.minute_s >= MINUTE_S {
            let elapsed_s = std::mem::take(&mut self.minute_s);
            self.step_slow(elapsed_s);
        }
        let before_deg = self.motion.heading_deg;
        if let Some(turn) = self.motion.step(dt, self.order) {
            self.gyro.turned(turn);
        }
        self.read(dt, before_deg)
    }

    fn read(&mut self, dt: f64, before_deg: f64) -> Reading {
        let motion = &self.motion;
        let at_compass = match &self.berth.steel {
            Some(steel) => self.magnetism.plus(steel, 1.0),
            None => self.magnetism,
        };
        let compass_deg = self.compass.read(
            dt,
            &Exposure {
                magnetism: &at_compass,
                field: self.local_field.field,
                magnetic_deg: motion.heading_deg - self.local_field.variation_deg,
                roll_deg: motion.roll_deg,
                turned_deg: wrap_180(motion.heading_deg - before_deg),
                sea: motion.sea,
            },
        );
        let satellite = self
            .satellite
            .as_mut()
            .map(|s| s.read(dt, motion.heading_deg));
        Reading {
            time: self.start.plus_seconds(self.elapsed_s),
            position: motion.position,
            sog_kn: motion.sog_kn,
            cog_deg: motion.cog_deg,
            rate_deg_min: motion.rate_deg_min,
            roll_deg: motion.roll_deg,
            compass_deg,
            gyro_deg: self.gyro.read(dt, motion.heading_deg),
            satellite: match satellite {
                None => SatelliteReading::Absent,
                Some(None) => SatelliteReading::Lost,
                Some(Some(heading)) => SatelliteReading::Heading(heading),
            },
            alongside: self.passage.is_alongside(),
            heading_deg: motion.heading_deg,
        }
    }

    fn step_slow(&mut self, elapsed_s: f64) {
        let time = self.time();
        let day = time.seconds_since(self.start) / 86_400.0;
        self.order = self.passage.step(elapsed_s, self.motion.position);
        self.motion.step_slow(elapsed_s);
        let run_nm = std::mem::take(&mut self.run_nm);
        self.local_field
            .step(elapsed_s, run_nm, self.motion.position, time);
        self.magnetism = magnetism_at(&self.plan, day);
        self.gyro.step_slow(elapsed_s, day, &self.motion);
        self.berth.step(self.passage.is_alongside());
    }
}

impl Berth {
    fn step(&mut self, alongside: bool) {
        if !alongside {
            self.steel = None;
        } else if self.steel.is_none() {
            let size = self.random.between(100.0, 1500.0);
            let angle = self.random.between(0.0, std::f64::consts::TAU);
            let upward = self.random.between(-0.5, 0.5) * size;
            self.steel = Some(Magnetism {
                b_nt: [size * angle.cos(), size * angle.sin(), upward],
                chi: [[0.0; 3]; 3],
            });
        }
    }
}

/// Returns a ship's magnetism `day` days from the start, by its events.
pub fn magnetism_at(plan: &ShipPlan, day: f64) -> Magnetism {
    plan.events
        .iter()
        .fold(plan.magnetism, |now, event| match event {
            Event::Lightning {
                day: struck,
                b_nt,
                returning,
                return_days,
            } if day >= *struck => {
                let gone = returning * (1.0 - (-(day - struck) / return_days).exp());
                let jump = Magnetism {
                    b_nt: *b_nt,
                    chi: [[0.0; 3]; 3],
                };
                now.plus(&jump, 1.0 - gone)
            }
            Event::Cargo {
                from_day,
                to_day,
                magnetism,
            } if (*from_day..*to_day).contains(&day) => now.plus(magnetism, 1.0),
            _ => now,
        })
}
