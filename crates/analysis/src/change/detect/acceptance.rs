//! Acceptance of a hypothesis: its filter becomes the null filter, and an event is
//! recorded.

use super::dating::DatedChange;
use super::state::{Detector, ExtraDrift, FilterBefore, Leads, LearningSchedule};
use crate::change::event::{Event, EventKind, RowSpan, remove_events, snapshot};
use crate::change::filter::Filter;
use crate::change::hypotheses::Lead;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::jump_models::{EarlierState, apply_jump, apply_reference_step};
use crate::change::port_call_returns::{Baseline, ReturnCandidate, StepOrigin};
use crate::change::thresholds::{
    BRIEF_CHANGE_S, FORK_INTERVAL_ROWS, LARGE_STEP_DEFICIT_LOG_LIKELIHOOD_RATIO,
};

/// Filters before and after a change.
#[derive(Clone, Copy)]
pub(crate) struct FilterChange<'a> {
    pub(crate) before: &'a Filter,
    pub(crate) after: &'a Filter,
}

impl Detector<'_> {
    /// Accepts a change of the vessel's magnetism or of a reference.
    pub(crate) fn accept_change(&mut self, k: usize, kind: HypothesisKind, leads: Leads) {
        let Some(lead) = leads[kind as usize] else {
            return;
        };
        let large = self.bank.lead(HypothesisKind::LargeStep, &self.null);
        let large = large.filter(|l| {
            kind == HypothesisKind::Step
                && l.log_likelihood_ratio
                    > lead.log_likelihood_ratio - LARGE_STEP_DEFICIT_LOG_LIKELIHOOD_RATIO
        });
        let lead = large.unwrap_or(lead);
        let dated = self.date_change(lead.fork, lead.kind, k);
        let baseline = self.returns.baselines.last();
        let at_sea = self.alignment_change.is_some()
            || baseline.is_some_and(|base| !base.began_at_port_call());
        if kind == HypothesisKind::Step && self.reference_fault.is_none() && at_sea {
            // Each was linearised at its own end: either may be the likelier.
            let returned = leads[HypothesisKind::Return as usize];
            let returned =
                returned.map(|lead| (lead, self.date_change(lead.fork, HypothesisKind::Return, k)));
            let likelier = |d: &DatedChange| d.filter.log_likelihood > dated.filter.log_likelihood;
            if let Some((lead, returned)) = returned.filter(|(_, returned)| likelier(returned)) {
                return self.accept_dated_return(k, lead, returned, leads);
            }
        }
        if kind == HypothesisKind::Step
            && let Some((event, filter)) = self.same_step(k, &dated)
        {
            return self.replace_step(k, event, filter);
        }
        self.close_transient(dated.first);
        let event_kind = match kind {
            HypothesisKind::Step => EventKind::Step,
            _ => self
                .reference_fault
                .take_if(|fault| dated.filter.agrees_in_constant(&fault.before))
                .map_or(EventKind::ReferenceFault, |fault| {
                    EventKind::Return(fault.event)
                }),
        };
        self.record_event(
            k,
            event_kind,
            dated.first,
            dated.between,
            leads,
            Some(FilterChange {
                before: &dated.before,
                after: &dated.filter,
            }),
        );
        if let Some(event) = self.events.last_mut() {
            event.noticed_late = dated.noticed_late;
        }
        let mut competing = Vec::new();
        let mut no_step = None;
        if kind == HypothesisKind::Step {
            self.alignment_change = None;
            no_step = Some(self.no_step_hypotheses(k, &dated, &leads));
            competing = self.competing_hypotheses(k, &dated);
            // Several steps may have been the same one.
            competing.append(&mut self.competing);
            if !self.began_at_port_call(&dated) {
                self.extra_drift = ExtraDrift::from_step(dated.first, &dated.before, &dated.filter);
            }
            self.replay_port_calls(k, &dated);
        } else {
            if event_kind == EventKind::ReferenceFault && self.reference_fault.is_none() {
                self.reference_fault = Some(FilterBefore {
                    event: self.events.len() - 1,
                    before: dated.before,
                });
            }
            let gained = dated.filter.log_likelihood - self.null.log_likelihood;
            let mut returns = std::mem::take(&mut self.returns);
            let next = |returned: &Filter| self.measure(k, &returned.unknowns());
            returns.apply_reference_change(gained, |returned| {
                apply_reference_step(returned, &next(returned), lead.kind)
            });
            self.returns = returns;
        }
        self.replace_null(k, dated.filter, dated.first);
        self.competing = competing;
        self.no_step = no_step;
        if event_kind == EventKind::ReferenceFault {
            // The noise of the reference may have changed, too.
            self.next_learning =
                LearningSchedule::next(self.observations, dated.first, dated.first, 0.0);
        }
    }

    fn began_at_port_call(&self, dated: &DatedChange) -> bool {
        let RowSpan { earliest, latest } = dated.between;
        (earliest..=latest).any(|row| self.is_port_call(row))
    }

    /// Replays the port calls since a step, and the one at which it happened, with a filter
    /// that knows the step.
    pub(crate) fn replay_port_calls(&mut self, k: usize, dated: &DatedChange) {
        let event = self.events.len() - 1;
        let is_loading_logged =
            self.is_loading_logged(dated.between.earliest, dated.between.latest);
        let origin = if dated.noticed_late && !is_loading_logged {
            StepOrigin::NoticedLate
        } else if self.began_at_port_call(dated) {
            StepOrigin::AtPort
        } else if is_loading_logged {
            StepOrigin::LoggedLoading
        } else {
            let departure = self.departure_before(dated.first, &self.events[..event]);
            departure.map_or(StepOrigin::AtSea, |(_, departure)| {
                StepOrigin::SoonAfter(Box::new(departure.clone()))
            })
        };
        let base = Baseline {
            event,
            filter: dated.before.clone(),
            origin,
            latest: self.observations[dated.between.latest].time,
            port_calls: 0,
        };
        self.returns.add_baseline(base);
        let at = dated.filter.unknowns();
        let is_port_call = |row: usize| self.is_port_call(row) || self.is_discharge_logged(row);
        let calls: Vec<usize> = (dated.first..=k).filter(|row| is_port_call(*row)).collect();
        if calls.first() == Some(&dated.first) {
            let logged = self.logged_cargo_at(dated.first);
            self.returns
                .add_port_call(dated.first, &dated.before, event, logged);
        }
        let undisturbed_rows: Vec<usize> = self.undisturbed_rows(dated.first..k + 1).collect();
        let mut since = apply_jump(&dated.before, dated.kind);
        for row in dated.first..=k {
            if row > dated.first && calls.contains(&row) {
                let logged = self.logged_cargo_at(row);
                self.returns.add_port_call(row, &since, usize::MAX, logged);
            }
            if undisturbed_rows.binary_search(&row).is_err() {
                continue;
            }
            let m = self.measure(row, &at);
            since.observe(&m, &self.noise, None);
            let mut returns = std::mem::take(&mut self.returns);
            returns.observe_since(dated.first, |at| self.measure(row, at), &self.noise);
            self.returns = returns;
        }
    }

    /// Ends a current transient where a change is dated. A transient that began there too,
    /// or was detected only afterwards, was the change's first sign: its event is removed.
    pub(crate) fn close_transient(&mut self, first: usize) {
        let Some(event) = self.transient.take() else {
            return;
        };
        let transient = &self.events[event];
        if transient.first + 2 * FORK_INTERVAL_ROWS >= first || transient.detected_row >= first {
            self.events.remove(event);
        } else {
            self.events[event].last = Some(first - 1);
        }
    }

    pub(crate) fn accept_return(&mut self, k: usize, leads: Leads) {
        let Some(lead) = leads[HypothesisKind::Return as usize] else {
            return;
        };
        let mut dated = self.date_change(lead.fork, HypothesisKind::Return, k);
        if let Some(call) = self.discharge_near(dated.first, k) {
            // The call is as possible a date.
            let RowSpan { earliest, latest } = dated.between;
            dated.between = RowSpan {
                earliest: earliest.min(call),
                latest: latest.max(call),
            };
        }
        self.accept_dated_return(k, lead, dated, leads);
    }

    /// Accepts a return of the vessel, or of the compass's alignment. A change that lasted
    /// hours at sea came from beside the vessel: it becomes a transient.
    fn accept_dated_return(&mut self, k: usize, lead: Lead, dated: DatedChange, leads: Leads) {
        let zero = self.alignment_change.take().map(|change| change.event);
        let vessel = || self.returns.baselines.last().map(|base| base.event);
        let Some(event) = zero.or_else(vessel) else {
            return;
        };
        let before = self.bank.forks[lead.fork].origin().clone();
        self.close_transient(dated.first);
        if self.was_brief(&self.events[event], &dated) {
            self.events[event].end_as_transient(dated.first);
        } else {
            self.record_event(
                k,
                EventKind::Return(event),
                dated.first,
                dated.between,
                leads,
                Some(FilterChange {
                    before: &before,
                    after: &dated.filter,
                }),
            );
        }
        self.returns.forget(event);
        self.extra_drift = ExtraDrift::default();
        self.replace_null(k, dated.filter, dated.first);
    }

    fn was_brief(&self, event: &Event, returned: &DatedChange) -> bool {
        let time = |row: usize| self.observations[row].time;
        let lasted_s = time(returned.first)
            .zip(time(event.first))
            .map(|(end, begin)| end.seconds_since(begin));
        let mut rows = event.between.earliest..=returned.between.latest.max(returned.first);
        matches!(event.kind, EventKind::Step | EventKind::Alignment)
            && lasted_s.is_some_and(|s| s < BRIEF_CHANGE_S)
            && !rows.any(|row| self.is_port_call(row))
    }

    /// Accepts a repair of the reference.
    pub(crate) fn accept_reference_repair(&mut self, k: usize, leads: Leads) {
        let Some(lead) = leads[HypothesisKind::Return as usize] else {
            return;
        };
        let dated = self.date_change(lead.fork, HypothesisKind::Return, k);
        let before = self.bank.forks[lead.fork].origin().clone();
        self.close_transient(dated.first);
        let Some(FilterBefore {
            event,
            before: repaired,
        }) = self.reference_fault.take()
        else {
            return;
        };
        let gained = dated.filter.log_likelihood - self.null.log_likelihood;
        let repaired = EarlierState::Reference(&repaired);
        self.returns
            .apply_reference_change(gained, |returned| repaired.restore(returned));
        self.record_event(
            k,
            EventKind::Return(event),
            dated.first,
            dated.between,
            leads,
            Some(FilterChange {
                before: &before,
                after: &dated.filter,
            }),
        );
        self.replace_null(k, dated.filter, dated.first);
    }

    /// Accepts a return of the vessel at a port call.
    pub(crate) fn accept_port_call_return(
        &mut self,
        k: usize,
        returned: ReturnCandidate,
        leads: Leads,
    ) {
        // Before places in the list change.
        self.record_alignment_ratios();
        self.competing.clear();
        self.close_transient(returned.at);
        self.alignment_change = None;
        // Steps since the call were this return.
        let is_reference = |event: &Event| match event.kind {
            EventKind::Return(of) => self.events[of].kind == EventKind::ReferenceFault,
            event_kind => event_kind == EventKind::ReferenceFault,
        };
        let is_removed = |(place, event): (usize, &Event)| {
            let is_past = event.kind == EventKind::Transient || is_reference(event);
            place > returned.event && !is_past && event.between.latest >= returned.at
        };
        let removed = self.events.iter().enumerate().map(is_removed).collect();
        let moved = remove_events(&mut self.events, removed);
        if let Some(fault) = &mut self.reference_fault {
            fault.event = moved(fault.event);
        }
        let before = self.null.clone();
        self.record_event(
            k,
            EventKind::Return(returned.event),
            returned.at,
            RowSpan::at(returned.at),
            leads,
            Some(FilterChange {
                before: &before,
                after: &returned.filter,
            }),
        );
        self.returns.forget(returned.event);
        self.extra_drift = ExtraDrift::default();
        self.replace_null(k, returned.filter, returned.at);
    }

    pub(crate) fn replace_null(&mut self, k: usize, filter: Filter, first: usize) {
        self.record_alignment_ratios();
        self.null = filter;
        self.bank.clear();
        self.weak_transient = None;
        self.before_transient = None;
        self.competing.clear();
        self.no_step = None;
        self.last_fork = k;
        self.learn_from = first;
        // Seas and instruments are the same: fewer days teach nothing new.
        self.next_learning =
            LearningSchedule::next(self.observations, first, first, self.learnt_days);
    }

    pub(crate) fn record_event(
        &mut self,
        k: usize,
        event_kind: EventKind,
        first: usize,
        between: RowSpan,
        leads: Leads,
        change: Option<FilterChange<'_>>,
    ) {
        let FilterChange { before, after } = change.unwrap_or(FilterChange {
            before: &self.null,
            after: &self.null,
        });
        let event = Event {
            kind: event_kind,
            first,
            between,
            detected_row: k,
            leads: leads.map(|lead| lead.map_or(0.0, |lead| lead.log_likelihood_ratio)),
            before: snapshot(before),
            after: snapshot(after),
            last: None,
            confirmed: true,
            withdrawn: None,
            was_step: false,
            over_step_log_likelihood_ratio: 0.0,
            alignment_over_step_log_likelihood_ratio: None,
            noticed_late: false,
        };
        self.events.push(event);
    }
}
