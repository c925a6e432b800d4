//! Thresholds, false alarms and delays, counted alike for every detector.

use crate::FALSE_ALARMS_A_YEAR;
use crate::ship::Ship;

const DAY_S: f64 = 86_400.0;
/// Time after an alarm for which a detector is ignored, before it begins again.
pub(crate) const UNHEARD_S: f64 = 3.0 * DAY_S;
/// Rows in an hour of settled sailing.
const ROWS_AN_HOUR: f64 = 6.0;

/// Logarithm of the rows to a false alarm, were the ship always under way.
pub(crate) fn ln_run_length() -> f64 {
    (365.25 * 24.0 * ROWS_AN_HOUR / FALSE_ALARMS_A_YEAR).ln()
}

/// Returns the alarms of a detector that reads `items`, each known from its row on: `step`
/// returns whether one is an alarm, and learns when to begin again.
pub(crate) fn listen<T>(
    ship: &Ship,
    items: impl Iterator<Item = T>,
    row_of: impl Fn(&T) -> usize,
    mut step: impl FnMut(T, bool) -> bool,
) -> Vec<usize> {
    let time = |row: usize| ship.rows[row].time;
    let mut alarms: Vec<usize> = Vec::new();
    let mut anew = false;
    for item in items {
        let row = row_of(&item);
        let last = alarms.last().copied();
        if last.is_some_and(|last| time(row).seconds_since(time(last)) < UNHEARD_S) {
            anew = true;
            continue;
        }
        if step(item, std::mem::take(&mut anew)) && row >= ship.watched {
            alarms.push(row);
        }
    }
    alarms
}

/// The least threshold at which ships without an event give no more false alarms than
/// are allowed.
pub(crate) fn threshold(ships: &[Ship], alarms: crate::Detector) -> f64 {
    let (mut low, mut high) = (0.1_f64, 1e4_f64);
    while high / low > 1.001 {
        let middle = (low * high).sqrt();
        let found: Vec<_> = ships.iter().map(|ship| alarms(ship, middle)).collect();
        if false_alarms(ships, &found).0 > FALSE_ALARMS_A_YEAR {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// False alarms a vessel-year, and their standard error.
pub(crate) fn false_alarms(ships: &[Ship], found: &[Vec<usize>]) -> (f64, f64) {
    let years: f64 = ships.iter().map(Ship::years).sum();
    let count = found.iter().map(Vec::len).sum::<usize>() as f64;
    (count / years, count.max(1.0).sqrt() / years)
}

/// Time until the event of one ship was found.
struct Delay {
    /// Days by the clock; infinite where it was not found.
    days: f64,
    /// Hours of settled sailing.
    hours: f64,
    /// Delay of Lorden's bound, hours; infinite where the voyage ends before.
    bound_hours: f64,
}

/// Delays over the ships of a fleet.
pub(crate) struct Delays(Vec<Delay>);

impl Delays {
    /// By the first alarm after the event.
    pub(crate) fn from_alarms(ships: &[Ship], found: &[Vec<usize>]) -> Delays {
        let delay = |(ship, alarms): (&Ship, &Vec<usize>)| {
            let (event, changed) = ship.event.zip(ship.changed_row())?;
            let reported = alarms.iter().copied().find(|row| *row >= changed);
            let hours = |rows: usize| rows as f64 / ROWS_AN_HOUR;
            let days = |row: usize| ship.rows[row].time.seconds_since(event) / DAY_S;
            Some(Delay {
                days: reported.map_or(f64::INFINITY, days),
                hours: reported.map_or(f64::INFINITY, |row| hours(row + 1 - changed)),
                bound_hours: ship.bound_rows.map_or(f64::INFINITY, hours),
            })
        };
        Delays(ships.iter().zip(found).filter_map(delay).collect())
    }

    /// Per cent of ships.
    pub(crate) fn found_within(&self, days: f64) -> f64 {
        let within = self.0.iter().filter(|delay| delay.days <= days).count();
        100.0 * within as f64 / self.0.len() as f64
    }

    /// Hours of settled sailing.
    pub(crate) fn median_hours(&self) -> f64 {
        median(self.0.iter().map(|delay| delay.hours))
    }

    /// The median bound, hours of settled sailing.
    pub(crate) fn median_bound_hours(&self) -> f64 {
        median(self.0.iter().map(|delay| delay.bound_hours))
    }

    /// The median of delay over bound, of ships that have one.
    pub(crate) fn median_over_bound(&self) -> f64 {
        let bounded = self.0.iter().filter(|delay| delay.bound_hours.is_finite());
        median(bounded.map(|delay| delay.hours / delay.bound_hours))
    }
}

/// The lower of the two in the middle.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n => values[(n - 1) / 2],
    }
}
