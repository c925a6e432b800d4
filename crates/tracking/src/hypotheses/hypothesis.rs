//! One account of what happened: a filter, and the events that it supposes.

use super::kinds::{Course, Ending, Jump, Kind, REALIGNMENT, Stay, WORK};
use crate::constants::{AMID_DEG, HELD_DEG, OPEN_DEG, TEACHES, WILD};
use crate::state_space::filter::{Filter, Innovation, Marginal};
use crate::state_space::levels::{Level, Levels};
use crate::state_space::row::Row;
use crate::state_space::scalar::{
    SAYS_NOTHING_DEG, Scalar, Silent, deviation, difference, sighted_deviation, sighted_gyro,
};
use crate::state_space::ship_state::ShipState;
use crate::state_space::states::{ALIGNMENT, BX, BY, GYRO, STATES, USUAL_H_NT};
use crate::state_space::transition::Transition;
use binnacle_analysis::estimate::POPULATION_SD;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::azimuth::{Azimuth, AzimuthKind};
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::ship::PARAMETERS;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};
use std::ops::Deref;
use std::sync::Arc;

/// Supposed event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Event {
    pub(crate) kind: Kind,
    /// Time of the last row before it.
    pub(crate) from: Timestamp,
    /// First row after its end.
    pub(crate) until: Option<Timestamp>,
    /// States before it, for its end.
    pub(crate) before: Option<Box<Marginal>>,
    /// Ship before it, and before its end.
    pub(crate) ship_before: Box<ShipState>,
    pub(crate) ship_at_end: Option<Box<ShipState>>,
    /// True if the ship was in port meanwhile.
    pub(crate) in_port: bool,
    /// Heading at which a failed instrument stands, degrees; none of one that shows any.
    pub(crate) held_deg: Option<f64>,
    /// Distance sailed before it, nautical miles, and port calls until it began.
    pub(crate) from_nm: f64,
    pub(crate) from_call: u32,
}

impl Event {
    /// Returns the stay from its beginning to a row.
    fn stay_until(&self, row: &Row) -> Stay {
        Stay {
            seconds: row.time.seconds_since(self.from),
            miles: row.sailed_nm - self.from_nm,
            calls: row.calls.saturating_sub(self.from_call),
        }
    }
}

/// Event with its probability under a hypothesis: less than one where hypotheses with and
/// without it have become one.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Supposed {
    #[serde(with = "kept_event")]
    pub(crate) event: Arc<Event>,
    pub(crate) probability: f64,
}

/// Form in which an event is kept: without what other hypotheses share it.
mod kept_event {
    use super::Event;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::sync::Arc;

    pub(super) fn serialize<S: Serializer>(event: &Arc<Event>, to: S) -> Result<S::Ok, S::Error> {
        event.as_ref().serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Arc<Event>, D::Error> {
        Event::deserialize(from).map(Arc::new)
    }
}

impl Supposed {
    /// Returns true if the hypothesis rather has the event than not.
    pub(crate) fn is_likely(&self) -> bool {
        self.probability > 0.5
    }
}

impl Deref for Supposed {
    type Target = Event;

    fn deref(&self) -> &Event {
        &self.event
    }
}

/// Circumstances in which an event begins or ends.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Begin {
    /// Time of the last row before.
    pub(crate) time: Timestamp,
    /// Ship until then.
    pub(crate) ship: ShipState,
    /// Last row before.
    pub(crate) row: Row,
    /// True if the ship was in port meanwhile.
    pub(crate) in_port: bool,
}

/// Account of what happened.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Hypothesis {
    pub(crate) filter: Filter,
    pub(crate) events: Vec<Supposed>,
    /// Logarithm of the prior probability of its events.
    pub(crate) log_prior: f64,
    /// Number of the starting guess that it descends from.
    pub(crate) start: usize,
    /// Level that is larger on this ship than the levels have it, if one is.
    pub(crate) lively: Option<Level>,
    /// Row whose reading it holds to be wild, the last one.
    pub(crate) wild: Option<usize>,
    /// Event that began or ended in the next row.
    pub(crate) amid: Option<Kind>,
}

/// Innovations of a row, with the loads that they had.
#[derive(Clone, Debug)]
pub(crate) struct Read {
    pub(crate) difference: Option<Innovation>,
    pub(crate) deviation: Innovation,
    pub(crate) load: Scalar,
}

impl Read {
    /// Returns the loss of the row: one wild instrument spoils all that it is compared with.
    fn loss(&self) -> f64 {
        let both = [Some(self.deviation), self.difference];
        let losses = both.iter().flatten().map(|innovation| innovation.loss());
        let worst = both
            .iter()
            .flatten()
            .map(|innovation| wild_loss(*innovation));
        losses.sum::<f64>().min(worst.fold(0.0, f64::max))
    }

    /// Returns true if the row says more than was known before: then a wild reading would do
    /// harm that later ones take long to mend.
    pub(crate) fn teaches(&self) -> bool {
        self.deviation.variance > TEACHES * self.load.variance
    }
}

/// Returns the loss of a reading that is wild: it is improbable, and then says nothing.
fn wild_loss(innovation: Innovation) -> f64 {
    let says_nothing = SAYS_NOTHING_DEG * SAYS_NOTHING_DEG;
    (says_nothing / innovation.variance).max(1.0).ln() - 2.0 * WILD.ln()
}

impl Row {
    /// Returns how far a failed instrument is off, nearly: by the other reference, or by the
    /// deviation that is left.
    fn missed_deg(&self, kind: Kind, read: &Read) -> f64 {
        match (kind, self.gyro_deg, self.satellite_deg) {
            (Kind::FailedGyro | Kind::FailedSatellite, Some(gyro), Some(satellite)) => {
                wrap_180(gyro - satellite)
            }
            _ => read.deviation.value,
        }
    }
}

impl Hypothesis {
    /// Returns true if a row may teach much of the ship.
    pub(crate) fn may_teach(&self) -> bool {
        let p = &self.filter.covariance;
        let permanent_deg = (POPULATION_SD[BX] / USUAL_H_NT).to_degrees();
        let variance = permanent_deg.powi(2) * (p[BX][BX] + p[BY][BY]) + p[ALIGNMENT][ALIGNMENT];
        variance > OPEN_DEG * OPEN_DEG && self.learns_the_ship()
    }

    /// Returns true if what a row teaches now is the ship and not some passing error.
    fn learns_the_ship(&self) -> bool {
        let passing = |kind: Kind| kind.passes_by() || kind == Kind::GyroSettling;
        !self.silent().compass && !self.lasting().any(passing)
    }

    /// Returns the logarithm of its weight, to be compared with others' of the same rows.
    pub(crate) fn log_weight(&self) -> f64 {
        self.log_prior + self.filter.log_likelihood
    }

    /// Returns the kinds of its events that last.
    pub(crate) fn lasting(&self) -> impl Iterator<Item = Kind> {
        let lasting = self.events.iter().filter(|event| event.until.is_none());
        lasting.map(|event| event.kind)
    }

    pub(crate) fn has(&self, kind: Kind) -> bool {
        self.lasting().any(|lasting| lasting == kind)
    }

    fn silent(&self) -> Silent {
        Silent {
            compass: self.has(Kind::FailedCard),
            gyro: self.has(Kind::FailedGyro),
            satellite: self.has(Kind::FailedSatellite),
        }
    }

    /// Reads the next row.
    pub(crate) fn read(&mut self, row: &Row, levels: &Levels, usual: &Transition) -> Read {
        self.read_with(row, levels, usual, self.silent())
    }

    /// Returns the hypothesis after a row whose compass reading is wild.
    pub(crate) fn after_wild(
        &self,
        number: usize,
        row: &Row,
        levels: &Levels,
        usual: &Transition,
    ) -> Hypothesis {
        let mut next = self.clone();
        let silent = Silent {
            compass: true,
            ..self.silent()
        };
        next.read_with(row, levels, usual, silent);
        next.log_prior += WILD.ln();
        next.wild = Some(number);
        next
    }

    fn read_with(
        &mut self,
        row: &Row,
        levels: &Levels,
        usual: &Transition,
        silent: Silent,
    ) -> Read {
        self.survive(row);
        let lively = self.lively.map(|level| levels.of_lively(level));
        let own_usual = lively.as_ref().map(|lively| Transition::to(row, lively));
        let levels = lively.as_ref().unwrap_or(levels);
        let usual = own_usual.as_ref().unwrap_or(usual);
        let mut own;
        let transition = if self.events.iter().all(|event| event.until.is_some()) {
            usual
        } else {
            own = usual.clone();
            self.adjust(&mut own, row);
            &own
        };
        self.filter.advance(transition);
        // Part of the row in which something jumps lies before, and part after.
        let amid = self.amid.take();
        let amid_variance = |is_moved: bool| if is_moved { AMID_DEG * AMID_DEG } else { 0.0 };
        let by_difference = difference(row, &self.filter.mean, levels, silent)
            .filter(|_| !(silent.gyro || silent.satellite))
            .map(|mut scalar| {
                scalar.variance += amid_variance(amid.is_some_and(Kind::moves_a_reference));
                self.filter.update(&scalar)
            });
        let mut load = deviation(row, &self.filter.mean, levels, silent);
        load.variance += amid_variance(amid.is_some());
        let read = Read {
            difference: by_difference,
            deviation: if self.holds(row) {
                self.filter.innovation(&load)
            } else {
                self.filter.update(&load)
            },
            load,
        };
        let loss = if self.holds(row) {
            read.difference.map_or(0.0, Innovation::loss)
        } else {
            read.loss()
        };
        self.filter.log_likelihood -= 0.5 * loss;
        self.read_failed(row, &read);
        read
    }

    /// Reads an azimuth in the circumstances of the last row. Alongside a quay it checks the gyro
    /// alone: the berth's steel moves the compass.
    pub(crate) fn read_azimuth(&mut self, azimuth: &Azimuth, row: &Row) {
        let mut losses = 0.0;
        let mut read = |innovation: Innovation| {
            losses += innovation.loss().min(wild_loss(innovation));
        };
        if azimuth.kind() != AzimuthKind::Quay && !self.has(Kind::FailedCard) {
            let scalar = sighted_deviation(row, &self.filter.mean, azimuth);
            read(self.filter.update(&scalar));
        }
        if let Some(scalar) = sighted_gyro(row, &self.filter.mean, azimuth)
            && !self.has(Kind::FailedGyro)
        {
            read(self.filter.update(&scalar));
        }
        self.filter.log_likelihood -= 0.5 * losses;
    }

    /// Returns the filter after a port call like her others.
    pub(crate) fn after_call(&self, levels: &Levels) -> Filter {
        let lively = self.lively.map(|level| levels.of_lively(level));
        let mut filter = self.filter.clone();
        filter.advance(&Transition::by_call(lively.as_ref().unwrap_or(levels)));
        filter
    }

    /// Returns true if an instrument has failed without which the row shows no deviation.
    fn holds(&self, row: &Row) -> bool {
        match (row.gyro_deg, row.satellite_deg) {
            _ if self.has(Kind::FailedCard) => true,
            (Some(_), None) => self.has(Kind::FailedGyro),
            (None, Some(_)) => self.has(Kind::FailedSatellite),
            _ => false,
        }
    }

    /// Reads what failed instruments show: the same as before, or any heading.
    fn read_failed(&mut self, row: &Row, read: &Read) {
        let lasting = self.events.iter().filter(|event| event.until.is_none());
        let losses = lasting.filter_map(|event| {
            let shown_deg = row.shown_deg(event.kind)?;
            let (value, sd) = match event.held_deg {
                Some(held_deg) => (wrap_180(shown_deg - held_deg), HELD_DEG),
                None => (row.missed_deg(event.kind, read), SAYS_NOTHING_DEG),
            };
            let variance = sd * sd;
            Some(Innovation { value, variance }.loss() + variance.ln())
        });
        self.filter.log_likelihood -= 0.5 * losses.sum::<f64>();
    }

    /// Counts how improbable it is that its lasting events go on until a row.
    fn survive(&mut self, row: &Row) {
        let lasting = self.events.iter().filter(|event| event.until.is_none());
        let survivals = lasting.map(|event| {
            let after = event.stay_until(row);
            let before = Stay {
                seconds: after.seconds - row.seconds,
                miles: after.miles - row.miles,
                calls: after.calls.saturating_sub(u32::from(row.after_port)),
            };
            event.kind.row().ending.log_survival(before, after)
        });
        self.log_prior += survivals.sum::<f64>();
    }

    fn adjust(&self, transition: &mut Transition, row: &Row) {
        let seconds = row.seconds;
        for kind in self.lasting() {
            match kind.row().course {
                Course::Still => {}
                Course::Growing => transition.grow(seconds / 86_400.0),
                Course::Wandering(deg2_per_s) => transition.added[GYRO] += deg2_per_s * seconds,
                Course::Storming { sd_deg, memory_s } => {
                    transition.disturb(seconds / memory_s, sd_deg);
                }
                Course::Passing { sd_deg, memory_s } => {
                    transition.pass_anomaly(seconds / memory_s, sd_deg);
                }
            }
        }
    }

    /// Returns the hypothesis with one more event.
    pub(crate) fn with_event(&self, kind: Kind, begin: &Begin, log_prior: f64) -> Hypothesis {
        self.with_failure(kind, begin, None, log_prior)
    }

    /// Returns the hypothesis with one more event, in which an instrument stands at a heading.
    pub(crate) fn with_failure(
        &self,
        kind: Kind,
        begin: &Begin,
        held_deg: Option<f64>,
        log_prior: f64,
    ) -> Hypothesis {
        let mut next = self.clone();
        let states = kind.returning_states();
        let before =
            (!states.is_empty()).then(|| Box::new(Marginal::from_filter(&self.filter, &states)));
        for jump in kind.row().jumps {
            next.filter.covariance[jump.state][jump.state] += jump.sd * jump.sd;
        }
        let event = Event {
            kind,
            from: begin.time,
            until: None,
            before,
            ship_before: Box::new(begin.ship.clone()),
            ship_at_end: None,
            in_port: begin.in_port,
            held_deg,
            from_nm: begin.row.sailed_nm,
            from_call: begin.row.calls + u32::from(begin.in_port),
        };
        next.events.push(Supposed {
            event: Arc::new(event),
            probability: 1.0,
        });
        next.amid = kind.is_sudden().then_some(kind);
        next.log_prior += log_prior;
        next
    }

    /// Forgets what work on ship or compass undid.
    pub(crate) fn renew(&mut self, kind: LogbookKind) {
        let mut free = |jump: &Jump| {
            self.filter.covariance[jump.state][jump.state] += jump.sd * jump.sd;
        };
        if kind.preserves_soft_iron() {
            WORK.iter().for_each(free);
        } else {
            free(&REALIGNMENT);
            let states: Vec<usize> = (0..PARAMETERS).collect();
            let anew = Filter::new(&[0.0; STATES], &[1.0; STATES]);
            self.filter.restore(&Marginal::from_filter(&anew, &states));
        }
    }

    /// Returns the hypotheses in which one of the lasting events of some kinds ended within the
    /// step before the next row.
    pub(crate) fn endings(
        &self,
        begin: &Begin,
        step: Stay,
        is_meant: impl Fn(Kind) -> bool,
    ) -> Vec<Hypothesis> {
        let lasting = self.events.iter().enumerate();
        let lasting = lasting.filter(|(_, e)| e.until.is_none() && is_meant(e.kind));
        let ended = lasting.filter_map(|(i, event)| {
            let stay = event.stay_until(&begin.row);
            let probability = match event.kind.row().ending {
                ending @ Ending::InPort { .. } if begin.in_port => {
                    event.probability * ending.probability_at_call(stay.calls + 1)
                }
                Ending::Never | Ending::InPort { .. } => return None,
                ending => ending.probability(stay, step),
            };
            (probability > 0.0).then(|| self.with_end(i, begin, probability.ln()))
        });
        ended.collect()
    }

    pub(crate) fn with_end(&self, event: usize, begin: &Begin, log_prior: f64) -> Hypothesis {
        let mut next = self.clone();
        let ended = Arc::make_mut(&mut next.events[event].event);
        ended.until = Some(begin.time);
        ended.ship_at_end = Some(Box::new(begin.ship.clone()));
        if let Some(before) = ended.before.take() {
            next.filter.restore(&before);
            next.amid = ended.kind.is_sudden().then_some(ended.kind);
        }
        next.log_prior += log_prior;
        next
    }
}
