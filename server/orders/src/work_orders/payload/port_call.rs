//! Port call of an order, and its changes.

use crate::work_orders::payload::hours::Hours;
use binnacle_platform::ids::CallId;
use binnacle_platform::time::Time;
use binnacle_schedule::ports::{self, PortCode};
use binnacle_schedule::time::Instant;
use binnacle_schedule::zone::Zone;
use chrono::{Days, SecondsFormat};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Fit of an order's time to its port call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = WorkOrderCallFit)]
pub enum CallFit {
    /// The vessel is alongside in the job's hours.
    Fits,
    /// The vessel is alongside long enough on that day, but not in those hours.
    OtherHour,
    /// The vessel is not alongside on that day: agree on another.
    NeedsNewDay,
    /// The call is withdrawn, or is at another port.
    NoCall,
}

/// Stay of a vessel alongside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = WorkOrderAlongside)]
pub struct Alongside {
    /// UN/LOCODE of the port.
    pub port: String,
    /// Expected time of arrival alongside.
    pub eta: Time,
    /// Expected time of departure.
    pub etd: Time,
    /// The ETA in the port's time.
    #[schema(example = "2026-12-08T07:00:00+01:00")]
    pub eta_local: String,
    /// The ETD in the port's time.
    #[schema(example = "2026-12-10T19:00:00+01:00")]
    pub etd_local: String,
}

/// Change of a port call.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = WorkOrderCallChange)]
pub(crate) struct CallChange {
    /// The call.
    pub call_id: CallId,
    /// Stay before.
    pub was: Alongside,
    /// Stay afterwards; `null` if withdrawn.
    #[schema(required)]
    pub is: Option<Alongside>,
    /// Fit of the agreed time.
    pub fit: CallFit,
    /// Author of the change.
    pub by: String,
}

impl Alongside {
    /// Stay at a port between two times.
    pub fn new(port: PortCode, eta: Time, etd: Time) -> Alongside {
        let zone = ports::zone(port);
        Alongside {
            port: port.to_string(),
            eta,
            etd,
            eta_local: local(eta, zone),
            etd_local: local(etd, zone),
        }
    }

    /// Judges the fit of a job's hours, for an order at a port.
    pub fn fit(&self, port: &str, hours: Hours) -> CallFit {
        if self.port != port {
            return CallFit::NoCall;
        }
        let (eta, etd) = (Instant(self.eta.0), Instant(self.etd.0));
        let planned = Instant(hours.from.0);
        if planned >= eta && Instant(hours.until.0) <= etd {
            return CallFit::Fits;
        }
        let zone = zone_of(port);
        let day = planned.date(zone);
        let [begins, ends] = [day, day + Days::new(1)].map(|day| zone.midnight(day));
        let alongside_h = etd.min(ends).hours_since(eta.max(begins));
        if alongside_h >= hours.length_h() {
            CallFit::OtherHour
        } else {
            CallFit::NeedsNewDay
        }
    }

    pub(crate) fn describe(&self) -> String {
        let zone = zone_of(&self.port);
        let (eta, etd) = (in_both_zones(self.eta, zone), in_both_zones(self.etd, zone));
        format!("from {eta} to {etd}")
    }
}

/// Legal time zone of a port.
pub(crate) fn zone_of(port: &str) -> Zone {
    PortCode::parse(port).map_or_else(|_| Zone::utc(), ports::zone)
}

fn local(at: Time, zone: Zone) -> String {
    let there = Instant(at.0).in_zone(zone);
    there.to_rfc3339_opts(SecondsFormat::Secs, false)
}

/// Writes a time in UTC and in the port's time.
pub(crate) fn in_both_zones(at: Time, zone: Zone) -> String {
    let there = Instant(at.0).in_zone(zone).format("%Y-%m-%d %H:%M");
    let offset = Instant(at.0).in_zone(zone).format("%:z");
    format!("{} ({there} port's time, UTC{offset})", at.to_the_minute())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time(text: &str) -> Time {
        Time(Instant::parse(text).unwrap().0)
    }

    /// The usual three hours from a time.
    fn job(from: Time) -> Hours {
        Hours::new(from, None)
    }

    fn rotterdam(eta: &str, etd: &str) -> Alongside {
        Alongside::new(PortCode::parse("NLRTM").unwrap(), time(eta), time(etd))
    }

    #[test]
    fn a_time_fits_a_call_for_three_hours_before_she_leaves() {
        let call = rotterdam("2026-12-08T06:00:00Z", "2026-12-08T18:00:00Z");
        for (at, fit) in [
            ("2026-12-08T05:59:00Z", CallFit::OtherHour),
            ("2026-12-08T06:00:00Z", CallFit::Fits),
            ("2026-12-08T15:00:00Z", CallFit::Fits),
            ("2026-12-08T15:01:00Z", CallFit::OtherHour),
            ("2026-12-07T12:00:00Z", CallFit::NeedsNewDay),
            ("2026-12-09T12:00:00Z", CallFit::NeedsNewDay),
        ] {
            assert_eq!(call.fit("NLRTM", job(time(at))), fit, "{at}");
        }
        let until = |until| Hours::new(time("2026-12-08T10:00:00Z"), Some(time(until)));
        assert_eq!(
            call.fit("NLRTM", until("2026-12-08T18:00:00Z")),
            CallFit::Fits
        );
        assert_eq!(
            call.fit("NLRTM", until("2026-12-08T19:00:00Z")),
            CallFit::OtherHour
        );
        assert_eq!(
            call.fit("NLRTM", until("2026-12-08T23:00:00Z")),
            CallFit::NeedsNewDay
        );
        let there = time("2026-12-08T08:00:00Z");
        assert_eq!(call.fit("BEANR", job(there)), CallFit::NoCall);
    }

    #[test]
    fn a_day_is_the_ports() {
        // In Yokohama, nine hours ahead, the ninth begins at 15:00 UTC of the eighth.
        let port = PortCode::parse("JPYOK").unwrap();
        let call = Alongside::new(
            port,
            time("2026-12-08T16:00:00Z"),
            time("2026-12-08T23:00:00Z"),
        );
        assert_eq!(call.eta_local, "2026-12-09T01:00:00+09:00");
        let noon = time("2026-12-09T03:00:00Z");
        assert_eq!(call.fit("JPYOK", job(noon)), CallFit::OtherHour);
        let eighth = time("2026-12-08T03:00:00Z");
        assert_eq!(call.fit("JPYOK", job(eighth)), CallFit::NeedsNewDay);
    }

    #[test]
    fn west_of_greenwich_a_ports_time_is_behind() {
        let port = PortCode::parse("USNYC").unwrap();
        let at = time("2026-12-08T03:00:00Z");
        let call = Alongside::new(port, at, time("2026-12-09T00:00:00Z"));
        assert_eq!(call.eta_local, "2026-12-07T22:00:00-05:00");
    }

    #[test]
    fn a_day_on_which_clocks_go_back_is_an_hour_longer() {
        let port = PortCode::parse("ESVGO").unwrap();
        // From 21:00 on, Vigo's time, which is 20:00 UTC in winter.
        let (eta, etd) = (time("2026-10-25T20:00:00Z"), time("2026-10-26T20:00:00Z"));
        let call = Alongside::new(port, eta, etd);
        assert_eq!(call.eta_local, "2026-10-25T21:00:00+01:00");
        let noon = time("2026-10-25T11:00:00Z");
        assert_eq!(call.fit("ESVGO", job(noon)), CallFit::OtherHour);
        let later = Alongside::new(port, time("2026-10-25T20:01:00Z"), etd);
        assert_eq!(later.fit("ESVGO", job(noon)), CallFit::NeedsNewDay);
        // In summer the same hour is 19:00 UTC.
        let july = Alongside::new(port, time("2026-07-15T19:00:00Z"), etd);
        assert_eq!(july.eta_local, "2026-07-15T21:00:00+02:00");
    }
}
