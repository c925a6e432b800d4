//! Incidents to compass, references and ship that have a course of their own: faults that
//! creep or fade, strikes that follow each other, a stay in dry dock.

use super::errors::Errors;
use super::fleet::Moment;
use super::plan::{Happened, Name};
use super::{Truth, gauss};
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::time::Timestamp;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Difference between the seeds of the passage and of the incidents.
const STREAM: u64 = 0x71b5_0000_2e99_0000;
/// Minutes after the first strike at which the two others follow.
const FOLLOWING_STRIKES: [i64; 2] = [300, 840];
/// Duration of a storm with a strike in it, minutes, and the part of it without samples.
const STORM_MINUTES: i64 = 720;
const SILENT_MINUTES: std::ops::Range<i64> = 180..540;
/// Minutes in which the part of a dry dock's magnetism that is left falls by e: 30 days.
const DOCK_MINUTES: f64 = 43_200.0;

/// Incident in the week after the plan's day of the event.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Incident {
    #[default]
    Nothing,
    /// The compass's zero moves by so many degrees at sea.
    ZeroMoved(f64),
    /// The card jams on a steady course, for one to two days.
    Jam,
    /// The gyro sails two to four degrees off, and settles over one to several hours.
    Settling,
    /// The gyro creeps by so many degrees a day, for four to six days.
    GyroRamp(f64),
    /// Three strikes of so many nT within a day.
    Strikes(f64),
    /// A strike of so many nT in six hours without samples, under a storm.
    StrikeInStorm(f64),
    /// A step of so many nT in dry dock, in the logbook, that decays.
    DryDock(f64),
}

/// Course of the planned incident.
pub(super) struct Incidents {
    incident: Incident,
    due: i64,
    start: Timestamp,
    /// First minute, once it has begun.
    began: Option<i64>,
    /// Side, size and duration as drawn, each for a scale of its own.
    side: f64,
    share: f64,
    /// Direction of the first step, radians.
    direction: f64,
    rng: ChaCha8Rng,
    jammed_at: Option<f64>,
    fading: [f64; 2],
    pub(super) happened: Vec<Happened>,
    pub(super) logbook: Vec<LogbookEntry>,
}

impl Incidents {
    pub(super) fn new(seed: u64, incident: Incident, day: f64, start: Timestamp) -> Incidents {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ STREAM);
        Incidents {
            incident,
            due: (day * 1440.0) as i64,
            start,
            began: None,
            side: if gauss(&mut rng) > 0.0 { 1.0 } else { -1.0 },
            share: rng.random(),
            direction: TAU * rng.random::<f64>(),
            rng,
            jammed_at: None,
            fading: [0.0; 2],
            happened: Vec::new(),
            logbook: Vec::new(),
        }
    }

    /// Begins the incident at its time, and carries it on.
    pub(super) fn minute(&mut self, now: &Moment, truth: &mut Truth, errors: &mut Errors) {
        if self.began.is_none() && now.minute >= self.due && self.may_begin(now) {
            self.began = Some(now.minute);
            self.begin(now, truth, errors);
        }
        self.strike(now, truth);
        for (left, b) in self
            .fading
            .iter_mut()
            .zip([&mut truth.parameters.bx_nt, &mut truth.parameters.by_nt])
        {
            let lost = *left / DOCK_MINUTES;
            *left -= lost;
            *b -= lost;
        }
    }

    fn may_begin(&self, now: &Moment) -> bool {
        let at_sea = now.at_sea_minutes > 600;
        match self.incident {
            Incident::Nothing => false,
            Incident::Settling => now.at_sea_minutes == 1,
            Incident::DryDock(_) => now.arrived,
            Incident::Jam => at_sea && now.is_steady,
            _ => at_sea,
        }
    }

    fn begin(&mut self, now: &Moment, truth: &mut Truth, errors: &mut Errors) {
        match self.incident {
            Incident::ZeroMoved(degrees) => {
                truth.alignment_deg += self.side * degrees;
                self.note(Name::ZeroMoved, now.minute, None);
            }
            Incident::Jam => {
                let minutes = (1440.0 * (1.0 + self.share)) as i64;
                self.note(Name::Jam, now.minute, Some(minutes));
            }
            Incident::Settling => {
                let minutes = (3.0 * self.settling_minutes()) as i64;
                self.note(Name::Settling, now.minute, Some(minutes));
            }
            Incident::GyroRamp(_) => {
                let minutes = self.ramp_minutes() as i64;
                self.note(Name::GyroRamp, now.minute, Some(minutes));
            }
            Incident::StrikeInStorm(_) => errors.storm_minutes = STORM_MINUTES as f64,
            Incident::DryDock(nt) => {
                self.fading = self.step(nt, truth);
                self.note(Name::DryDock, now.minute, None);
                self.enter_dock(now);
            }
            Incident::Strikes(_) | Incident::Nothing => {}
        }
    }

    /// Strikes where a strike is due.
    fn strike(&mut self, now: &Moment, truth: &mut Truth) {
        let Some(since) = self.since(now) else { return };
        let nt = match self.incident {
            Incident::Strikes(nt) if since == 0 || FOLLOWING_STRIKES.contains(&since) => nt,
            Incident::StrikeInStorm(nt) if since == STORM_MINUTES / 2 => nt,
            _ => return,
        };
        self.step(nt, truth);
        self.note(Name::Lightning, now.minute, None);
        self.direction = TAU * self.rng.random::<f64>();
    }

    fn step(&self, nt: f64, truth: &mut Truth) -> [f64; 2] {
        let (sin, cos) = self.direction.sin_cos();
        truth.parameters.bx_nt += nt * cos;
        truth.parameters.by_nt += nt * sin;
        [nt * cos, nt * sin]
    }

    /// Returns true while no samples are kept.
    pub(super) fn is_silent(&self, now: &Moment) -> bool {
        let since = self.since(now);
        matches!(self.incident, Incident::StrikeInStorm(_))
            && since.is_some_and(|since| SILENT_MINUTES.contains(&since))
    }

    /// Returns the readings of compass, gyro and satellite compass with the faults.
    pub(super) fn read(&mut self, now: &Moment, read: [f64; 3]) -> [f64; 3] {
        let Some(since) = self.since(now) else {
            return read;
        };
        let [compass, gyro, satellite] = read;
        let since = since as f64;
        match self.incident {
            Incident::Jam if since < 1440.0 * (1.0 + self.share) => {
                let jammed_at = *self.jammed_at.get_or_insert(compass);
                [jammed_at, gyro, satellite]
            }
            Incident::Settling => {
                let left = (-since / self.settling_minutes()).exp();
                let off = self.side * (2.0 + 2.0 * self.share) * left;
                [compass, gyro + off, satellite]
            }
            Incident::GyroRamp(a_day) if since < self.ramp_minutes() => [
                compass,
                gyro + self.side * a_day * since / 1440.0,
                satellite,
            ],
            _ => read,
        }
    }

    fn since(&self, now: &Moment) -> Option<i64> {
        self.began.map(|began| now.minute - began)
    }

    /// Returns the time constant: one to three hours.
    fn settling_minutes(&self) -> f64 {
        60.0 * 3.0_f64.powf(self.share)
    }

    fn ramp_minutes(&self) -> f64 {
        1440.0 * (4.0 + 2.0 * self.share)
    }

    fn note(&mut self, what: Name, minute: i64, minutes: Option<i64>) {
        self.happened.push(Happened {
            what,
            from: self.time(minute),
            to: minutes.map(|minutes| self.time(minute + minutes)),
        });
    }

    fn enter_dock(&mut self, now: &Moment) {
        self.logbook.push(LogbookEntry {
            from: self.time(now.minute),
            to: Some(self.time(now.minute + now.berth_minutes as i64)),
            kind: LogbookKind::DryDocking,
            cargo: None,
            note: String::new(),
        });
    }

    fn time(&self, minute: i64) -> Timestamp {
        self.start.plus_seconds(60.0 * minute as f64)
    }
}
