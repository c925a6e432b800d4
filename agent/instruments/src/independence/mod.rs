//! Independence of the references: a true heading that is made of the compass agrees with it
//! however wrong it is.
//!
//! Whatever path it took, such a heading shares the compass's own noise. Readings are weighed by
//! the test that `fit` uses. A reference is withheld until its readings are more like those of an
//! independent instrument than not, and refused when they are those of the compass.

mod pairs;

use super::roles::{Instrument, ReferenceHeading, Refusal, Signal};
use binnacle_analysis::fit::SharedNoise;
use binnacle_compass::angle::Variation;
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::position::Position;
use binnacle_compass::sample::SourceId;
use binnacle_compass::time::Timestamp;
use pairs::{Circumstances, RecentCompass, ReferencePairs};

/// Age of a variation, seconds, that is less than a hundredth of a degree off.
const VARIATION_S: f64 = 60.0;

/// Test of both references.
#[derive(Debug, Default)]
pub struct Independence {
    time: Option<Timestamp>,
    position: Option<Position>,
    variation: Option<(Timestamp, Variation)>,
    compass: RecentCompass,
    gyro: Reference,
    satellite: Reference,
}

/// Pairs of one reference, and what they show.
#[derive(Debug, Default)]
struct Reference {
    source: Option<SourceId>,
    pairs: ReferencePairs,
    verdict: Verdict,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Verdict {
    /// Too few pairs.
    #[default]
    Open,
    /// Its readings are more like the compass's than not.
    Suspected,
    /// It has its own noise.
    Independent,
    /// It shares the compass's.
    Shared,
}

impl Independence {
    /// Applies a signal. Returns the refusal of a reference that must not be used.
    pub fn observe(&mut self, signal: Signal) -> Option<Signal> {
        match signal {
            Signal::Time(now) => {
                self.time = Some(now);
                self.compass.advance(now);
            }
            Signal::Jump(_) => *self = Independence::default(),
            Signal::Position(position) => self.position = Some(position),
            Signal::Compass(compass) => self.compass.add(compass),
            // Another compass needs another test.
            Signal::Refused(Instrument::Compass, _) => {
                self.compass = RecentCompass::default();
                (self.gyro, self.satellite) = Default::default();
            }
            Signal::Gyro(reading) => return self.reference(Instrument::Gyro, reading),
            Signal::Satellite(reading) => return self.reference(Instrument::Satellite, reading),
            _ => {}
        }
        None
    }

    /// Describes the references that must not be used.
    pub fn problems(&self) -> impl Iterator<Item = String> {
        [("gyro", &self.gyro), ("satellite", &self.satellite)]
            .into_iter()
            .filter_map(|(role, reference)| match reference.verdict {
                Verdict::Shared => Some(format!(
                    "{role}: the heading shares the compass's own noise, so it is made of the \
                     compass: it is no reference"
                )),
                Verdict::Suspected => Some(format!(
                    "{role}: the heading follows the compass too closely to be another \
                     instrument's: it is withheld until turns show more"
                )),
                Verdict::Open | Verdict::Independent => None,
            })
    }

    fn reference(&mut self, instrument: Instrument, reading: ReferenceHeading) -> Option<Signal> {
        let circumstances = self.circumstances();
        let reference = match instrument {
            Instrument::Gyro => &mut self.gyro,
            Instrument::Satellite | Instrument::Compass => &mut self.satellite,
        };
        if reference.source != Some(reading.source) {
            *reference = Reference {
                source: Some(reading.source),
                ..Reference::default()
            };
        }
        if let Some(circumstances) = circumstances {
            let is_decided = matches!(reference.verdict, Verdict::Independent | Verdict::Shared);
            let pairs = &mut reference.pairs;
            pairs.add(reading.heading, &self.compass, circumstances);
            if pairs.is_due(is_decided) {
                reference.weigh(circumstances.time);
            }
        }
        let refusal = match reference.verdict {
            Verdict::Independent => return None,
            Verdict::Shared => Refusal::NotIndependent,
            Verdict::Open | Verdict::Suspected => Refusal::Unproven,
        };
        Some(Signal::Refused(instrument, refusal))
    }

    fn circumstances(&mut self) -> Option<Circumstances> {
        let (time, position) = (self.time?, self.position?);
        Some(Circumstances {
            time,
            position,
            variation: self.variation(time, position)?,
        })
    }

    fn variation(&mut self, time: Timestamp, position: Position) -> Option<Variation> {
        let known = self
            .variation
            .filter(|(at, _)| time.seconds_since(*at).abs() <= VARIATION_S);
        if known.is_none() {
            let here = field(FieldModel::Igrf14, position, 0.0, time).ok()?;
            self.variation = Some((time, here.declination()));
        }
        self.variation.map(|(_, variation)| variation)
    }
}

impl Reference {
    fn weigh(&mut self, now: Timestamp) {
        let Some(weighed) = self.pairs.weigh(now) else {
            return;
        };
        self.verdict = match self.verdict {
            _ if weighed.iter().any(SharedNoise::is_shared) => Verdict::Shared,
            Verdict::Shared if !weighed.iter().all(SharedNoise::is_independent) => Verdict::Shared,
            Verdict::Independent => Verdict::Independent,
            _ if weighed.iter().all(SharedNoise::favours_independence) => Verdict::Independent,
            _ => Verdict::Suspected,
        };
    }
}

#[cfg(test)]
mod tests;
