//! The agent's alerts for bridge alert management (IEC 62923-2, IEC 61162-1): `ALF` when an alert
//! changes, `ALC` with all alerts that are not normal and `HBT` every half minute, and `ARC` when a
//! command is refused.
//!
//! Commands name an alert by manufacturer, number and instance. Those to the alerts of other
//! equipment, which come by on a shared line, are ignored.

use crate::condition::AlertCondition;
use crate::config::SentenceKind;
use crate::framing::frame_sentence;
use crate::line::Line;
use crate::managed_alert::{Effect, MANUFACTURER, ManagedAlert};
use binnacle_compass::time::Timestamp;
use binnacle_nmea::alert::{AlertId, write_alc, write_alf, write_arc};
use binnacle_nmea::sentence::Acn;
use binnacle_nmea::time::{TimeOfDay, from_unix_micros};
use std::time::Duration;
use tokio::time::Instant;
use uuid::Uuid;

/// Interval of the alert list and of the heartbeat.
const LIST_INTERVAL: Duration = Duration::from_secs(30);
/// Identifier of the alert that compass and references disagree.
const COMPASS_ALERT: u32 = 10_001;
/// Identifier of the heading-difference alarm.
const DIFFERENCE_ALERT: u32 = 10_002;
/// Identifier of the alert of GNSS interference.
const INTERFERENCE_ALERT: u32 = 10_003;

/// Conditions of the agent's alerts.
#[derive(Clone, Debug, Default)]
pub struct AlertConditions {
    /// Compass and references disagree.
    pub compass: Option<AlertCondition>,
    /// Corrected heading and reference differ by more than a limit.
    pub difference: Option<AlertCondition>,
    /// GNSS interference: no receiver is trusted.
    pub interference: Option<AlertCondition>,
}

/// Alerts, and the sentences about them that wait to be sent.
#[derive(Debug)]
pub struct AlertSentences {
    talker: [u8; 2],
    /// Alerts in the order of [`AlertConditions`].
    alerts: [ManagedAlert; 3],
    waiting: Vec<Line>,
    alf_message: u8,
    alc_message: u8,
    heartbeat: u8,
    list_sent: Option<Instant>,
}

impl AlertSentences {
    /// Creates the sentences of a talker.
    pub fn new(talker: [u8; 2]) -> AlertSentences {
        AlertSentences {
            talker,
            alerts: [COMPASS_ALERT, DIFFERENCE_ALERT, INTERFERENCE_ALERT].map(ManagedAlert::new),
            waiting: Vec::new(),
            alf_message: 0,
            alc_message: 0,
            heartbeat: 0,
            list_sent: None,
        }
    }

    /// Applies the conditions as they are now.
    pub fn update(&mut self, conditions: AlertConditions, time: Option<Timestamp>, now: Instant) {
        let time = time.and_then(time_of_day);
        let conditions = [
            conditions.compass,
            conditions.difference,
            conditions.interference,
        ];
        for (index, condition) in conditions.into_iter().enumerate() {
            if self.alerts[index].update(condition, time, now) {
                self.report(index);
            }
        }
    }

    /// Applies a command. Returns the alert that it acknowledges.
    pub fn command(
        &mut self,
        command: &Acn,
        time: Option<Timestamp>,
        now: Instant,
    ) -> Option<Uuid> {
        if command.alert.manufacturer != Some(MANUFACTURER) {
            return None;
        }
        let mut alerts = self.alerts.iter();
        let named = alerts.position(|alert| alert.is_named_by(command.alert));
        let effect = named.map(|index| (index, self.alerts[index].command(command.command, now)));
        match effect {
            Some((_, Effect::Acknowledged(id))) => Some(id),
            // The next update reports it.
            Some((_, Effect::Silenced)) => None,
            Some((index, Effect::Requested)) => {
                self.report(index);
                None
            }
            Some((_, Effect::Refused)) | None => {
                let time = time.and_then(time_of_day);
                let (id, refused) = (command.alert, command.command);
                let mut text = Vec::new();
                write_arc(self.talker, time, id, refused, &mut text);
                self.send(&text);
                None
            }
        }
    }

    fn report(&mut self, index: usize) {
        let alert = self.alerts[index].alert();
        let message = self.alf_message;
        let mut text = Vec::new();
        write_alf(self.talker, &alert, message, &mut text);
        self.send(&text);
        self.alf_message = (message + 1) % 10;
    }

    /// Lets the sentences of a message wait.
    fn send(&mut self, message: &[u8]) {
        let lines = Line::of_message(SentenceKind::Alf, message);
        self.waiting.extend(lines);
    }

    /// Returns the sentences that are due.
    pub fn due(&mut self, now: Instant) -> Vec<Line> {
        let is_list_due = self
            .list_sent
            .is_none_or(|sent| now.saturating_duration_since(sent) >= LIST_INTERVAL);
        if is_list_due {
            self.list_sent = Some(now);
            self.write_list();
        }
        std::mem::take(&mut self.waiting)
    }

    fn write_list(&mut self) {
        let listed: Vec<(AlertId, u8)> = self
            .alerts
            .iter()
            .filter(|alert| !alert.is_normal())
            .map(|alert| (alert.id(), alert.revision()))
            .collect();
        let mut list = Vec::new();
        write_alc(self.talker, &listed, self.alc_message, &mut list);
        self.send(&list);
        self.alc_message = (self.alc_message + 1) % 100;
        let talker = String::from_utf8_lossy(&self.talker);
        let (interval_s, count) = (LIST_INTERVAL.as_secs(), self.heartbeat);
        let heartbeat = frame_sentence(&format!("{talker}HBT,{interval_s},A,{count}"));
        self.send(&heartbeat);
        self.heartbeat = (count + 1) % 10;
    }
}

/// Returns the time of day to the hundredth of a second.
fn time_of_day(time: Timestamp) -> Option<TimeOfDay> {
    const HUNDREDTH_MICROS: i64 = 10_000;
    let micros = time.micros().div_euclid(HUNDREDTH_MICROS) * HUNDREDTH_MICROS;
    from_unix_micros(micros).map(|(_, time)| time)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::Part;
    use binnacle_nmea::Data;

    struct Bridge {
        sentences: AlertSentences,
        start: Instant,
        conditions: AlertConditions,
    }

    impl Bridge {
        fn new() -> Bridge {
            Bridge {
                sentences: AlertSentences::new(*b"II"),
                start: Instant::now(),
                conditions: AlertConditions::default(),
            }
        }

        /// Returns the sentences of a second without their checksums.
        fn said(&mut self, second: u64) -> Vec<String> {
            let now = self.start + Duration::from_secs(second);
            let time = Timestamp::parse("2026-11-21T07:05:09.123456Z").ok();
            self.sentences.update(self.conditions.clone(), time, now);
            let body = |line: Line| {
                assert!(line.text.len() <= 82, "{line:?}");
                let text = String::from_utf8(line.text).unwrap();
                let (body, sum) = text.strip_prefix('$').unwrap().split_once('*').unwrap();
                let expected = body.bytes().fold(0, |sum, byte| sum ^ byte);
                assert_eq!(sum, format!("{expected:02X}\r\n"));
                body.to_owned()
            };
            self.sentences.due(now).into_iter().map(body).collect()
        }

        fn command(&mut self, body: &str, second: u64) -> Option<Uuid> {
            let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
            let read = binnacle_nmea::parse(format!("${body}*{sum:02X}").as_bytes());
            let Ok(Data::Acn(command)) = read.map(|sentence| sentence.data) else {
                panic!("{body}: {read:?}")
            };
            let now = self.start + Duration::from_secs(second);
            let time = Timestamp::parse("2026-11-21T07:05:10Z").ok();
            self.sentences.command(&command, time, now)
        }
    }

    fn condition(id: u128) -> AlertCondition {
        AlertCondition {
            id: Uuid::from_u128(id),
            is_active: true,
            is_acknowledged: false,
            title: "HDG DIFFERENCE",
            description: "COMPASS AND GYRO DIFFER OVER 10 DEG".to_owned(),
        }
    }

    #[test]
    fn without_an_alert_the_list_is_empty_and_the_heart_beats() {
        let mut bridge = Bridge::new();
        assert_eq!(bridge.said(0), ["IIALC,01,01,00,0", "IIHBT,30,A,0"]);
        assert_eq!(bridge.said(29), [""; 0]);
        assert_eq!(bridge.said(30), ["IIALC,01,01,01,0", "IIHBT,30,A,1"]);
    }

    #[test]
    fn an_alert_is_reported_at_once_and_listed_until_it_is_normal() {
        let mut bridge = Bridge::new();
        bridge.said(0);
        bridge.conditions.difference = Some(condition(1));
        assert_eq!(
            bridge.said(1),
            [
                "IIALF,2,1,0,070509.12,B,W,V,BIN,10002,1,2,0,HDG DIFFERENCE",
                "IIALF,2,2,0,,,,,BIN,10002,1,2,0,COMPASS AND GYRO DIFFER OVER 10 DEG",
            ]
        );
        assert_eq!(bridge.said(2), [""; 0]);
        bridge.conditions.compass = Some(condition(2));
        assert!(bridge.said(3)[0].starts_with("IIALF,2,1,1,070509.12,B,W,V,BIN,10001,1,2,"));
        let list = "IIALC,01,01,01,2,BIN,10001,1,2,BIN,10002,1,2";
        assert_eq!(bridge.said(31)[0], list);
    }

    #[test]
    fn the_sentences_of_an_alert_are_parts_of_one_message() {
        let mut bridge = Bridge::new();
        bridge.conditions.difference = Some(condition(1));
        let now = bridge.start;
        bridge
            .sentences
            .update(bridge.conditions.clone(), None, now);
        let parts = bridge.sentences.due(now).into_iter().map(|line| line.part);
        let part = |number| Some(Part { number, total: 2 });
        assert_eq!(parts.collect::<Vec<_>>(), [part(1), part(2), None, None],);
    }

    #[test]
    fn a_command_of_the_bridge_acknowledges_the_alert_that_it_names() {
        let mut bridge = Bridge::new();
        bridge.conditions = AlertConditions {
            compass: Some(condition(1)),
            difference: Some(condition(2)),
            interference: Some(condition(3)),
        };
        bridge.said(0);
        for number in 1..=3 {
            let body = format!("CAACN,070510,BIN,{},1,A,C", 10_000 + number);
            let acknowledged = bridge.command(&body, 1);
            assert_eq!(acknowledged, Some(Uuid::from_u128(number)));
        }
        let difference = bridge.conditions.difference.as_mut().unwrap();
        difference.is_acknowledged = true;
        let said = bridge.said(1);
        assert!(said[0].contains(",B,W,A,BIN,10002,1,3,"), "{said:?}");
        assert_eq!(said.len(), 2);
        assert_eq!(bridge.command("CAACN,,BIN,10001,1,S,C", 2), None);
        let said = bridge.said(2);
        assert!(said[0].contains(",B,W,S,BIN,10001,1,3,"), "{said:?}");
        assert_eq!(said.len(), 2);
    }

    #[test]
    fn a_command_that_cannot_be_done_is_refused_by_its_letter() {
        let mut bridge = Bridge::new();
        bridge.said(0);
        for (body, refused) in [
            ("CAACN,,BIN,10001,1,A,C", "IIARC,070510.00,BIN,10001,1,A"),
            ("CAACN,,BIN,10001,1,O,C", "IIARC,070510.00,BIN,10001,1,O"),
            ("CAACN,,BIN,10777,1,Q,C", "IIARC,070510.00,BIN,10777,1,Q"),
            ("CAACN,,BIN,10002,9,S,C", "IIARC,070510.00,BIN,10002,9,S"),
        ] {
            assert_eq!(bridge.command(body, 1), None);
            assert_eq!(bridge.said(1), [refused]);
        }
    }

    #[test]
    fn commands_to_other_equipment_are_not_answered() {
        let mut bridge = Bridge::new();
        bridge.conditions.compass = Some(condition(1));
        bridge.said(0);
        for body in [
            "CAACN,,,10001,1,A,C",
            "CAACN,,FEC,10001,1,A,C",
            "CAACN,,,192,1,O,C",
        ] {
            assert_eq!(bridge.command(body, 1), None);
            assert_eq!(bridge.said(1), [""; 0]);
        }
    }

    #[test]
    fn what_the_bridge_asks_for_is_sent_again() {
        let mut bridge = Bridge::new();
        bridge.conditions.compass = Some(condition(1));
        let first = bridge.said(0);
        bridge.command("CAACN,,BIN,10001,,Q,C", 1);
        let again = bridge.said(1);
        assert_eq!(again[0].replace("ALF,2,1,1,", "ALF,2,1,0,"), first[0]);
    }
}
