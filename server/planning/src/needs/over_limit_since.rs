//! Dates since which a compass's deviation at the vessel's position has exceeded each level.
//!
//! Invariants: an observation keeps a level and its date exactly if the deviation was at least
//! that large at every observation since. A prediction that is too uncertain is no observation.

use binnacle_platform::db::{Db, Result, Tx, execute, rows};
use binnacle_platform::ids::{CompassId, OperatorId, VesselId};
use chrono::NaiveDate;
use std::collections::BTreeMap;

/// Step between levels, degrees. Without it each day would add a level.
const STEP_DEG: f64 = 0.1;

/// Days, each with the level in degrees that the deviation has had or exceeded since. Later days
/// have higher levels.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct DeviationHistory(Vec<(NaiveDate, f64)>);

impl DeviationHistory {
    /// Returns the history after one more observation.
    pub(super) fn with_observation(&self, on: NaiveDate, worst_deg: f64) -> DeviationHistory {
        let level_deg = (worst_deg / STEP_DEG + 1e-6).floor() * STEP_DEG;
        let mut levels = self.0.clone();
        let mut since = on;
        while let Some((day, _)) = levels.pop_if(|(_, deg)| *deg > level_deg - STEP_DEG / 2.0) {
            since = since.min(day);
        }
        levels.push((since, level_deg));
        DeviationHistory(levels)
    }

    /// Returns the days and levels, the earliest first.
    pub(super) fn levels(&self) -> impl Iterator<Item = (NaiveDate, f64)> {
        self.0.iter().copied()
    }
}

/// Returns the stored history of each compass of an operator's vessels in a range of ids.
pub(super) async fn list_histories(
    db: &Db,
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
) -> Result<BTreeMap<(VesselId, CompassId), DeviationHistory>> {
    let found = rows!(
        db,
        (VesselId, CompassId, String, f64),
        "SELECT s.vessel_id, s.compass_id, s.since, s.at_least_deg FROM deviation_since s
         JOIN vessels v ON v.id = s.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
         ORDER BY s.vessel_id, s.compass_id, s.since",
        operator,
        first,
        last
    )?;
    let mut histories: BTreeMap<_, DeviationHistory> = BTreeMap::new();
    for (vessel, compass, since, level_deg) in found {
        let since: NaiveDate = since
            .parse()
            .map_err(|error: chrono::ParseError| sqlx::Error::Decode(error.into()))?;
        histories
            .entry((vessel, compass))
            .or_default()
            .0
            .push((since, level_deg));
    }
    Ok(histories)
}

/// Stores the history of a compass, in place of the earlier one.
pub(super) async fn store_history(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    history: &DeviationHistory,
) -> Result<()> {
    execute!(
        &mut *tx,
        "DELETE FROM deviation_since WHERE vessel_id = $1 AND compass_id = $2",
        vessel,
        compass
    )?;
    for (day, level_deg) in history.levels() {
        execute!(
            &mut *tx,
            "INSERT INTO deviation_since (vessel_id, compass_id, since, at_least_deg)
             VALUES ($1, $2, $3, $4)
             ON CONFLICT (vessel_id, compass_id, since) DO UPDATE SET at_least_deg = $4",
            vessel,
            compass,
            day.to_string(),
            level_deg
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn day(of_november: u32) -> NaiveDate {
        NaiveDate::from_ymd_opt(2026, 11, of_november).unwrap()
    }

    fn first_over(since: &DeviationHistory, limit_deg: f64) -> Option<NaiveDate> {
        let mut over = since.levels().filter(|(_, deg)| *deg > limit_deg);
        over.next().map(|(day, _)| day)
    }

    #[test]
    fn a_limit_is_exceeded_since_the_first_of_the_days_over_it() {
        let observations = [(1, 4.0), (2, 6.0), (3, 5.5), (5, 7.25), (6, 5.5), (9, 6.0)];
        let since = observations
            .iter()
            .fold(DeviationHistory::default(), |since, (on, deg)| {
                since.with_observation(day(*on), *deg)
            });
        assert_eq!(first_over(&since, 3.0), Some(day(1)));
        assert_eq!(first_over(&since, 5.0), Some(day(2)));
        assert_eq!(first_over(&since, 5.8), Some(day(9)));
        assert_eq!(first_over(&since, 6.5), None);
    }

    #[test]
    fn a_day_below_the_limit_restarts_the_history() {
        let since = DeviationHistory::default()
            .with_observation(day(1), 6.0)
            .with_observation(day(2), 4.9);
        assert_eq!(first_over(&since, 5.0), None);
        assert_eq!(
            first_over(&since.with_observation(day(3), 6.0), 5.0),
            Some(day(3))
        );
    }

    #[test]
    fn a_deviation_that_varies_little_keeps_few_days() {
        let varying = (1..29).fold(DeviationHistory::default(), |since, on| {
            since.with_observation(day(on), 6.03 + 0.01 * f64::from(on % 5))
        });
        assert_eq!(varying.levels().count(), 1);
        assert_eq!(first_over(&varying, 5.0), Some(day(1)));
    }
}
