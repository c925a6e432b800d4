//! Ships with an event, the samples that an agent would keep, and the truth.
//!
//! The field is the IGRF's, as in the analysis; all else is this folder's own.

use super::habits::HabitState;
use super::incidents::Incidents;
use super::kept::Kept;
pub(crate) use super::plan::{Event, Happened, Name, Plan};
use super::world::{Situation, World, storms};
use super::{Errors, Faults, Passage, Truth, gauss, needle};
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::field::{FieldAt, FieldModel};
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::model::Parameters;
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Time at which every ship sails.
pub(crate) const START: &str = "2026-02-01T00:00:00Z";

pub(crate) struct Log {
    pub(crate) samples: Vec<Sample>,
    /// Minutes of which the samples are means.
    pub(crate) minutes: Vec<Sample>,
    pub(crate) happened: Vec<Happened>,
    pub(crate) logbook: Vec<LogbookEntry>,
    /// The ship at the end, without her habits.
    pub(crate) truth: Truth,
    /// The ship with her habits, once a day.
    pub(crate) states: Vec<State>,
    /// Magnetism just before the planned step or cargo, and just after.
    pub(crate) changed: Option<[Parameters; 2]>,
    /// First minute, the sizes of the errors, and minutes of the turns that disturb the
    /// gyro.
    pub(crate) start: Timestamp,
    pub(crate) sizes: Faults,
    pub(crate) turns: Vec<i64>,
}

/// The ship as her compass feels her at one time, and the field there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) time: Timestamp,
    pub(crate) position: Position,
    pub(crate) truth: Truth,
}

/// Motion of the ship in a minute, and the field about her.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    pub(super) minute: i64,
    /// True in the first minute in port.
    pub(super) arrived: bool,
    pub(super) is_alongside: bool,
    /// True on a course, not in a turn.
    pub(super) is_steady: bool,
    /// Minutes since the last port, and to the end of a stay.
    pub(super) at_sea_minutes: i64,
    pub(super) berth_minutes: f64,
    pub(super) turned_deg: f64,
    pub(super) course_deg: f64,
    pub(super) magnetic_deg: f64,
    pub(super) lat_deg: f64,
    pub(super) speed_kn: f64,
    pub(super) h_nt: f64,
}

/// Place of a ship in a minute, and what she meets there.
struct Met {
    position: Position,
    variation_deg: f64,
    z_nt: f64,
    gyro_off_deg: f64,
}

/// Sails a ship and keeps the samples of its agent.
pub(crate) fn sail_log(seed: u64, plan: &Plan) -> Log {
    let mut sailing = Sailing::new(seed, plan);
    for minute in 0..(plan.days * 1440.0) as i64 {
        sailing.minute(minute);
    }
    sailing.log()
}

/// A ship under way.
struct Sailing<'a> {
    plan: &'a Plan,
    sizes: Faults,
    /// Storms that other ships meet too: first minute and duration.
    shared: Vec<(i64, f64)>,
    rng: ChaCha8Rng,
    truth: Truth,
    passage: Passage,
    errors: Errors,
    world: World,
    field: FieldAt,
    habits: HabitState,
    incidents: Incidents,
    states: Vec<State>,
    kept: Kept,
    turns: Vec<i64>,
    at_sea_minutes: i64,
}

impl Sailing<'_> {
    fn new(seed: u64, plan: &Plan) -> Sailing<'_> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut sizes = plan.faults.of_one_ship(&mut rng);
        let a_month = sizes.storms_per_month;
        let shared = plan.sun.map(|sun| storms(sun, plan.days, a_month));
        if shared.is_some() {
            sizes.storms_per_month = 0.0;
        }
        let mut truth = Truth::for_unknown_vessel(&sizes, &mut rng);
        truth.alignment_deg += plan.habits.zero_off_deg;
        let start = Timestamp::parse(START).unwrap();
        Sailing {
            plan,
            sizes,
            shared: shared.unwrap_or_default(),
            truth,
            passage: Passage::new(plan.variety, &mut rng),
            errors: Errors::new(&sizes, &mut rng),
            rng,
            world: World::new(start),
            field: FieldAt::from_time(FieldModel::Igrf14, start).unwrap(),
            habits: HabitState::new(seed, &plan.habits),
            incidents: Incidents::new(seed, plan.incident, plan.event_day, start),
            states: Vec::new(),
            kept: Kept::default(),
            turns: Vec::new(),
            at_sea_minutes: 0,
        }
    }

    fn minute(&mut self, minute: i64) {
        let turned_deg = self.move_on(minute);
        let is_alongside = self.passage.berth_minutes > 0.0;
        let arrived = is_alongside && self.at_sea_minutes > 0;
        self.at_sea_minutes = if is_alongside {
            0
        } else {
            self.at_sea_minutes + 1
        };
        let (variation_error, gyro_off) = self.meet(minute, arrived);
        let position = Position::new(self.passage.lat, self.passage.lon).unwrap();
        let here = self.field.at(position, 0.0).unwrap();
        let (variation, h, z) = (here.declination().degrees_east(), here.h_nt(), here.z_nt);
        let moment = Moment {
            minute,
            arrived,
            is_alongside,
            is_steady: !is_alongside && self.passage.turning_minutes <= 0.0,
            at_sea_minutes: self.at_sea_minutes,
            berth_minutes: self.passage.berth_minutes,
            turned_deg,
            course_deg: self.passage.course,
            magnetic_deg: self.passage.course - variation,
            lat_deg: self.passage.lat,
            speed_kn: self.passage.speed_kn,
            h_nt: h,
        };
        let felt = self.feel(&moment);
        if minute % 1440 == 0 {
            let (h_nt, z_nt) = (h, z);
            self.states.push(State {
                time: self.world.time(minute),
                position,
                truth: Truth { h_nt, z_nt, ..felt },
            });
        }
        let met = Met {
            position,
            variation_deg: variation + variation_error,
            z_nt: z,
            gyro_off_deg: gyro_off,
        };
        self.read(&moment, &felt, &met);
    }

    /// Moves the ship, her drift and her instruments' errors on, and returns her turn.
    fn move_on(&mut self, minute: i64) -> f64 {
        if minute % 1440 == 0 {
            let noon = self.world.time(minute + 720);
            self.field = FieldAt::from_time(FieldModel::Igrf14, noon).unwrap();
        }
        let turned = self.passage.minute(&mut self.rng);
        if turned.abs() > 20.0 {
            self.turns.push(minute);
        }
        if minute % 60 == 0 {
            let hourly = self.sizes.drift_nt / 720.0_f64.sqrt();
            self.truth.parameters.bx_nt += hourly * gauss(&mut self.rng);
            self.truth.parameters.by_nt += hourly * gauss(&mut self.rng);
        }
        let mut shared = self.shared.iter();
        if let Some((_, minutes)) = shared.find(|(begun, _)| *begun == minute) {
            self.errors.storm_minutes = *minutes;
        }
        self.errors
            .minute(&self.sizes, &self.passage, turned, &mut self.rng);
        turned
    }

    /// Meets the plan's event and chance, and returns the errors of variation and gyro.
    fn meet(&mut self, minute: i64, arrived: bool) -> (f64, f64) {
        let now = Situation {
            arrived,
            at_sea_minutes: self.at_sea_minutes,
            compass_deg: match self.plan.event {
                Event::StepBy(..) => shown_deg(&self.truth, &self.passage, &self.field),
                _ => 0.0,
            },
        };
        let (plan, rng) = (self.plan, &mut self.rng);
        self.world.plan(plan, minute, now, &mut self.truth, rng);
        self.world
            .chance(plan, minute, &self.passage, &self.errors, rng)
    }

    /// Returns the ship as her compass feels her.
    fn feel(&mut self, moment: &Moment) -> Truth {
        self.habits.minute(moment);
        self.incidents
            .minute(moment, &mut self.truth, &mut self.errors);
        self.errors.card_noise = self.habits.card_noise();
        self.habits.felt(&self.truth)
    }

    fn read(&mut self, moment: &Moment, felt: &Truth, met: &Met) {
        if !moment.is_steady || self.incidents.is_silent(moment) {
            self.kept.break_off();
            return;
        }
        let (passage, rng) = (&self.passage, &mut self.rng);
        let field = (met.variation_deg, moment.h_nt, met.z_nt);
        let read = self.errors.read(felt, passage, moment.minute, field, rng);
        let read = self.habits.read(moment, read);
        let read = self.habits.shown(self.incidents.read(moment, read));
        let at = Sample {
            sog_kn: Some(passage.speed_kn),
            rate_of_turn_deg_min: Some(0.0),
            spread_deg: Some(self.habits.spread_deg()),
            windows: 6,
            cog: self.habits.course_over_ground(moment),
            roll_deg: self.habits.measured_roll_deg(),
            ..Sample::new(
                self.world.time(moment.minute),
                met.position,
                CompassHeading::new(0.0).unwrap(),
            )
        };
        self.kept.take(at, read, met.gyro_off_deg, &self.sizes, rng);
    }

    fn log(mut self) -> Log {
        let last = self.kept.samples.last().unwrap();
        let here = self.field.at(last.position, 0.0).unwrap();
        self.truth.h_nt = here.h_nt();
        self.truth.z_nt = here.z_nt;
        self.habits.finish(&mut self.kept.samples);
        let mut happened = self.world.happened;
        happened.append(&mut self.incidents.happened);
        happened.sort_by_key(|h| h.from);
        Log {
            samples: self.kept.samples,
            minutes: self.kept.minutes,
            happened,
            logbook: self.incidents.logbook,
            truth: self.truth,
            states: self.states,
            changed: self.world.changed,
            start: Timestamp::parse(START).unwrap(),
            sizes: self.sizes,
            turns: self.turns,
        }
    }
}

/// Returns the compass's reading with no error but the ship's magnetism.
fn shown_deg(truth: &Truth, passage: &Passage, field: &FieldAt) -> f64 {
    let position = Position::new(passage.lat, passage.lon).unwrap();
    let here = field.at(position, 0.0).unwrap();
    let magnetic = passage.course - here.declination().degrees_east();
    needle(&truth.parameters, magnetic, here.h_nt(), here.z_nt)
}
