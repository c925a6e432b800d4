//! The instruments' sentences on the wire: their schedule, and the damage done
//! by a poor line.

use super::sentences;
use crate::random::Random;
use crate::scenario::{LineFaults, Scenario, Timing};
use crate::ship::{Reading, SatelliteReading, Ship};
use binnacle_compass::time::Timestamp;

/// Talker of the gyro's sentences.
const GYRO: [u8; 2] = *b"HE";
const ROLL_EVERY_S: f64 = 10.0;
const DATE_EVERY_S: f64 = 600.0;

/// A ship's instruments on one line.
#[derive(Clone, Debug)]
pub struct Talker {
    ship: Ship,
    timing: Timing,
    faults: LineFaults,
    until_wrong: f64,
    until_garbage: f64,
    since_position_s: f64,
    since_roll_s: f64,
    since_date_s: f64,
    random: Random,
    groups: u64,
    sentences: u64,
}

impl Talker {
    /// Creates the instruments of a ship of the scenario.
    pub fn new(scenario: &Scenario, ship: Ship, seed: u64) -> Talker {
        let mut random = Random::new(seed, &ship.plan().name, "line");
        let faults = scenario.faults;
        Talker {
            timing: scenario.timing,
            faults,
            until_wrong: until_next(faults.wrong_checksum, &mut random),
            until_garbage: until_next(faults.garbage, &mut random),
            since_position_s: f64::INFINITY,
            since_roll_s: f64::INFINITY,
            since_date_s: f64::INFINITY,
            random,
            groups: 0,
            sentences: 0,
            ship,
        }
    }

    /// The ship.
    pub fn ship(&self) -> &Ship {
        &self.ship
    }

    /// Number of groups of sentences written.
    pub fn groups(&self) -> u64 {
        self.groups
    }

    /// Number of sentences written.
    pub fn sentences(&self) -> u64 {
        self.sentences
    }

    /// Sets the interval of all sentences, also in port.
    pub fn set_interval(&mut self, interval_s: f64) {
        self.timing = Timing {
            interval_s,
            position_interval_s: interval_s,
            moored_interval_s: interval_s,
        };
    }

    /// Time of the next group of sentences.
    pub fn next_time(&self) -> Timestamp {
        self.ship.time().plus_seconds(self.interval_s())
    }

    /// Advances to the next group of sentences and appends them to `out`.
    pub fn write_group(&mut self, out: &mut Vec<u8>) -> Reading {
        let dt = self.interval_s();
        let reading = self.ship.step(dt);
        self.since_position_s += dt;
        self.since_roll_s += dt;
        self.since_date_s += dt;
        self.groups += 1;
        // Half a step of tolerance, or rounding would skip every other one.
        let due = |since_s: f64, every_s: f64| since_s + 0.5 * dt >= every_s;
        if due(self.since_position_s, self.timing.position_interval_s) {
            self.since_position_s = 0.0;
            let (at, sog, cog) = (reading.position, reading.sog_kn, reading.cog_deg);
            self.write_sentence(out, |out| sentences::gprmc(out, reading.time, at, sog, cog));
            self.write_sentence(out, |out| sentences::herot(out, reading.rate_deg_min));
        }
        self.write_sentence(out, |out| sentences::hchdg(out, reading.compass_deg));
        self.write_sentence(out, |out| {
            sentences::ths(out, GYRO, Some(reading.gyro_deg));
        });
        self.write_satellite(out, reading.satellite);
        if due(self.since_roll_s, ROLL_EVERY_S) {
            self.since_roll_s = 0.0;
            self.write_sentence(out, |out| sentences::iixdr_roll(out, reading.roll_deg));
        }
        if due(self.since_date_s, DATE_EVERY_S) {
            self.since_date_s = 0.0;
            self.write_sentence(out, |out| sentences::gpzda(out, reading.time));
        }
        reading
    }

    fn write_satellite(&mut self, out: &mut Vec<u8>, reading: SatelliteReading) {
        let Some(plan) = self.ship.plan().satellite else {
            return;
        };
        let heading = match reading {
            SatelliteReading::Absent => return,
            SatelliteReading::Lost => None,
            SatelliteReading::Heading(degrees) => Some(degrees),
        };
        self.write_sentence(out, |out| sentences::ths(out, plan.talker, heading));
    }

    fn interval_s(&self) -> f64 {
        if self.ship.is_alongside() {
            self.timing.moored_interval_s
        } else {
            self.timing.interval_s
        }
    }

    fn write_sentence(&mut self, out: &mut Vec<u8>, write: impl FnOnce(&mut Vec<u8>)) {
        let start = out.len();
        write(out);
        self.sentences += 1;
        self.until_wrong -= 1.0;
        if self.until_wrong <= 0.0 {
            self.until_wrong = until_next(self.faults.wrong_checksum, &mut self.random);
            self.damage(&mut out[start..]);
        }
        self.until_garbage -= 1.0;
        if self.until_garbage <= 0.0 {
            self.until_garbage = until_next(self.faults.garbage, &mut self.random);
            self.write_noise(out);
        }
    }

    /// Alters one bit between the `$` and the checksum, which then is wrong.
    fn damage(&mut self, sentence: &mut [u8]) {
        let last = sentence.len() - 6;
        let at = 1 + (self.random.unit() * last as f64) as usize;
        sentence[at.min(last)] ^= 1;
    }

    fn write_noise(&mut self, out: &mut Vec<u8>) {
        let length = self.random.between(3.0, 90.0) as usize;
        for _ in 0..length {
            let byte = (self.random.unit() * 256.0) as u8;
            out.push(if matches!(byte, b'\r' | b'\n') {
                b'?'
            } else {
                byte
            });
        }
        out.extend_from_slice(b"\r\n");
    }
}

fn until_next(rate: f64, random: &mut Random) -> f64 {
    if rate > 0.0 {
        random.waiting(1.0 / rate)
    } else {
        f64::INFINITY
    }
}
