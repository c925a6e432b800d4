//! The filter at the last port calls.

use crate::change::filter::Filter;

/// Calls that are asked about: the last few.
const MAX_DEPARTURES: usize = 3;

/// The last port calls, each with its first row after it and the filter there.
#[derive(Default)]
pub(crate) struct PortDepartures(pub(crate) Vec<(usize, Filter)>);

impl PortDepartures {
    pub(crate) fn add(&mut self, at: usize, now: &Filter) {
        if self.0.len() == MAX_DEPARTURES {
            self.0.remove(0);
        }
        self.0.push((at, now.clone()));
    }
}
