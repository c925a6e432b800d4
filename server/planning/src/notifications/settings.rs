//! Notification settings of a person: ways of delivery, quiet hours and digest.
//!
//! Invariant: times of day are in the person's own time zone, also when its clocks change.

use super::channel::Channel;
use super::kinds::NoticeKinds;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::notices::{DeclaredKind, Kind};
use binnacle_platform::session::Role;
use binnacle_platform::time::Time;
use binnacle_schedule::time::Instant;
use binnacle_schedule::zone::Zone;
use chrono::{Datelike, Days, NaiveDate, NaiveDateTime, NaiveTime};
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Notification settings of a person.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NotificationSettings, example = json!({
    "time_zone": "Europe/Madrid",
    "ways": { "due_soon": "digest", "answered": "mail", "on_board": "list", "alert": "mail" },
    "quiet_hours": { "from": "22:00", "to": "07:00" },
    "digest": { "every": "week", "on": "monday", "at": "07:30" }
}))]
pub(super) struct Settings {
    /// IANA name of the time zone; UTC by default.
    #[serde(default = "Zone::utc")]
    #[schema(value_type = String, example = "Europe/Madrid")]
    pub(super) time_zone: Zone,
    /// Way of delivery for each kind; a kind that is left out has the default way.
    #[serde(default)]
    #[schema(value_type = BTreeMap<Kind, Channel>)]
    pub(super) ways: IndexMap<String, Channel>,
    /// Hours without mail, except for critical alerts. Mail is held until they end.
    #[serde(default)]
    #[schema(required)]
    pub(super) quiet_hours: Option<QuietHours>,
    /// Time of the digest; each day at 07:00 by default.
    #[serde(default)]
    pub(super) digest: Digest,
}

/// A time of day, to the minute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub(super) struct TimeOfDay(NaiveTime);

/// Hours without mail; over midnight if `to` is before `from`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct QuietHours {
    /// Start.
    #[schema(value_type = String, example = "22:00")]
    pub(super) from: TimeOfDay,
    /// End.
    #[schema(value_type = String, example = "07:00")]
    pub(super) to: TimeOfDay,
}

/// Time of the digest; an empty one is not sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "every", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Digest {
    /// Each day.
    Day {
        /// At this time of day.
        #[schema(value_type = String, example = "07:00")]
        at: TimeOfDay,
    },
    /// Once a week.
    Week {
        /// On this day.
        on: Weekday,
        /// At this time of day.
        #[schema(value_type = String, example = "07:00")]
        at: TimeOfDay,
    },
}

/// A day of the week.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Weekday {
    Monday,
    Tuesday,
    Wednesday,
    Thursday,
    Friday,
    Saturday,
    Sunday,
}

impl Default for Digest {
    fn default() -> Digest {
        let seven = NaiveTime::from_hms_opt(7, 0, 0).expect("07:00:00 is a time of day");
        Digest::Day {
            at: TimeOfDay(seven),
        }
    }
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            time_zone: Zone::utc(),
            ways: IndexMap::new(),
            quiet_hours: None,
            digest: Digest::default(),
        }
    }
}

impl TryFrom<String> for TimeOfDay {
    type Error = String;

    fn try_from(text: String) -> std::result::Result<TimeOfDay, String> {
        let read = NaiveTime::parse_from_str(&text, "%H:%M").ok();
        let whole = read.filter(|_| text.len() == 5).map(TimeOfDay);
        whole.ok_or_else(|| format!("{text:?} is not a time of day such as 07:30"))
    }
}

impl From<TimeOfDay> for String {
    fn from(time: TimeOfDay) -> String {
        time.0.format("%H:%M").to_string()
    }
}

impl Settings {
    /// Returns the settings with their ways in the order of the kinds, if they suit the role.
    ///
    /// # Errors
    /// Fails when a kind is unknown or never reaches the role, or when quiet hours and digest
    /// collide.
    pub(super) fn checked(mut self, role: Role, kinds: &NoticeKinds) -> Result<Settings> {
        let invalid = |field, detail: &str| {
            Err(Error::Invalid {
                field,
                detail: detail.to_owned(),
            })
        };
        for name in self.ways.keys() {
            match kinds.find(name) {
                Err(problem) => return invalid("body", &format!("ways: {problem}")),
                Ok(kind) if !kind.readers.include(role) => {
                    return invalid("ways", "has a kind that does not concern you");
                }
                Ok(_) => {}
            }
        }
        self.ways
            .sort_by_key(|name, _| kinds.names().position(|known| known == name));
        if let Some(quiet) = self.quiet_hours {
            if quiet.from == quiet.to {
                return invalid("quiet_hours", "start and end at the same time");
            }
            if quiet.contains(self.digest.at()) {
                return invalid("digest", "is during the quiet hours");
            }
        }
        Ok(self)
    }

    /// Returns the way of delivery for a kind.
    pub(super) fn way(&self, kind: DeclaredKind, role: Role) -> Channel {
        let chosen = self.ways.get(kind.name()).copied();
        chosen.unwrap_or_else(|| Channel::default_for(kind, role))
    }

    /// Returns the time of the mail for an event that happens now; `None` for no mail.
    pub(super) fn mail_at(&self, way: Channel, urgent: bool, now: Time) -> Option<Time> {
        match way {
            Channel::Mail | Channel::Digest if urgent => Some(now),
            Channel::Mail => Some(self.after_quiet_hours(now)),
            Channel::Digest => Some(self.next_digest(now)),
            Channel::List | Channel::Off => None,
        }
    }

    /// Returns now, or the end of the current quiet hours.
    fn after_quiet_hours(&self, now: Time) -> Time {
        let local = self.local(now);
        let Some(quiet) = self.quiet_hours else {
            return now;
        };
        if !quiet.contains(TimeOfDay(local.time())) {
            return now;
        }
        let ends_today = local.time() < quiet.to.0;
        let day = if ends_today {
            local.date()
        } else {
            local.date() + Days::new(1)
        };
        self.instant(day, quiet.to).max(now)
    }

    /// Returns the time of the next digest.
    pub(super) fn next_digest(&self, now: Time) -> Time {
        let today = self.local(now).date();
        let days = (0..=8).filter_map(|ahead| today.checked_add_days(Days::new(ahead)));
        let mut digests = days
            .filter(|day| self.digest.is_on(*day))
            .map(|day| self.instant(day, self.digest.at()));
        digests.find(|at| *at > now).unwrap_or(now)
    }

    fn local(&self, at: Time) -> NaiveDateTime {
        self.time_zone.local(Instant(at.0))
    }

    /// Returns the instant of a local time: the first of two when clocks go back, the next when
    /// clocks skip it.
    fn instant(&self, day: NaiveDate, at: TimeOfDay) -> Time {
        Time(self.time_zone.instant(day.and_time(at.0)).0)
    }
}

impl QuietHours {
    fn contains(&self, time: TimeOfDay) -> bool {
        if self.from < self.to {
            (self.from..self.to).contains(&time)
        } else {
            time >= self.from || time < self.to
        }
    }
}

impl Digest {
    fn at(&self) -> TimeOfDay {
        match self {
            Digest::Day { at } | Digest::Week { at, .. } => *at,
        }
    }

    fn is_on(&self, day: NaiveDate) -> bool {
        match self {
            Digest::Day { .. } => true,
            Digest::Week { on, .. } => *on as u32 == day.weekday().num_days_from_monday(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::time::Timestamp;
    use binnacle_fleet::alerts::NOTICE_KIND;
    use binnacle_orders::work_orders::notice_kinds::{ANSWERED, OFFERED};
    use serde_json::json;

    fn settings(value: serde_json::Value) -> Settings {
        serde_json::from_value(value).unwrap()
    }

    fn kinds() -> NoticeKinds {
        [OFFERED, ANSWERED, NOTICE_KIND].into_iter().collect()
    }

    fn time(text: &str) -> Time {
        Time(Timestamp::parse(text).unwrap())
    }

    #[test]
    fn quiet_hours_hold_mail_until_they_end_in_local_time() {
        let madrid = settings(json!({
            "time_zone": "Europe/Madrid", "quiet_hours": { "from": "22:00", "to": "07:00" }
        }));
        for (now, then) in [
            // In winter Madrid is an hour ahead of UTC, in summer two.
            ("2026-11-21T20:59:00Z", "2026-11-21T20:59:00Z"),
            ("2026-11-21T21:00:00Z", "2026-11-22T06:00:00Z"),
            ("2026-11-22T05:59:59Z", "2026-11-22T06:00:00Z"),
            ("2026-11-22T06:00:00Z", "2026-11-22T06:00:00Z"),
            ("2026-07-01T21:30:00Z", "2026-07-02T05:00:00Z"),
            // The night in which clocks go forward is an hour shorter.
            ("2026-03-28T22:00:00Z", "2026-03-29T05:00:00Z"),
        ] {
            let found = madrid.mail_at(Channel::Mail, false, time(now));
            assert_eq!(found, Some(time(then)), "{now}");
            assert_eq!(
                madrid.mail_at(Channel::Mail, true, time(now)),
                Some(time(now))
            );
        }
        let noon = settings(json!({
            "time_zone": "Pacific/Auckland", "quiet_hours": { "from": "12:00", "to": "13:00" }
        }));
        let found = noon.mail_at(Channel::Mail, false, time("2026-11-20T23:30:00Z"));
        assert_eq!(found, Some(time("2026-11-21T00:00:00Z")));
    }

    #[test]
    fn a_skipped_local_time_becomes_the_next() {
        let madrid = settings(json!({
            "time_zone": "Europe/Madrid", "digest": { "every": "day", "at": "02:30" }
        }));
        let next = madrid.next_digest(time("2026-03-28T12:00:00Z"));
        assert_eq!(next, time("2026-03-29T01:00:00Z"));
        // And the first of two where it is put back.
        let next = madrid.next_digest(time("2026-10-24T12:00:00Z"));
        assert_eq!(next, time("2026-10-25T00:30:00Z"));
    }

    #[test]
    fn a_digest_is_sent_on_its_day_and_never_now() {
        let weekly = settings(json!({
            "time_zone": "Asia/Singapore",
            "digest": { "every": "week", "on": "monday", "at": "07:30" }
        }));
        for (now, then) in [
            ("2026-11-21T07:00:00Z", "2026-11-22T23:30:00Z"),
            ("2026-11-22T23:29:59Z", "2026-11-22T23:30:00Z"),
            ("2026-11-22T23:30:00Z", "2026-11-29T23:30:00Z"),
        ] {
            assert_eq!(weekly.next_digest(time(now)), time(then), "{now}");
        }
        let daily = Settings::default();
        let next = daily.next_digest(time("2026-11-21T07:00:00Z"));
        assert_eq!(next, time("2026-11-22T07:00:00Z"));
    }

    #[test]
    fn invalid_settings_are_refused() {
        for bad in [
            json!({ "time_zone": "Europe/Atlantis" }),
            json!({ "time_zone": "UTC", "quiet_hours": { "from": "24:00", "to": "07:00" } }),
            json!({ "quiet_hours": { "from": "7:00", "to": "22:00" } }),
            json!({ "digest": { "every": "month", "at": "07:00" } }),
            json!({ "digest": { "every": "week", "at": "07:00" } }),
            json!({ "ways": { "alert": "pigeon" } }),
            json!({ "colour": "blue" }),
        ] {
            assert!(
                serde_json::from_value::<Settings>(bad.clone()).is_err(),
                "{bad}"
            );
        }
        for bad in [
            json!({ "quiet_hours": { "from": "07:00", "to": "07:00" } }),
            json!({ "quiet_hours": { "from": "22:00", "to": "08:00" } }),
            json!({ "ways": { "offered": "mail" } }),
            json!({ "ways": { "gossip": "mail" } }),
        ] {
            let checked = settings(bad.clone()).checked(Role::Admin, &kinds());
            assert!(checked.is_err(), "{bad}");
        }
    }

    #[test]
    fn ways_are_kept_in_the_order_of_the_kinds() {
        let given = settings(json!({ "ways": { "alert": "list", "answered": "mail" } }));
        let checked = given.checked(Role::Admin, &kinds()).unwrap();
        let names: Vec<&str> = checked.ways.keys().map(String::as_str).collect();
        assert_eq!(names, ["answered", "alert"]);
    }
}
