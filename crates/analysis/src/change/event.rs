//! Events that the detector found among the rows.

use super::filter::{CONSTANT_STATE, Filter};
use crate::estimate::POPULATION_SD;
use binnacle_compass::model::{Covariance, Parameters};
use binnacle_compass::ship::PARAMETERS;

/// The vessel's parameters as a filter had them.
#[derive(Clone, Debug)]
pub(crate) struct Snapshot {
    pub(crate) parameters: Parameters,
    pub(crate) constant_deg: f64,
    /// Covariance of the parameters and the constant.
    pub(crate) covariance: Covariance,
}

/// Kind of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EventKind {
    Step,
    /// A change of the compass's alignment.
    Alignment,
    /// A drift of the vessel's magnetism.
    Drift,
    ReferenceFault,
    Transient,
    /// A return to the state before the event at this place in the list.
    Return(usize),
}

impl EventKind {
    /// Returns true if the deviation stays changed after it, so that an epoch begins.
    pub(crate) fn is_lasting(self) -> bool {
        matches!(
            self,
            EventKind::Step | EventKind::Alignment | EventKind::Drift
        )
    }
}

/// Earliest and latest row at which a change may have begun.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowSpan {
    pub(crate) earliest: usize,
    pub(crate) latest: usize,
}

impl RowSpan {
    /// Returns the span of a single row.
    pub(crate) fn at(row: usize) -> RowSpan {
        RowSpan {
            earliest: row,
            latest: row,
        }
    }
}

/// An event found among the rows.
#[derive(Clone, Debug)]
pub(crate) struct Event {
    pub(crate) kind: EventKind,
    /// First row after it, and the rows that are possible.
    pub(crate) first: usize,
    pub(crate) between: RowSpan,
    /// Row at which it was detected.
    pub(crate) detected_row: usize,
    /// Log-likelihood ratios against no change, by kind.
    pub(crate) leads: [f64; 4],
    /// State before it, and when it was detected.
    pub(crate) before: Snapshot,
    pub(crate) after: Snapshot,
    /// Last row of a transient, once it is over.
    pub(crate) last: Option<usize>,
    /// True if it is certain.
    pub(crate) confirmed: bool,
    /// Row at which a step was withdrawn.
    pub(crate) withdrawn: Option<usize>,
    /// True if a transient was first reported as a step.
    pub(crate) was_step: bool,
    /// Log-likelihood ratio against the step for which it was first taken.
    pub(crate) over_step_log_likelihood_ratio: f64,
    /// Log-likelihood ratio of an alignment change against the step, where that is open.
    pub(crate) alignment_over_step_log_likelihood_ratio: Option<f64>,
    /// True if it is dated at a port call but was seen only days later: it may have
    /// happened at sea.
    pub(crate) noticed_late: bool,
}

impl Event {
    /// Turns a change that was over before row `end` into a transient.
    pub(crate) fn end_as_transient(&mut self, end: usize) {
        let [step, reference_step, transient, back] = self.leads;
        self.kind = EventKind::Transient;
        self.last = Some(end.saturating_sub(1).max(self.first));
        self.leads = [0.0, reference_step, transient.max(step), back];
        self.was_step = true;
        self.over_step_log_likelihood_ratio = 0.0;
    }
}

/// Removes the events that are `gone`, and adjusts the places to which returns refer.
/// Returns the mapping of old places to new ones.
pub(crate) fn remove_events(
    events: &mut Vec<Event>,
    gone: Vec<bool>,
) -> impl Fn(usize) -> usize + use<> {
    let mut each = gone.iter();
    events.retain(|_| each.next() != Some(&true));
    let moved = move |place: usize| place - gone[..place].iter().filter(|gone| **gone).count();
    for event in events {
        if let EventKind::Return(of) = &mut event.kind {
            *of = moved(*of);
        }
    }
    moved
}

pub(crate) fn snapshot(filter: &Filter) -> Snapshot {
    let mut scale = [1.0; PARAMETERS + 1];
    scale[..PARAMETERS].copy_from_slice(&POPULATION_SD);
    let mut parameters = [0.0; PARAMETERS];
    let mut covariance = [[0.0; PARAMETERS + 1]; PARAMETERS + 1];
    for i in 0..=PARAMETERS {
        if i < PARAMETERS {
            parameters[i] = filter.mean[i] * scale[i];
        }
        for j in 0..=PARAMETERS {
            covariance[i][j] = filter.covariance.at(i, j) * scale[i] * scale[j];
        }
    }
    Snapshot {
        parameters: Parameters::from_array(parameters),
        constant_deg: filter.mean[CONSTANT_STATE],
        covariance,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::change::filter::NoiseVariances;
    use crate::estimate::Prior;
    use binnacle_compass::result::NoiseLevels;

    fn event(event_kind: EventKind) -> Event {
        let known = Filter::new(
            &Prior::population(0.5),
            &NoiseVariances::new(&NoiseLevels::TYPICAL),
        );
        Event {
            kind: event_kind,
            first: 0,
            between: RowSpan::at(0),
            detected_row: 0,
            leads: [0.0; 4],
            before: snapshot(&known),
            after: snapshot(&known),
            last: None,
            confirmed: true,
            withdrawn: None,
            was_step: false,
            over_step_log_likelihood_ratio: 0.0,
            alignment_over_step_log_likelihood_ratio: None,
            noticed_late: false,
        }
    }

    #[test]
    fn a_fault_that_goes_on_is_found_where_it_is_when_earlier_events_are_taken_out() {
        let kinds = [
            EventKind::Step,
            EventKind::Step,
            EventKind::ReferenceFault,
            EventKind::Return(2),
        ];
        let mut events: Vec<Event> = kinds.into_iter().map(event).collect();
        let moved = remove_events(&mut events, vec![false, true, false, false]);
        assert_eq!(events.len(), 3);
        assert_eq!(events[moved(2)].kind, EventKind::ReferenceFault);
        assert_eq!(events[2].kind, EventKind::Return(moved(2)));
        assert_eq!(moved(0), 0);
    }
}
