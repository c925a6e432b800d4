//! `[uplink]` and `[modem]`: the connection to the server.

use super::error::Problem;
use super::profile::{ConnectionPolicy, EXCHANGE_TIMEOUT, Profile, UploadPlan};
use binnacle_instruments::config::PositiveSeconds;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::time::Duration;
use toml::Spanned;

/// Connection to the server.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct UplinkConfig {
    /// PEM file with the only trusted certificate authority.
    pub(crate) pinned_ca: Option<PathBuf>,
    /// Allows an http server on another computer, as in a VPN.
    pub(crate) allow_plain_http: bool,
    /// Cost class of the link: upload interval and daily byte budget.
    pub(crate) profile: Spanned<Profile>,
    /// Daily budget that replaces the profile's.
    pub(crate) day_kb: Option<DailyBudget>,
    /// Interval of polls when nothing was sent, in place of the profile's.
    pub(crate) poll_s: Option<PositiveSeconds>,
    /// Timeout of an exchange with the server.
    pub(crate) exchange_s: PositiveSeconds,
    /// Upper bound of the first pause after a failure.
    pub(crate) retry_min_s: Spanned<PositiveSeconds>,
    /// Longest pause after failures.
    pub(crate) retry_max_s: Spanned<PositiveSeconds>,
}

impl Default for UplinkConfig {
    fn default() -> UplinkConfig {
        UplinkConfig {
            pinned_ca: None,
            allow_plain_http: false,
            profile: Spanned::new(0..0, Profile::default()),
            day_kb: None,
            poll_s: None,
            exchange_s: PositiveSeconds(EXCHANGE_TIMEOUT.as_secs_f64()),
            retry_min_s: Spanned::new(0..0, PositiveSeconds(30.0)),
            retry_max_s: Spanned::new(0..0, PositiveSeconds(3_600.0)),
        }
    }
}

impl UplinkConfig {
    /// Returns the upload plan of profile and budget.
    pub(crate) fn plan(&self) -> UploadPlan {
        self.profile
            .get_ref()
            .plan(self.day_kb.map(DailyBudget::bytes))
    }

    /// Returns the connection policy.
    pub(crate) fn connection_policy(&self) -> ConnectionPolicy {
        ConnectionPolicy {
            exchange_timeout: self.exchange_s.duration(),
            allows_plain_http: self.allow_plain_http,
            ..self.plan().connection_policy()
        }
    }

    /// Fails when settings contradict each other.
    pub(super) fn check(&self, modem: Option<&ModemConfig>) -> Result<(), Problem> {
        let is_burst = *self.profile.get_ref() == Profile::ShortBurst;
        match modem {
            None if is_burst => {
                let problem = "short-burst needs a [modem]".to_owned();
                return Err(Problem::at(self.profile.span(), problem));
            }
            Some(modem) if !is_burst => {
                let problem = "a modem needs the profile short-burst".to_owned();
                return Err(Problem::at(modem.directory.span(), problem));
            }
            _ => {}
        }
        let (min, max) = (&self.retry_min_s, &self.retry_max_s);
        if min.get_ref() > max.get_ref() {
            // A default has no position in the file.
            let (wrong, other) = if min.span().is_empty() {
                (max, format!("less than retry_min_s, {}", min.get_ref().0))
            } else {
                (min, format!("more than retry_max_s, {}", max.get_ref().0))
            };
            let problem = format!("{} is {other}", wrong.get_ref().0);
            return Err(Problem::at(wrong.span(), problem));
        }
        Ok(())
    }

    /// Returns the interval of polls when nothing was sent.
    pub(crate) fn poll(&self) -> Duration {
        self.poll_s
            .map_or_else(|| self.plan().poll(), PositiveSeconds::duration)
    }
}

/// Modem for short-burst messages.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModemConfig {
    /// Folder with `out` for messages to send and `in` for received ones.
    directory: Spanned<PathBuf>,
}

impl ModemConfig {
    /// Returns the folder.
    pub(crate) fn directory(&self) -> &Path {
        self.directory.get_ref()
    }

    pub(super) fn resolve(&mut self, base: &Path) {
        let directory = base.join(self.directory.get_ref());
        *self.directory.get_mut() = directory;
    }
}

/// Kilobytes (of a thousand bytes) a day, from 3, one exchange, to a million.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(crate) struct DailyBudget(f64);

impl DailyBudget {
    /// Returns the budget in bytes.
    pub(crate) fn bytes(self) -> f64 {
        self.0 * 1e3
    }
}

impl TryFrom<f64> for DailyBudget {
    type Error = String;
    fn try_from(kilobytes: f64) -> Result<DailyBudget, String> {
        if (3.0..=1e6).contains(&kilobytes) {
            Ok(DailyBudget(kilobytes))
        } else {
            Err(format!(
                "{kilobytes} is not from 3 to 1000000 kilobytes a day"
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{
        parse,
        tests::{WHOLE, message},
    };
    use super::*;

    #[test]
    fn a_profile_says_how_often_and_for_how_much_and_single_settings_override_it() {
        let bare = parse("data_dir = \"d\"").map_err(|w| w.problem).unwrap();
        let plan = bare.uplink.plan();
        assert_eq!((plan.seal_s, plan.daily_bytes), (21_600, None));
        let uplink = |lines: &str| {
            let text = format!("data_dir = \"d\"\n[uplink]\n{lines}");
            parse(&text).map_err(|w| w.problem).unwrap().uplink
        };
        let metered = uplink("profile = \"metered\"");
        assert_eq!(metered.plan().seal_s, 86_400);
        assert_eq!(metered.plan().daily_bytes, Some(8_000.0));
        assert_eq!(metered.poll(), Duration::from_hours(36));
        let own = uplink("profile = \"very-metered\"\nday_kb = 12\npoll_s = 60");
        assert_eq!(own.plan().daily_bytes, Some(12_000.0));
        assert_eq!(own.poll(), Duration::from_mins(1));
        assert_eq!(
            own.connection_policy().exchange_timeout,
            Duration::from_mins(10)
        );
        let hasty = uplink("exchange_s = 2");
        assert_eq!(
            hasty.connection_policy().exchange_timeout,
            Duration::from_secs(2)
        );
        let wrong = WHOLE.replace("poll_s = 21600", "profile = \"modem\"");
        let said = message(&wrong);
        assert!(
            said.starts_with("agent.toml:19: profile: ") && said.contains("very-metered"),
            "{said}"
        );
        let wrong = WHOLE.replace("poll_s = 21600", "day_kb = 0.5");
        assert_eq!(
            message(&wrong),
            "agent.toml:19: day_kb: 0.5 is not from 3 to 1000000 kilobytes a day"
        );
    }

    #[test]
    fn short_bursts_and_a_modem_go_together() {
        let short = WHOLE.replace("poll_s = 21600", "profile = \"short-burst\"");
        assert_eq!(
            message(&short),
            "agent.toml:19: profile: short-burst needs a [modem]"
        );
        let with = format!("{short}\n[modem]\ndirectory = \"sat\"");
        let config = parse(&with).map_err(|w| w.problem).unwrap();
        assert_eq!(config.modem.unwrap().directory(), Path::new("sat"));
        let alone = format!("{WHOLE}\n[modem]\ndirectory = \"sat\"");
        assert_eq!(
            message(&alone),
            "agent.toml:26: directory: a modem needs the profile short-burst"
        );
    }
}
