//! The tracker: weighs accounts of what happened as rows arrive.

use super::evidence_sums::EvidenceSums;
use super::learning::Learning;
use super::records::{Checkpoint, Detected, Tried};
use crate::constants::{
    ALTERNATIVES, CERTAIN, DAY_ROWS, HOUR_ROWS, KEPT_CHECKPOINT_ROWS, KEPT_ROWS, LOOK_ROWS,
    NEGLIGIBLE, SAME_S, UNCERTAIN,
};
use crate::hypotheses::hypothesis::{Begin, Hypothesis, Read};
use crate::hypotheses::kinds::{Kind, Stay};
use crate::hypotheses::starts::starts;
use crate::state_space::levels::Levels;
use crate::state_space::row::{PORT_GAP_S, Placed, Row, RowMaker};
use crate::state_space::ship_state::ShipState;
use crate::state_space::transition::Transition;
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::azimuth::Azimuth;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Accounts of what happened to a ship, by the rows so far.
#[derive(Serialize, Deserialize)]
pub(crate) struct Tracker {
    maker: RowMaker,
    reference_sd_deg: f64,
    prior: ShipPrior,
    pub(crate) learning: Learning,
    /// Hypotheses; the first leads.
    pub(crate) bank: Vec<Hypothesis>,
    pub(super) rows: VecDeque<Row>,
    /// Number of the first row kept, and of all rows.
    pub(super) first_kept: usize,
    pub(crate) count: usize,
    pub(super) sums: EvidenceSums,
    /// Checkpoints in order of time; large, and some between are dropped.
    pub(super) checkpoints: VecDeque<Box<Checkpoint>>,
    /// Events that were supposed and weighed since the lead began.
    pub(super) tried: Vec<Tried>,
    pub(crate) detected: Vec<Detected>,
}

/// Row as the lead predicted and read it.
pub(crate) struct Tracked {
    pub(crate) read: Read,
    pub(crate) row: Row,
}

impl Tracker {
    pub(crate) fn new(reference_sd_deg: f64, prior: &ShipPrior) -> Tracker {
        Tracker {
            maker: RowMaker::new(),
            reference_sd_deg,
            prior: prior.clone(),
            learning: Learning::new(),
            bank: Vec::new(),
            rows: VecDeque::new(),
            first_kept: 0,
            count: 0,
            sums: EvidenceSums::default(),
            checkpoints: VecDeque::new(),
            tried: Vec::new(),
            detected: Vec::new(),
        }
    }

    /// Reads the next sample.
    pub(crate) fn read(&mut self, placed: &Placed<'_>) -> Option<Tracked> {
        let row = self.maker.row(placed)?;
        if self.bank.is_empty() {
            self.bank = starts(
                &row,
                self.learning.levels(),
                self.reference_sd_deg,
                &self.prior,
            );
            self.learning.restart(&self.bank[0]);
        }
        self.keep_checkpoint(&row);
        self.suppose_endings(&row);
        if self.count.is_multiple_of(DAY_ROWS) {
            self.suppose_drift(&self.begin(&row));
        }
        let tracked = self.read_all(&row);
        self.rows.push_back(row);
        self.count += 1;
        if self.rows.len() > KEPT_ROWS {
            self.rows.pop_front();
            self.first_kept += 1;
            let oldest = self.rows[0].time;
            self.tried.retain(|tried| tried.from >= oldest);
            while self
                .checkpoints
                .front()
                .is_some_and(|c| c.after < self.first_kept)
            {
                self.checkpoints.pop_front();
            }
        }
        if self.count.is_multiple_of(LOOK_ROWS) {
            self.suppose_events();
        }
        self.prune();
        self.settle(placed.sample.time);
        self.detect(placed.sample.time);
        Some(tracked)
    }

    /// Reads an azimuth after the last row. Returns false if none is near it in time.
    pub(crate) fn read_azimuth(&mut self, azimuth: &Azimuth) -> bool {
        let Some(row) = self.rows.back().cloned() else {
            return false;
        };
        if azimuth.time().seconds_since(row.time).abs() > SAME_S {
            return false;
        }
        for hypothesis in &mut self.bank {
            hypothesis.read_azimuth(azimuth, &row);
        }
        self.learning.read_azimuth(azimuth, &row);
        true
    }

    /// Returns the circumstances of what begins between the last row and the next.
    fn begin(&self, row: &Row) -> Begin {
        let last = self.rows.back().unwrap_or(row);
        let recent = self
            .checkpoints
            .back()
            .filter(|_| !row.after_port && !self.count.is_multiple_of(HOUR_ROWS));
        Begin {
            time: last.time,
            ship: recent.map_or_else(|| self.ship(last), |recent| recent.begin.ship.clone()),
            row: last.clone(),
            in_port: row.after_port,
        }
    }

    /// Returns the ship by all hypotheses.
    pub(super) fn ship(&self, row: &Row) -> ShipState {
        self.mixed(|hypothesis| ShipState::from_filter(&hypothesis.filter, row))
    }

    /// Returns the mixture of the ships of plausible hypotheses.
    fn mixed(&self, ship: impl Fn(&Hypothesis) -> ShipState) -> ShipState {
        let best = self.best();
        let bank = self.bank.iter();
        let plausible = bank.filter(|h| h.log_weight() > best - NEGLIGIBLE);
        let weighed = plausible.map(|h| ((h.log_weight() - best).exp(), ship(h)));
        let (weights, states): (Vec<f64>, Vec<ShipState>) = weighed.unzip();
        ShipState::mixed(&states, &weights)
    }

    /// Returns the ship after the last row, if there was one.
    pub(crate) fn current_ship(&self) -> Option<ShipState> {
        self.rows.back().map(|row| self.ship(row))
    }

    /// Returns the ship from the last row until she has sailed from her next port, what a call
    /// does to her included, if there was a row.
    pub(crate) fn ship_until_sailing(&self) -> Option<ShipState> {
        let row = self.rows.back()?;
        Some(self.mixed(|hypothesis| {
            let filter = hypothesis.after_call(self.levels());
            ShipState::from_filter(&filter, row)
        }))
    }

    fn keep_checkpoint(&mut self, row: &Row) {
        let begin = self.begin(row);
        let time = begin.time;
        if let Some(old) = self.checkpoints.len().checked_sub(2 * HOUR_ROWS)
            && let Some(checkpoint) = self.checkpoints.get(old)
            && !(checkpoint.before_gap || checkpoint.after.is_multiple_of(HOUR_ROWS))
        {
            self.checkpoints.remove(old);
        }
        self.checkpoints.push_back(Box::new(Checkpoint {
            after: self.count,
            time,
            plausible: self.plausible(),
            sums: self.sums,
            begin,
            before_gap: row.seconds > PORT_GAP_S,
        }));
    }

    /// Returns the lead with the hypotheses that are about as likely: what happens next may
    /// happen under each.
    fn plausible(&self) -> Vec<Hypothesis> {
        let best = self.best();
        let others = self.bank[1..].iter();
        let others = others.filter(|h| h.log_weight() > best - UNCERTAIN);
        let lead = std::iter::once(&self.bank[0]);
        lead.chain(others.take(ALTERNATIVES)).cloned().collect()
    }

    fn read_all(&mut self, row: &Row) -> Tracked {
        let levels = *self.learning.levels();
        let usual = Transition::to(row, &levels);
        self.learning.prepare(&self.bank[0]);
        let mut leads = None;
        let best = self.best();
        let mut wild = Vec::new();
        for (i, hypothesis) in self.bank.iter_mut().enumerate() {
            let before = hypothesis.filter.log_likelihood;
            let is_plausible = hypothesis.log_weight() > best - NEGLIGIBLE;
            let untaught = (is_plausible && hypothesis.may_teach()).then(|| hypothesis.clone());
            let read = hypothesis.read(row, &levels, &usual);
            if let Some(untaught) = untaught.filter(|_| read.teaches()) {
                wild.push(untaught.after_wild(self.count, row, &levels, &usual));
            }
            if i == 0 {
                let gained = hypothesis.filter.log_likelihood - before;
                leads = Some((read, gained));
            }
        }
        self.bank.extend(wild);
        let (read, gained) = leads.expect("the bank is never empty");
        let is_certain = self.is_settled();
        self.learning.read(row, &usual, gained, is_certain);
        self.sums.add(row, &read);
        Tracked {
            read,
            row: row.clone(),
        }
    }

    /// Returns true while the lead is alone in what it supposes.
    fn is_settled(&self) -> bool {
        let lead = &self.bank[0];
        let best = lead.log_weight();
        lead.lasting().all(Kind::changes_deviation)
            && self.bank[1..].iter().all(|other| {
                other.events.len() == lead.events.len() || other.log_weight() < best - CERTAIN
            })
    }

    fn suppose_endings(&mut self, row: &Row) {
        if row.after_port || self.count.is_multiple_of(HOUR_ROWS) {
            self.suppose_endings_of(row, HOUR_ROWS, |kind| !kind.ends_at_once());
        }
        self.suppose_endings_of(row, 1, Kind::ends_at_once);
    }

    /// Supposes that events of some kinds ended within the last rows.
    fn suppose_endings_of(&mut self, row: &Row, rows: usize, is_meant: impl Fn(Kind) -> bool) {
        let lasts = |h: &Hypothesis| h.lasting().any(&is_meant);
        if !self.bank.iter().any(lasts) {
            return;
        }
        let begin = self.begin(row);
        let rows = rows as f64;
        let step = Stay {
            seconds: rows * row.seconds.clamp(60.0, 3600.0),
            miles: rows * row.miles.clamp(0.2, 15.0),
            calls: 0,
        };
        let best = self.best();
        let mut ended: Vec<Hypothesis> = Vec::new();
        for hypothesis in &self.bank {
            if hypothesis.log_weight() > best - NEGLIGIBLE {
                ended.extend(hypothesis.endings(&begin, step, &is_meant));
            }
        }
        self.bank.extend(ended);
    }

    pub(super) fn best(&self) -> f64 {
        let weights = self.bank.iter().map(Hypothesis::log_weight);
        weights.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Gives up what a kept state need not have: accounts that change no result, and checkpoints
    /// closer together than an event is dated by later rows. Rounds all filters to what is kept.
    pub(crate) fn condense(&mut self) {
        let best = self.best();
        let lead = self.bank.first().map(Hypothesis::log_weight);
        self.bank.retain(|hypothesis| {
            let weight = hypothesis.log_weight();
            Some(weight) == lead || weight > best - NEGLIGIBLE
        });
        let latest = self.checkpoints.back().map(|checkpoint| checkpoint.after);
        self.checkpoints.retain(|checkpoint| {
            checkpoint.before_gap
                || checkpoint.after.is_multiple_of(KEPT_CHECKPOINT_ROWS)
                || Some(checkpoint.after) == latest
        });
        let checkpoints = self.checkpoints.iter_mut();
        let plausible = checkpoints.flat_map(|checkpoint| &mut checkpoint.plausible);
        for hypothesis in self.bank.iter_mut().chain(plausible) {
            hypothesis.filter.round();
        }
        self.learning.round();
    }

    /// Returns what is known of ships like her.
    pub(crate) fn prior(&self) -> &ShipPrior {
        &self.prior
    }

    /// Returns the levels learnt.
    pub(crate) fn levels(&self) -> &Levels {
        self.learning.levels()
    }
}
