//! Times in which a detected event spoils samples.

use crate::constants::SETTLED_MEMORIES;
use crate::hypotheses::kinds::Kind;
use crate::state_space::transition::SETTLING_S;
use crate::weighing::records::{Class, Detected};
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::result::SampleReason;
use binnacle_compass::time::Timestamp;

/// Time in which a detected event spoils samples.
#[derive(Clone, Copy, Debug)]
struct Fault {
    class: Class,
    kind: Kind,
    /// Last row before it.
    from: Timestamp,
    /// Last row in it; none while it lasts.
    until: Option<Timestamp>,
}

/// Times in which detected events spoil samples.
pub(super) struct Faults(Vec<Fault>);

/// Trust in each reference at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trust {
    pub(super) gyro: bool,
    pub(super) satellite: bool,
}

impl Faults {
    /// Collects the times of detected events, and of those suspected that go on.
    pub(super) fn new(
        detected: &[Detected],
        suspected: &[Detected],
        now: Option<Timestamp>,
    ) -> Faults {
        let Some(now) = now else {
            return Faults(Vec::new());
        };
        let certain = detected.iter().filter(|event| event.withdrawn.is_none());
        let open = suspected
            .iter()
            .filter(|event| end(event, now).is_none() && event.class == Class::Passing);
        let faults = certain.chain(open).map(|detected| Fault {
            class: detected.class,
            kind: detected.event.kind,
            from: detected.event.from,
            until: end(detected, now),
        });
        Faults(faults.filter(|fault| fault.class != Class::Ship).collect())
    }

    fn at(&self, time: Timestamp) -> impl Iterator<Item = &Fault> {
        let is_within = move |fault: &&Fault| {
            fault.from < time && fault.until.is_none_or(|until| time <= until)
        };
        self.0.iter().filter(is_within)
    }

    /// Returns the trust in each reference at a time.
    pub(super) fn trust(&self, time: Timestamp) -> Trust {
        let is_sound = |instrument| self.at(time).all(|f| reference(f.kind) != Some(instrument));
        Trust {
            gyro: is_sound(FaultyReference::Gyro),
            satellite: is_sound(FaultyReference::Satellite),
        }
    }

    /// Tells of gyro and satellite compass whether a reading's heading by it is not trusted.
    pub(super) fn dropped(&self, reading: &Reading) -> (bool, bool) {
        let trust = self.trust(reading.sample().time);
        (
            reading.gyro.is_some() && !trust.gyro,
            reading.sample().satellite.is_some() && !trust.satellite,
        )
    }

    /// Returns the reason for which a sample is spoilt, if it is.
    pub(super) fn reason(&self, reading: &Reading) -> Option<SampleReason> {
        let sample = reading.sample();
        let has = |class| self.at(sample.time).any(|fault| fault.class == class);
        if has(Class::Compass) {
            return Some(SampleReason::CompassStuck);
        }
        if has(Class::Passing) {
            return Some(SampleReason::Disturbance);
        }
        if reading.gyro.is_none() && sample.satellite.is_none() {
            return None;
        }
        let trust = self.trust(sample.time);
        let has_sound = (reading.gyro.is_some() && trust.gyro)
            || (sample.satellite.is_some() && trust.satellite);
        (!has_sound).then_some(SampleReason::ReferenceFailed)
    }
}

/// Reference that may be at fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FaultyReference {
    Gyro,
    Satellite,
}

/// Returns the reference whose fault a kind of event is.
pub(super) fn reference(kind: Kind) -> Option<FaultyReference> {
    match kind {
        Kind::GyroStep | Kind::GyroSettling | Kind::GyroRamp | Kind::FailedGyro => {
            Some(FaultyReference::Gyro)
        }
        Kind::SatelliteStep | Kind::FailedSatellite => Some(FaultyReference::Satellite),
        _ => None,
    }
}

/// Returns the last row in an event by now; none while it lasts. A gyro that settles is right
/// again after some hours.
pub(super) fn end(detected: &Detected, now: Timestamp) -> Option<Timestamp> {
    let event = &detected.event;
    let settled = (event.kind == Kind::GyroSettling)
        .then(|| event.from.plus_seconds(SETTLED_MEMORIES * SETTLING_S))
        .filter(|settled| *settled < now);
    event.until.or(settled)
}
