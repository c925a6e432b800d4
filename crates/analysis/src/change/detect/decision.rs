//! Whether what leads leads by enough to be believed.

use super::EVERY;
use super::state::{Leads, Search};
use crate::change::event::{Event, What};
use crate::change::filter::Filter;
use crate::change::hypotheses::Lead;
use crate::change::hypothesis_kind::Kind;
use crate::change::port_call_returns::{Base, Candidate};
use crate::observation::Observation;

/// A step must be likelier by this than a burst, nats; or by that, when its lead
/// over nothing is large.
const STEP_NATS: f64 = 10.5;
const STEP_AT_LEAST: f64 = 3.0;
const LARGE_NATS: f64 = 40.0;
/// And it must have lasted for so many rows: the flank of an anomaly is as steep.
const STEP_ROWS: usize = 6;
/// While one of two references is out of use for more than this share of the rows,
/// it must be likelier by that: the one that is left may be the one that fails.
const ONE_REFERENCE_SHARE: f64 = 0.3;
const ONE_REFERENCE_NATS: f64 = 30.0;
/// A reference's step must be likelier by this than a burst, and have lasted for so
/// many rows: one wild reading is no fault.
const REFERENCE_NATS: f64 = 13.5;
const REFERENCE_ROWS: usize = 3;
/// So must a return to what was before, away from port.
const RETURN_AT_SEA_NATS: f64 = 14.0;
/// Cargo is not discharged at sea: what began in port must be likelier by this.
const LOADED_RETURN_AT_SEA_NATS: f64 = 30.0;
/// A return at a port call is believed when it is as likely as this, and unlikelier
/// than a step to something else by no more than that, nats.
const RETURNED: f64 = 0.9;
const RETURN_BELOW_STEP: f64 = 6.0;
/// A step that is certain is one, if it is dated no more than so many rows before the call
/// or after it, the return is as likely as this against none, and unlikelier than the step
/// by no more than that, nats: so soon after a call another step is far the rarer.
const LIKELY: f64 = 0.3;
const BEFORE_CALL: usize = 18;
const AFTER_CALL: usize = 72;
const CERTAIN_RETURN_BELOW_STEP: f64 = 10.0;
/// A burst is unlikelier beforehand than a return at a port call by about this, nats.
const BURST_BELOW_RETURN: f64 = 3.0;
/// With one reference a step of the ship and one of the reference must differ by
/// this; with both there were two readings among so many rows.
const CLEAR_NATS: f64 = 4.0;
const LATELY: usize = 36;
/// A reference that is itself again must be likelier by this than a burst, and no
/// less likely by this than another change.
const MENDED_NATS: f64 = 8.0;
const MENDED_BELOW: f64 = 3.0;
/// A burst must be likelier by this than nothing, and by this than a change.
const BURST_NATS: f64 = 14.0;
pub(crate) const BURST_OVER_STEP: f64 = 3.0;
/// In the first weeks, when the sizes of noise are of few days, either must be likelier
/// by so much more.
const NEW_S: f64 = 20.0 * 86_400.0;
const NEW_NATS: f64 = 3.0;
const CREEPING_NATS: f64 = 10.0;

impl Search<'_> {
    pub(crate) fn judge(&mut self, k: usize) {
        let leads = self.leads();
        let nats = |kind: Kind| leads[kind as usize].map_or(0.0, |lead| lead.nats);
        if k < self.young() {
            return self.judge_passing(k, leads);
        }
        let burst = nats(Kind::Burst).max(0.0);
        let back = nats(Kind::Return);
        if let Some(candidate) = self.candidate(&leads)
            && candidate.probability > RETURNED
        {
            return self.adopt_call(k, candidate, leads);
        }
        if self.misled.is_none() && (self.settle_rivals(k, &leads) || self.settle_doubt(k, &leads))
        {
            return;
        }
        let rival = nats(Kind::Step).max(nats(Kind::Reference));
        if self.misled.is_some() && back - burst > MENDED_NATS && back > rival - MENDED_BELOW {
            return self.adopt_mended(k, leads);
        }
        let earlier = self.calls.bases.last();
        let enough = if self.misaligned.is_none() && earlier.is_some_and(Base::began_at_port) {
            LOADED_RETURN_AT_SEA_NATS
        } else {
            RETURN_AT_SEA_NATS
        };
        if self.misled.is_none() && back - burst > enough && back > nats(Kind::Step) {
            return self.adopt_return(k, leads);
        }
        let (kind, lasting, other) = if nats(Kind::Step) >= nats(Kind::Reference) {
            (Kind::Step, nats(Kind::Step), nats(Kind::Reference))
        } else {
            (Kind::Reference, nats(Kind::Reference), nats(Kind::Step))
        };
        let over_burst = lasting - burst;
        // One reference on one heading cannot tell a fault of its own from a change
        // of the ship.
        let clear = lasting - self.beforehand_nats(kind, &leads) - other.max(0.0);
        let is_clear = clear > CLEAR_NATS || self.has_both(k);
        let is_told = is_clear
            && match kind {
                Kind::Reference => {
                    self.has_lasted(REFERENCE_ROWS, kind, k, &leads) && over_burst > REFERENCE_NATS
                }
                _ => {
                    self.has_lasted(STEP_ROWS, kind, k, &leads)
                        && self.is_step(k, lasting, over_burst, &leads)
                }
            };
        if is_told {
            let back = self.candidate_below(&leads, CERTAIN_RETURN_BELOW_STEP);
            if let Some(back) = back.filter(|back| self.is_at_call(&leads, back))
                && kind == Kind::Step
            {
                return self.adopt_call(k, back, leads);
            }
            if kind == Kind::Step && self.is_discharge(k, &leads) {
                return self.adopt_return(k, leads);
            }
            return self.adopt(k, kind, leads);
        }
        self.judge_passing(k, leads);
    }

    /// Whether the field is astray, for what lasts has not been told.
    fn judge_passing(&mut self, k: usize, leads: Leads) {
        let nats = |kind: Kind| leads[kind as usize].map_or(0.0, |lead| lead.nats);
        let burst = nats(Kind::Burst);
        let lasting = nats(Kind::Step).max(nats(Kind::Reference));
        if self.burst.is_none()
            && burst > BURST_NATS + self.unlearnt_nats(k)
            && burst - lasting > BURST_OVER_STEP
            && leads[Kind::Burst as usize].is_some_and(|lead| self.is_no_few_readings(k, lead))
        {
            let Some(lead) = leads[Kind::Burst as usize] else {
                return;
            };
            let first = self.began(lead);
            match self.same_burst(first) {
                // One that has had its time keeps its lead, but is told once.
                Some(event) if event.confirmed => return,
                Some(_) => _ = self.events.pop(),
                None => {}
            }
            self.burst = Some(self.events.len());
            self.passed = self.before(first);
            self.faint = None;
            self.push(k, What::Burst, first, (first, first), leads, None);
        } else {
            self.note_faint(k, leads, burst - lasting);
        }
    }

    /// A few wild readings swing no compass.
    fn is_no_few_readings(&self, k: usize, lead: Lead) -> bool {
        lead.kind != Kind::Wild || k + 1 >= self.bank.spawns[lead.spawn].at + STEP_ROWS
    }

    /// And while she drifts, for a drift goes on.
    fn creeping_nats(&self, k: usize) -> f64 {
        if self.unsettled.creeps(self.observations, k) {
            CREEPING_NATS
        } else {
            0.0
        }
    }

    /// What is asked beyond the usual while little is known of this ship's noise.
    fn unlearnt_nats(&self, k: usize) -> f64 {
        let since = self.observations[0].time.zip(self.observations[k].time);
        let is_new = since.is_some_and(|(first, now)| now.seconds_since(first) < NEW_S);
        if is_new && !self.is_known {
            NEW_NATS
        } else {
            0.0
        }
    }

    /// The filter before a row, or soon before it, and the row that it is of.
    fn before(&self, row: usize) -> Option<(usize, Filter)> {
        let mut spawns = self.bank.spawns.iter();
        let spawn = spawns.rfind(|spawn| spawn.at <= row)?;
        Some((spawn.at, spawn.origin().clone()))
    }

    /// The last event, if it is this passing disturbance.
    pub(crate) fn same_burst(&self, first: usize) -> Option<&Event> {
        let last = self.events.last();
        last.filter(|event| event.what == What::Burst && event.first + EVERY >= first)
    }

    /// The first row of a passing disturbance.
    pub(crate) fn began(&self, lead: Lead) -> usize {
        let spawn = &self.bank.spawns[lead.spawn];
        let over = spawn.astray_from.filter(|_| self.is_over(lead));
        over.unwrap_or(spawn.at)
    }

    fn has_lasted(&self, rows: usize, kind: Kind, k: usize, leads: &Leads) -> bool {
        leads[kind as usize].is_some_and(|lead| k + 1 >= self.bank.spawns[lead.spawn].at + rows)
    }

    /// By how much what leads was likelier beforehand than at another time.
    fn beforehand_nats(&self, kind: Kind, leads: &Leads) -> f64 {
        leads[kind as usize].map_or(0.0, |lead| self.bank.beforehand_nats(lead))
    }

    pub(crate) fn is_step(&self, k: usize, lead: f64, over_burst: f64, leads: &Leads) -> bool {
        let step = leads[Kind::Step as usize];
        // A large step would explain the first hour of a storm, too.
        let is_usual = step.is_some_and(|lead| lead.kind == Kind::Step);
        // What is likelier beforehand must be as clear from the rows.
        let beforehand = self.beforehand_nats(Kind::Step, leads);
        if over_burst - beforehand <= STEP_AT_LEAST
            || (over_burst <= STEP_NATS + self.unlearnt_nats(k) + self.creeping_nats(k)
                && !(is_usual && lead - beforehand > LARGE_NATS))
        {
            return false;
        }
        let since = step.map_or(k, |lead| self.bank.spawns[lead.spawn].at);
        let with_one = |rows: &[Observation]| {
            let one = rows.iter().filter(|o| o.gyro_less_satellite_deg.is_none());
            one.count() as f64 > ONE_REFERENCE_SHARE * rows.len() as f64
        };
        let usually = &self.observations[..since.max(1)];
        let is_half_blind = with_one(&self.observations[since..=k]) && !with_one(usually);
        over_burst > ONE_REFERENCE_NATS || !is_half_blind
    }

    /// The likeliest return at a port call, if a step to something else is not
    /// likelier by far.
    pub(crate) fn candidate(&self, leads: &Leads) -> Option<Candidate> {
        self.candidate_below(leads, RETURN_BELOW_STEP)
    }

    fn candidate_below(&self, leads: &Leads, below: f64) -> Option<Candidate> {
        let nats = |kind: Kind| leads[kind as usize].map_or(0.0, |lead| lead.nats);
        let rival = (nats(Kind::Burst) - BURST_BELOW_RETURN).max(0.0);
        let is_astray = self.burst.is_some() && nats(Kind::Burst) > nats(Kind::Step);
        let likeliest = self.calls.likeliest(&self.null, rival, is_astray)?;
        (is_astray || likeliest.nats > nats(Kind::Step) - below).then_some(likeliest)
    }

    /// Whether a step that is certain is rather the end of what began in port: that explains
    /// the rows better, though it leaves nothing free, and at about that time she lay in port.
    /// A few readings astray just before may speak against a return at the call itself.
    fn is_discharge(&self, k: usize, leads: &Leads) -> bool {
        let [step, _, _, back] = *leads;
        step.zip(back).is_some_and(|(step, back)| {
            let at = self.bank.spawns[back.spawn].at;
            back.nats > step.nats && self.discharge_near(at, k).is_some()
        })
    }

    /// The port call at about row `at`, until row `k`, at which what began in port may have
    /// ended.
    pub(crate) fn discharge_near(&self, at: usize, k: usize) -> Option<usize> {
        let laden = self
            .calls
            .bases
            .last()
            .filter(|base| base.came_on_board())?;
        if self.misaligned.is_some() || self.misled.is_some() {
            return None;
        }
        let loaded = self.events[laden.event].first;
        let rows = at.saturating_sub(AFTER_CALL)..=(at + BEFORE_CALL).min(k);
        let calls = rows.filter(|row| *row > loaded && self.is_call(*row));
        calls.min_by_key(|row| row.abs_diff(at))
    }

    /// Whether a step that is certain may as well be a return at this call.
    fn is_at_call(&self, leads: &Leads, back: &Candidate) -> bool {
        let step = leads[Kind::Step as usize].map(|lead| self.bank.spawns[lead.spawn].at);
        let near = back.at.saturating_sub(BEFORE_CALL)..=back.at + AFTER_CALL;
        back.probability > LIKELY && step.is_some_and(|at| near.contains(&at))
    }

    /// Whether both references were read lately.
    pub(crate) fn has_both(&self, k: usize) -> bool {
        let lately = &self.observations[k.saturating_sub(LATELY)..=k];
        lately.iter().any(|o| o.gyro_less_satellite_deg.is_some())
    }

    /// Whether a passing disturbance's lead is that of one that is over.
    pub(crate) fn is_over(&self, lead: Lead) -> bool {
        let over = self.bank.lead(Kind::Over, &self.null);
        over.is_some_and(|over| over.spawn == lead.spawn && over.nats >= lead.nats)
    }
}
