//! Ships with an event, the samples that an agent would keep, and the truth.
//!
//! The field is the IGRF's, as in the analysis; all else is this folder's own.

use super::kept::Kept;
pub(crate) use super::plan::{Event, Happened, Name, Plan};
use super::{Errors, Faults, Passage, Truth, gauss, needle};
use binnacle_compass::angle::{CompassHeading, wrap_180};
use binnacle_compass::field::{FieldAt, FieldModel};
use binnacle_compass::model::Parameters;
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Time at which every ship sails.
pub(crate) const START: &str = "2026-02-01T00:00:00Z";

pub(crate) struct Log {
    pub(crate) samples: Vec<Sample>,
    /// Minutes of which the samples are means.
    pub(crate) minutes: Vec<Sample>,
    pub(crate) happened: Vec<Happened>,
    /// The ship at the end.
    pub(crate) truth: Truth,
    /// Magnetism just before the planned step or cargo, and just after.
    pub(crate) changed: Option<[Parameters; 2]>,
    /// First minute, the sizes of the errors, and minutes of the turns that disturb the
    /// gyro.
    pub(crate) start: Timestamp,
    pub(crate) sizes: Faults,
    pub(crate) turns: Vec<i64>,
}

/// A patch of magnetic sea bed.
struct Patch {
    lat: f64,
    lon: f64,
    radius_nm: f64,
    peak_deg: f64,
}

impl Patch {
    /// Makes a patch where the ship will arrive in about an hour.
    fn ahead(on: &Passage, rng: &mut ChaCha8Rng) -> Patch {
        let radius_nm = 3.0 + 9.0 * rng.random::<f64>();
        let ahead_deg = 3.0 * radius_nm / 60.0;
        let (sin, cos) = on.course.to_radians().sin_cos();
        let side = if rng.random::<bool>() { 1.0 } else { -1.0 };
        Patch {
            lat: on.lat + ahead_deg * cos,
            lon: on.lon + ahead_deg * sin / on.lat.to_radians().cos(),
            radius_nm,
            peak_deg: side * (1.5 + 3.5 * rng.random::<f64>()),
        }
    }

    fn at(&self, on: &Passage) -> f64 {
        let north = on.lat - self.lat;
        let east = wrap_180(on.lon - self.lon) * on.lat.to_radians().cos();
        let distance = 60.0 * north.hypot(east) / self.radius_nm;
        self.peak_deg * (-distance * distance / 2.0).exp()
    }
}

/// Situation of the ship in a minute.
#[derive(Clone, Copy)]
struct Situation {
    /// True in the first minute in port.
    arrived: bool,
    /// Minutes since the last port.
    at_sea_minutes: i64,
    compass_deg: f64,
}

/// Influences beside the ship's own errors, by the minute.
struct World {
    start: Timestamp,
    happened: Vec<Happened>,
    patch: Option<(Patch, usize)>,
    gyro_fault: Option<(f64, i64)>,
    /// Error of the variation in degrees, and its end.
    variation_error: Option<(f64, i64)>,
    base: [f64; 7],
    changed: Option<[Parameters; 2]>,
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
    fn time(&self, minute: i64) -> Timestamp {
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
    fn plan(
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
    fn chance(
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
fn storms(sun: u64, days: f64, a_month: f64) -> Vec<(i64, f64)> {
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

/// Returns the compass's reading with no error but the ship's magnetism.
fn shown_deg(truth: &Truth, passage: &Passage, field: &FieldAt) -> f64 {
    let position = Position::new(passage.lat, passage.lon).unwrap();
    let here = field.at(position, 0.0).unwrap();
    let magnetic = passage.course - here.declination().degrees_east();
    needle(&truth.parameters, magnetic, here.h_nt(), here.z_nt)
}

/// Sails a ship and keeps the samples of its agent.
pub(crate) fn sail_log(seed: u64, plan: &Plan) -> Log {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let faults = &plan.faults.of_one_ship(&mut rng);
    let shared = plan
        .sun
        .map(|sun| storms(sun, plan.days, faults.storms_per_month));
    let faults = &Faults {
        storms_per_month: if shared.is_some() {
            0.0
        } else {
            faults.storms_per_month
        },
        ..*faults
    };
    let shared = shared.unwrap_or_default();
    let mut truth = Truth::for_unknown_vessel(faults, &mut rng);
    let mut passage = Passage::new(plan.variety, &mut rng);
    let mut errors = Errors::new(faults, &mut rng);
    let start = Timestamp::parse(START).unwrap();
    let mut world = World {
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
    };
    let mut field = FieldAt::from_time(FieldModel::Igrf14, start).unwrap();
    let mut kept = Kept::default();
    let mut turns = Vec::new();
    let mut at_sea_for = 0;
    for minute in 0..(plan.days * 1440.0) as i64 {
        if minute % 1440 == 0 {
            field = FieldAt::from_time(FieldModel::Igrf14, world.time(minute + 720)).unwrap();
        }
        let turned = passage.minute(&mut rng);
        if turned.abs() > 20.0 {
            turns.push(minute);
        }
        if minute % 60 == 0 {
            let hourly = faults.drift_nt / 720.0_f64.sqrt();
            truth.parameters.bx_nt += hourly * gauss(&mut rng);
            truth.parameters.by_nt += hourly * gauss(&mut rng);
        }
        if let Some((_, minutes)) = shared.iter().find(|(begun, _)| *begun == minute) {
            errors.storm_minutes = *minutes;
        }
        errors.minute(faults, &passage, turned, &mut rng);
        let alongside = passage.berth_minutes > 0.0;
        let arrived = alongside && at_sea_for > 0;
        at_sea_for = if alongside { 0 } else { at_sea_for + 1 };
        let now = Situation {
            arrived,
            at_sea_minutes: at_sea_for,
            compass_deg: match plan.event {
                Event::StepBy(..) => shown_deg(&truth, &passage, &field),
                _ => 0.0,
            },
        };
        world.plan(plan, minute, now, &mut truth, &mut rng);
        let (variation_error, gyro_off) = world.chance(plan, minute, &passage, &errors, &mut rng);
        if alongside || passage.turning_minutes > 0.0 {
            kept.break_off();
            continue;
        }
        let position = Position::new(passage.lat, passage.lon).unwrap();
        let here = field.at(position, 0.0).unwrap();
        let (variation, h, z) = (here.declination().degrees_east(), here.h_nt(), here.z_nt);
        let met = (variation + variation_error, h, z);
        let read = errors.read(&truth, &passage, minute, met, &mut rng);
        let at = Sample {
            sog_kn: Some(passage.speed_kn),
            rate_of_turn_deg_min: Some(0.0),
            spread_deg: Some(0.4),
            windows: 6,
            ..Sample::new(
                world.time(minute),
                position,
                CompassHeading::new(0.0).unwrap(),
            )
        };
        kept.take(at, passage.course, read, gyro_off, faults, &mut rng);
    }
    let last = kept.samples.last().unwrap();
    let here = field.at(last.position, 0.0).unwrap();
    truth.h_nt = here.h_nt();
    truth.z_nt = here.z_nt;
    Log {
        samples: kept.samples,
        minutes: kept.minutes,
        happened: world.happened,
        truth,
        changed: world.changed,
        start,
        sizes: *faults,
        turns,
    }
}
