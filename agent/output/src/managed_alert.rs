//! One alert as bridge alert management (IEC 62923-1) handles it: a warning of category B with its
//! state, which conditions and commands change.

use crate::condition::AlertCondition;
use binnacle_nmea::alert::{
    Alert, AlertCategory, AlertCommand, AlertId, AlertPriority, AlertState,
};
use binnacle_nmea::time::TimeOfDay;
use std::time::Duration;
use tokio::time::Instant;
use uuid::Uuid;

/// Mnemonic that the alerts' identifiers belong to, as that of PBINQ.
pub(crate) const MANUFACTURER: [u8; 3] = *b"BIN";
/// Time for which an alert is silenced (IMO MSC.302(87): 30 seconds).
const SILENCE: Duration = Duration::from_secs(30);
/// Time after which an unacknowledged warning escalates (IMO MSC.302(87): at most five minutes).
const ESCALATION: Duration = Duration::from_mins(5);
const MAX_REVISION: u8 = 99;
const MAX_ESCALATION: u8 = 9;

/// Alert with its state.
#[derive(Debug)]
pub(crate) struct ManagedAlert {
    number: u32,
    condition: Option<AlertCondition>,
    state: AlertState,
    silenced_until: Option<Instant>,
    /// Start of the present step of escalation.
    escalating_since: Option<Instant>,
    escalation: u8,
    revision: u8,
    changed: Option<TimeOfDay>,
}

/// Effect of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effect {
    /// An occurrence is acknowledged.
    Acknowledged(Uuid),
    /// The alert is silenced from the next update on.
    Silenced,
    /// The alert's sentences are sent again.
    Requested,
    /// The command cannot be done.
    Refused,
}

impl ManagedAlert {
    /// Creates an alert in the normal state.
    pub(crate) fn new(number: u32) -> ManagedAlert {
        ManagedAlert {
            number,
            condition: None,
            state: AlertState::Normal,
            silenced_until: None,
            escalating_since: None,
            escalation: 0,
            revision: 1,
            changed: None,
        }
    }

    pub(crate) fn id(&self) -> AlertId {
        AlertId {
            manufacturer: Some(MANUFACTURER),
            number: self.number,
            instance: Some(1),
        }
    }

    /// Returns whether a command names this alert. An instance may be left out: there is one.
    pub(crate) fn is_named_by(&self, id: AlertId) -> bool {
        let own = self.id();
        id.manufacturer == own.manufacturer
            && id.number == own.number
            && matches!(id.instance, None | Some(1))
    }

    pub(crate) fn is_normal(&self) -> bool {
        self.state == AlertState::Normal
    }

    pub(crate) fn revision(&self) -> u8 {
        self.revision
    }

    /// Applies the condition as it is now. Returns whether the alert's sentences have changed.
    pub(crate) fn update(
        &mut self,
        condition: Option<AlertCondition>,
        time: Option<TimeOfDay>,
        now: Instant,
    ) -> bool {
        let id = |condition: &Option<AlertCondition>| condition.as_ref().map(|known| known.id);
        let before = (self.state, self.escalation);
        let is_same = id(&self.condition) == id(&condition);
        let was_normal = self.is_normal();
        let is_reworded = condition != self.condition;
        if !is_same {
            (self.silenced_until, self.escalating_since) = (None, None);
            self.escalation = 0;
        }
        self.condition = condition;
        self.silenced_until = self.silenced_until.filter(|until| now < *until);
        self.state = self.state_now();
        self.escalate(now);
        let has_changed = before != (self.state, self.escalation)
            || (is_reworded && !(was_normal && self.is_normal()));
        if has_changed {
            self.revision = self.revision % MAX_REVISION + 1;
            self.changed = time;
        }
        has_changed
    }

    fn state_now(&self) -> AlertState {
        let Some(condition) = &self.condition else {
            return AlertState::Normal;
        };
        match (condition.is_active, condition.is_acknowledged) {
            (true, true) => AlertState::Acknowledged,
            (true, false) if self.silenced_until.is_some() => AlertState::Silenced,
            (true, false) => AlertState::Unacknowledged,
            (false, false) => AlertState::Rectified,
            (false, true) => AlertState::Normal,
        }
    }

    fn escalate(&mut self, now: Instant) {
        if !matches!(
            self.state,
            AlertState::Unacknowledged | AlertState::Silenced
        ) {
            self.escalating_since = None;
            return;
        }
        let since = *self.escalating_since.get_or_insert(now);
        if now.saturating_duration_since(since) >= ESCALATION {
            self.escalating_since = Some(now);
            self.escalation = (self.escalation + 1).min(MAX_ESCALATION);
            self.silenced_until = None;
            self.state = self.state_now();
        }
    }

    /// Applies a command. Responsibility cannot be transferred: only the agent can judge whether
    /// the compass is right.
    pub(crate) fn command(&mut self, command: AlertCommand, now: Instant) -> Effect {
        match (command, self.state, &self.condition) {
            (AlertCommand::Request, ..) => Effect::Requested,
            (
                AlertCommand::Acknowledge,
                AlertState::Unacknowledged | AlertState::Silenced | AlertState::Rectified,
                Some(condition),
            ) => Effect::Acknowledged(condition.id),
            (AlertCommand::Silence, AlertState::Unacknowledged | AlertState::Silenced, _) => {
                self.silenced_until = Some(now + SILENCE);
                Effect::Silenced
            }
            _ => Effect::Refused,
        }
    }

    /// Returns the contents of the alert's sentences.
    pub(crate) fn alert(&self) -> Alert<'_> {
        let condition = self.condition.as_ref();
        Alert {
            id: self.id(),
            changed: self.changed,
            category: AlertCategory::B,
            priority: AlertPriority::Warning,
            state: self.state,
            revision: self.revision,
            escalation: self.escalation,
            title: condition.map_or("NO ALERT", |condition| condition.title),
            description: condition.map_or("", |condition| condition.description.as_str()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMPASS: AlertId = AlertId {
        manufacturer: Some(MANUFACTURER),
        number: 10_001,
        instance: Some(1),
    };

    fn condition(id: u128, is_active: bool, is_acknowledged: bool) -> AlertCondition {
        AlertCondition {
            id: Uuid::from_u128(id),
            is_active,
            is_acknowledged,
            title: "COMPASS SUSPECT",
            description: "TAKE AN AZIMUTH".to_owned(),
        }
    }

    struct Managed {
        alert: ManagedAlert,
        start: Instant,
    }

    impl Managed {
        fn new() -> Managed {
            Managed {
                alert: ManagedAlert::new(10_001),
                start: Instant::now(),
            }
        }

        fn at(&self, second: u64) -> Instant {
            self.start + Duration::from_secs(second)
        }

        /// Returns state, escalation and whether they are new.
        fn update(
            &mut self,
            condition: impl Into<Option<AlertCondition>>,
            second: u64,
        ) -> (char, u8, bool) {
            let is_new = self.alert.update(condition.into(), None, self.at(second));
            let letter = char::from(self.alert.state.letter());
            (letter, self.alert.escalation, is_new)
        }
    }

    #[test]
    fn an_alert_goes_from_raised_to_acknowledged_to_normal() {
        let mut managed = Managed::new();
        assert_eq!(managed.update(None::<AlertCondition>, 0), ('N', 0, false));
        assert_eq!(managed.update(condition(1, true, false), 1), ('V', 0, true));
        assert_eq!(
            managed.update(condition(1, true, false), 2),
            ('V', 0, false)
        );
        let now = managed.at(3);
        let effect = managed.alert.command(AlertCommand::Acknowledge, now);
        assert_eq!(effect, Effect::Acknowledged(Uuid::from_u128(1)));
        assert_eq!(managed.update(condition(1, true, true), 3), ('A', 0, true));
        assert_eq!(managed.update(condition(1, false, true), 4), ('N', 0, true));
        assert_eq!(
            managed.update(condition(1, false, true), 5),
            ('N', 0, false)
        );
        assert_eq!(managed.alert.revision(), 4);
        assert_eq!(managed.update(condition(2, true, false), 6), ('V', 0, true));
    }

    #[test]
    fn one_that_is_over_waits_for_its_acknowledgement() {
        let mut managed = Managed::new();
        managed.update(condition(1, true, false), 1);
        assert_eq!(
            managed.update(condition(1, false, false), 2),
            ('U', 0, true)
        );
        let now = managed.at(3);
        let effect = managed.alert.command(AlertCommand::Acknowledge, now);
        assert_eq!(effect, Effect::Acknowledged(Uuid::from_u128(1)));
        assert_eq!(managed.update(condition(1, false, true), 3), ('N', 0, true));
    }

    #[test]
    fn a_silenced_alert_sounds_again_after_half_a_minute() {
        let mut managed = Managed::new();
        managed.update(condition(1, true, false), 1);
        let now = managed.at(2);
        let effect = managed.alert.command(AlertCommand::Silence, now);
        assert_eq!(effect, Effect::Silenced);
        assert_eq!(managed.update(condition(1, true, false), 2), ('S', 0, true));
        assert_eq!(
            managed.update(condition(1, true, false), 31),
            ('S', 0, false)
        );
        assert_eq!(
            managed.update(condition(1, true, false), 32),
            ('V', 0, true)
        );
    }

    #[test]
    fn an_unacknowledged_alert_escalates_every_five_minutes() {
        let mut managed = Managed::new();
        let open = || condition(1, true, false);
        managed.update(open(), 1);
        assert_eq!(managed.update(open(), 300), ('V', 0, false));
        assert_eq!(managed.update(open(), 301), ('V', 1, true));
        assert_eq!(managed.update(open(), 601), ('V', 2, true));
        assert_eq!(
            managed.update(condition(1, true, true), 602),
            ('A', 2, true)
        );
        assert_eq!(
            managed.update(condition(1, true, true), 9_000),
            ('A', 2, false)
        );
        assert_eq!(
            managed.update(condition(2, true, false), 9_001),
            ('V', 0, true)
        );
    }

    #[test]
    fn what_cannot_be_done_is_refused() {
        let mut managed = Managed::new();
        let now = managed.at(0);
        let command = |managed: &mut Managed, command| managed.alert.command(command, now);
        for unknown in [AlertCommand::Acknowledge, AlertCommand::Silence] {
            assert_eq!(command(&mut managed, unknown), Effect::Refused);
        }
        assert_eq!(
            command(&mut managed, AlertCommand::Request),
            Effect::Requested
        );
        managed.update(condition(1, true, true), 1);
        for again in [
            AlertCommand::Acknowledge,
            AlertCommand::Silence,
            AlertCommand::Transfer,
        ] {
            assert_eq!(command(&mut managed, again), Effect::Refused);
        }
        managed.update(condition(2, true, false), 2);
        assert_eq!(
            command(&mut managed, AlertCommand::Transfer),
            Effect::Refused
        );
    }

    #[test]
    fn an_alert_is_named_by_manufacturer_number_and_instance() {
        let alert = ManagedAlert::new(10_001);
        assert!(alert.is_named_by(COMPASS));
        let instance = None;
        assert!(alert.is_named_by(AlertId {
            instance,
            ..COMPASS
        }));
        let instance = Some(2);
        assert!(!alert.is_named_by(AlertId {
            instance,
            ..COMPASS
        }));
        let number = 10_002;
        assert!(!alert.is_named_by(AlertId { number, ..COMPASS }));
        let manufacturer = None;
        assert!(!alert.is_named_by(AlertId {
            manufacturer,
            ..COMPASS
        }));
    }

    #[test]
    fn the_revision_counts_to_99_and_begins_again() {
        let mut managed = Managed::new();
        for round in 0..99 {
            managed.update(condition(round, true, false), 1);
        }
        assert_eq!(managed.alert.revision(), 1);
    }
}
