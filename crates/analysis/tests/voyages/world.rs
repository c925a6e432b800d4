//! Events and chances that a ship meets, by the minute.

use super::patch::Patch;
use super::plan::{Event, Happened, Name, Plan};
use super::{Errors, Passage, Truth, gauss};
use binnacle_compass::model::Parameters;
use binnacle_compass::time::Timestamp;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Situation of the ship in a minute.
#[derive(Clone, Copy)]
pub(super) struct Situation {
    /// True in the first minute in port.
    pub(super) arrived: bool,
    /// Minutes since the last port.
    pub(super) at_sea_minutes: i64,
    pub(super) compass_deg: f64,
}

/// Influences beside the ship's own errors, by the minute.
pub(super) struct World {
    start: Timestamp,
    pub(super) happened: Vec<Happened>,
    patch: Option<(Patch, usize)>,
    gyro_fault: Option<(f64, i64)>,
    /// Error of the variation in degrees, and its end.
    variation_error: Option<(f64, i64)>,
    base: [f64; 7],
    pub(super) changed: Option<[Parameters; 2]>,
    /// Decaying part of a lightning strike.
    fading: [f64; 2],
    /// Growth of a ramp by the minute, and its end.
    growing: ([f64; 2], i64),
    state: Stage,
}

#[derive(Clone, Copy, PartialEq)]
enum Stage {
    ToCome,
    /// Cargo on board for this many further port calls.
    Laden(u32),
    /// A magnet of (bx, by) by the compass until some minute.
    Beset([f64; 2], i64),
    Over,
}

impl World {
    pub(super) fn new(start: Timestamp) -> World {
        World {
            start,
            happened: Vec::new(),
            patch: None,
            gyro_fault: None,
            variation_error: None,
            base: [0.0; 7],
            changed: None,
            fading: [0.0; 2],
            growing: ([0.0; 2], 0),
            state: Stage::ToCome,
        }
    }

    pub(super) fn time(&self, minute: i64) -> Timestamp {
        self.start.plus_seconds(60.0 * minute as f64)
    }

    fn note(&mut self, what: Name, minute: i64) -> usize {
        self.happened.push(Happened {
            what,
            from: self.time(minute),
            to: None,
        });
        self.happened.len() - 1
    }

    fn end(&mut self, what: Name, minute: i64) {
        let time = self.time(minute);
        let last = self.happened.iter_mut().rfind(|h| h.what == what);
        if let Some(last) = last {
            last.to = Some(time);
        }
    }

    /// Starts the planned event at its time.
    pub(super) fn plan(
        &mut self,
        plan: &Plan,
        minute: i64,
        now: Situation,
        truth: &mut Truth,
        rng: &mut ChaCha8Rng,
    ) {
        let due = minute as f64 >= plan.event_day * 1440.0;
        let at_sea = now.at_sea_minutes > 600;
        match (self.state, plan.event) {
            (Stage::ToCome, Event::Step(nt) | Event::StepBy(nt, _) | Event::Lightning(nt))
                if due && at_sea =>
            {
                let before = truth.parameters;
                let (sin, cos) = match plan.event {
                    // Compass north lies as far to port of the bow as the ship heads east
                    // of it.
                    Event::StepBy(_, from_needle) => (from_needle - now.compass_deg).to_radians(),
                    _ => TAU * rng.random::<f64>(),
                }
                .sin_cos();
                truth.parameters.bx_nt += nt * cos;
                truth.parameters.by_nt += nt * sin;
                self.changed = Some([before, truth.parameters]);
                let is_lightning = matches!(plan.event, Event::Lightning(_));
                if is_lightning {
                    self.fading = [nt * cos / 3.0, nt * sin / 3.0];
                }
                let name = if is_lightning {
                    Name::Lightning
                } else {
                    Name::Step
                };
                self.note(name, minute);
                self.state = Stage::Over;
            }
            (Stage::ToCome, Event::Cargo | Event::Refit) if due && now.arrived => {
                let before = truth.parameters;
                self.base = before.to_array();
                let sd = [600.0, 0.005, 600.0, 0.0025, 0.008, 0.003, 0.003];
                let mut laden = self.base;
                for (p, sd) in laden.iter_mut().zip(sd) {
                    *p += sd * gauss(rng);
                }
                truth.parameters = Parameters::from_array(laden);
                self.changed = Some([before, truth.parameters]);
                let is_cargo = plan.event == Event::Cargo;
                self.note(if is_cargo { Name::Cargo } else { Name::Refit }, minute);
                self.state = if is_cargo {
                    Stage::Laden(2)
                } else {
                    Stage::Over
                };
            }
            (Stage::Laden(calls), _) if now.arrived => {
                self.state = Stage::Laden(calls - 1);
                if calls == 1 {
                    truth.parameters = Parameters::from_array(self.base);
                    self.end(Name::Cargo, minute);
                    self.state = Stage::Over;
                }
            }
            (Stage::ToCome, Event::GyroFault(degrees)) if due && at_sea => {
                self.break_gyro(degrees, minute, rng);
                self.state = Stage::Over;
            }
            (Stage::ToCome, Event::Magnet(nt)) if due && at_sea => {
                let (sin, cos) = (TAU * rng.random::<f64>()).sin_cos();
                let magnet = [nt * cos, nt * sin];
                truth.parameters.bx_nt += magnet[0];
                truth.parameters.by_nt += magnet[1];
                self.note(Name::Brief, minute);
                self.state = Stage::Beset(magnet, minute + brief_minutes(rng));
            }
            (Stage::Beset(magnet, until), _) if minute >= until => {
                truth.parameters.bx_nt -= magnet[0];
                truth.parameters.by_nt -= magnet[1];
                self.end(Name::Brief, minute);
                self.state = Stage::Over;
            }
            (Stage::ToCome, Event::VariationError(degrees)) if due && at_sea => {
                let side = if rng.random::<bool>() { 1.0 } else { -1.0 };
                self.variation_error = Some((side * degrees, minute + brief_minutes(rng)));
                self.note(Name::Brief, minute);
                self.state = Stage::Over;
            }
            (Stage::ToCome, Event::Ramp(nt, days)) if due => {
                let (sin, cos) = (TAU * rng.random::<f64>()).sin_cos();
                let minutes = days * 1440.0;
                let each = [nt * cos / minutes, nt * sin / minutes];
                self.growing = (each, minute + minutes as i64);
                self.note(Name::Ramp, minute);
                self.state = Stage::Over;
            }
            _ => {}
        }
        if minute < self.growing.1 {
            truth.parameters.bx_nt += self.growing.0[0];
            truth.parameters.by_nt += self.growing.0[1];
        }
        // Half of the decaying part is gone in a fortnight.
        for (fading, b) in self
            .fading
            .iter_mut()
            .zip([&mut truth.parameters.bx_nt, &mut truth.parameters.by_nt])
        {
            let lost = *fading / (20.0 * 1440.0);
            *fading -= lost;
            *b -= lost;
        }
    }

    fn break_gyro(&mut self, degrees: f64, minute: i64, rng: &mut ChaCha8Rng) {
        let side = if rng.random::<bool>() { 1.0 } else { -1.0 };
        let days = 1.0 + 5.0 * rng.random::<f64>();
        self.gyro_fault = Some((side * degrees, minute + (days * 1440.0) as i64));
        self.note(Name::GyroFault, minute);
    }

    /// Returns the chance errors of variation and gyro.
    pub(super) fn chance(
        &mut self,
        plan: &Plan,
        minute: i64,
        on: &Passage,
        errors: &Errors,
        rng: &mut ChaCha8Rng,
    ) -> (f64, f64) {
        let storming = errors.storm_minutes > 0.0;
        let last = self.happened.iter().rfind(|h| h.what == Name::Storm);
        let noted = last.is_some_and(|h| h.to.is_none());
        if storming && !noted {
            self.note(Name::Storm, minute);
        }
        if !storming && noted {
            self.end(Name::Storm, minute);
        }
        let at_sea = on.berth_minutes <= 0.0;
        if self.patch.is_none() && at_sea && rng.random::<f64>() < plan.anomalies / 43_200.0 {
            let index = self.note(Name::Anomaly, minute);
            self.patch = Some((Patch::ahead(on, rng), index));
        }
        let by_chance = rng.random::<f64>() < plan.gyro_faults / 525_600.0;
        if by_chance && self.gyro_fault.is_none() {
            let degrees = 3.0 + 3.0 * rng.random::<f64>();
            self.break_gyro(degrees, minute, rng);
        }
        if self.gyro_fault.is_some_and(|(_, until)| until <= minute) {
            self.gyro_fault = None;
            self.end(Name::GyroFault, minute);
        }
        if self
            .variation_error
            .is_some_and(|(_, until)| until <= minute)
        {
            self.variation_error = None;
            self.end(Name::Brief, minute);
        }
        let mut variation = self
            .variation_error
            .map_or(0.0, |variation_error| variation_error.0);
        if let Some((patch, index)) = &self.patch {
            let off = patch.at(on);
            variation += off;
            let hours = self.time(minute).seconds_since(self.happened[*index].from) / 3600.0;
            if hours > 4.0 && off.abs() < 0.05 {
                self.patch = None;
                self.end(Name::Anomaly, minute);
            }
        }
        (variation, self.gyro_fault.map_or(0.0, |fault| fault.0))
    }
}

fn brief_minutes(rng: &mut ChaCha8Rng) -> i64 {
    90 + (90.0 * rng.random::<f64>()) as i64
}

/// Returns the minutes at which storms begin, and their durations.
pub(super) fn storms(sun: u64, days: f64, a_month: f64) -> Vec<(i64, f64)> {
    let mut rng = ChaCha8Rng::seed_from_u64(sun);
    let mut storms: Vec<(i64, f64)> = Vec::new();
    for minute in 0..(days * 1440.0) as i64 {
        let calm = storms
            .last()
            .is_none_or(|(begun, minutes)| (minute - begun) as f64 > *minutes);
        if calm && rng.random::<f64>() < a_month / 43_200.0 {
            storms.push((minute, 240.0 + 600.0 * rng.random::<f64>()));
        }
    }
    storms
}
