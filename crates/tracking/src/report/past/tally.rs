//! Observations of an epoch, as far as the checks of its model need them.

use binnacle_analysis::fit::{Gaps, Headings, Observation};
use binnacle_compass::ship::EarthField;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Width of a class of horizontal fields, nT.
const CLASS_NT: f64 = 500.0;

/// Observations in order of time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Tally {
    pub(crate) count: u64,
    pub(crate) headings: Headings,
    pub(crate) gaps: Gaps,
    /// Fields by classes of their horizontal part.
    fields: BTreeMap<u16, FieldClass>,
    pub(crate) weakest_h_nt: Option<f64>,
    /// Field of the last one.
    pub(crate) last: Option<EarthField>,
    /// True if one has the difference of two references.
    pub(crate) has_both: bool,
}

/// Sums over fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct FieldClass {
    count: u64,
    h_nt: f64,
    z_nt: f64,
}

impl Tally {
    /// Adds the next observation.
    pub(crate) fn add(&mut self, observation: &Observation) {
        let Observation { h_nt, z_nt, .. } = *observation;
        self.count += 1;
        self.headings.add(observation.compass);
        if let Some(time) = observation.time {
            self.gaps.add(time);
        }
        let class = self.fields.entry((h_nt / CLASS_NT) as u16).or_default();
        class.count += 1;
        class.h_nt += h_nt;
        class.z_nt += z_nt;
        self.weakest_h_nt = weaker(self.weakest_h_nt, Some(h_nt));
        self.last = Some(EarthField { h_nt, z_nt });
        self.has_both |= observation.gyro_less_satellite_deg.is_some();
    }

    /// Adds later observations.
    pub(crate) fn append(&mut self, later: &Tally) {
        self.count += later.count;
        self.headings.append(&later.headings);
        self.gaps.append(&later.gaps);
        for (class, sums) in &later.fields {
            let class = self.fields.entry(*class).or_default();
            class.count += sums.count;
            class.h_nt += sums.h_nt;
            class.z_nt += sums.z_nt;
        }
        self.weakest_h_nt = weaker(self.weakest_h_nt, later.weakest_h_nt);
        self.last = later.last.or(self.last);
        self.has_both |= later.has_both;
    }

    /// Returns the usual field: the mean of the class in which the middle one lies; none without
    /// an observation.
    pub(crate) fn usual_field(&self) -> Option<EarthField> {
        let mut before = 0;
        let middle = self.fields.values().find(|class| {
            before += class.count;
            before > self.count / 2
        });
        middle.map(|class| EarthField {
            h_nt: class.h_nt / class.count as f64,
            z_nt: class.z_nt / class.count as f64,
        })
    }
}

fn weaker(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).reduce(f64::min)
}
