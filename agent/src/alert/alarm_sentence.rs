//! The agent's alert for an alarm panel: `ALR` of IEC 61162-1, talker II.
//!
//! `$IIALR,time of change,alarm number,condition,acknowledged,text*hh`: condition A while the alert
//! is open and V otherwise; acknowledged A or V. It is sent at once after a change, and every half
//! minute.

use super::record::AlertRecord;
use binnacle_instruments::AGENT_TALKER;
use binnacle_output::frame_sentence;
use binnacle_wire::alert::ShipAlertState;
use std::time::Duration;
use tokio::time::Instant;

const REPEAT_INTERVAL: Duration = Duration::from_secs(30);
/// Number of the agent's only alarm.
const ALARM_NUMBER: &str = "001";

/// Last sentence and its time.
#[derive(Debug, Default)]
pub(crate) struct AlarmSentence {
    last_sent: Option<(String, Instant)>,
}

impl AlarmSentence {
    /// Returns the sentence with its line end, when it is due.
    pub(crate) fn due(&mut self, record: Option<&AlertRecord>, now: Instant) -> Option<Vec<u8>> {
        let body = body(record);
        let is_due = self.last_sent.as_ref().is_none_or(|(last_sent, at)| {
            *last_sent != body || now.saturating_duration_since(*at) >= REPEAT_INTERVAL
        });
        if !is_due {
            return None;
        }
        let sentence = frame_sentence(&body);
        self.last_sent = Some((body, now));
        Some(sentence)
    }
}

fn body(record: Option<&AlertRecord>) -> String {
    let talker = String::from_utf8_lossy(&AGENT_TALKER);
    let Some(record) = record else {
        return format!("{talker}ALR,,{ALARM_NUMBER},V,A,NO ALERT OF THE COMPASS");
    };
    let time = record.alert.at.to_string();
    // 2026-11-21T07:05:00Z
    let time: String = time
        .chars()
        .skip(11)
        .take(8)
        .filter(|c| *c != ':')
        .collect();
    let (condition, state) = match record.alert.state {
        ShipAlertState::Open => ('A', "PARTED"),
        ShipAlertState::Agree => ('V', "AGREE"),
        ShipAlertState::NotJudged => ('V', "NOT JUDGED"),
    };
    let reference = record.alert.reference().to_uppercase();
    let acknowledged = if record.acknowledged { 'A' } else { 'V' };
    format!(
        "{talker}ALR,{time}.00,{ALARM_NUMBER},{condition},{acknowledged},COMPASS AND {reference} {state}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::time::Timestamp;
    use binnacle_wire::alert::ShipAlert;
    use uuid::Uuid;

    fn record(state: ShipAlertState, acknowledged: bool) -> AlertRecord {
        let at = Timestamp::parse("2026-11-21T07:05:09Z").unwrap();
        AlertRecord {
            alert: ShipAlert {
                id: Uuid::from_u128(1),
                revision: 1,
                state,
                since: at,
                at,
                gyro_departure_deg: Some(20.0),
                satellite_departure_deg: None,
                limit_deg: 4.0,
                model_version: 1,
            },
            acknowledged,
            followed_up: false,
            departed_sectors: 1,
            raised_limit_deg: None,
            clearance_revoked: false,
        }
    }

    fn text(sentence: Option<Vec<u8>>) -> String {
        String::from_utf8(sentence.unwrap()).unwrap()
    }

    #[test]
    fn the_checksum_is_the_exclusive_or_of_what_lies_between_dollar_and_star() {
        let open = record(ShipAlertState::Open, false);
        let last_sent = text(AlarmSentence::default().due(Some(&open), Instant::now()));

        assert_eq!(
            last_sent,
            "$IIALR,070509.00,001,A,V,COMPASS AND GYRO PARTED*5E\r\n"
        );
        assert!(last_sent.len() <= 82, "{}", last_sent.len());
    }

    #[test]
    fn it_is_said_at_every_change_and_every_half_minute() {
        let mut alarm = AlarmSentence::default();
        let start = Instant::now();
        let after = |seconds| start + Duration::from_secs(seconds);
        assert!(text(alarm.due(None, start)).starts_with("$IIALR,,001,V,A,"));
        assert_eq!(alarm.due(None, after(29)), None);
        assert!(alarm.due(None, after(30)).is_some());
        let open = record(ShipAlertState::Open, false);
        assert!(text(alarm.due(Some(&open), after(31))).contains(",001,A,V,"));
        assert_eq!(alarm.due(Some(&open), after(32)), None);
        let seen = record(ShipAlertState::Open, true);
        assert!(text(alarm.due(Some(&seen), after(33))).contains(",001,A,A,"));
        let over = record(ShipAlertState::Agree, true);
        let last_sent = text(alarm.due(Some(&over), after(34)));
        assert!(
            last_sent.contains(",001,V,A,COMPASS AND GYRO AGREE*"),
            "{last_sent}"
        );
    }

    #[test]
    fn it_names_the_satellite_compass_where_there_is_no_gyro() {
        for state in [ShipAlertState::Open, ShipAlertState::NotJudged] {
            let mut open = record(state, false);
            open.alert.gyro_departure_deg = None;
            open.alert.satellite_departure_deg = Some(20.0);
            let last_sent = text(AlarmSentence::default().due(Some(&open), Instant::now()));
            assert!(
                last_sent.contains(",COMPASS AND SATELLITE COMPASS "),
                "{last_sent}"
            );
            assert!(last_sent.len() <= 82, "{last_sent}");
        }
    }

    #[test]
    fn what_nobody_judged_is_not_said_to_agree() {
        let withdrawn = record(ShipAlertState::NotJudged, true);
        for record in [Some(&withdrawn), None] {
            let last_sent = text(AlarmSentence::default().due(record, Instant::now()));
            assert!(last_sent.contains(",001,V,"), "{last_sent}");
            assert!(!last_sent.contains("AGREE"), "{last_sent}");
        }
    }
}
