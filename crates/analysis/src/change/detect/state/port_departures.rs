//! Filters at the last port calls.

use crate::change::filter::Filter;

/// Greatest number of port calls.
const MAX_DEPARTURES: usize = 3;

/// Last port calls: the first row after each, and the filter there.
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
