//! Dead reckoning: a place from an earlier fix, and the heading and speed since.

use binnacle_compass::angle::wrap_180;
use binnacle_compass::position::Position;

/// Minutes of latitude in a degree, nautical miles.
const NM_A_DEGREE: f64 = 60.0;
/// Stream that may set a ship, knots (Bowditch, The American Practical Navigator, "Tides and tidal
/// currents": few streams run faster), leeway included.
const STREAM_KN: f64 = 5.0;
/// Error of a speed that is read now, as a share of it.
const SPEED_ERROR: f64 = 0.1;
/// Share of her last speed by which a ship may have become faster since.
const FASTER: f64 = 0.3;
/// Error of a fix with the antenna's distance from the ship's turning point, nautical miles.
const FIX_ERROR_NM: f64 = 0.2;

/// Place by dead reckoning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReckonedPlace {
    /// Position by dead reckoning.
    pub position: Position,
    /// Greatest distance of the ship from it, nautical miles.
    pub radius_nm: f64,
}

impl ReckonedPlace {
    /// Returns a position as a place without error.
    pub fn exactly(position: Position) -> ReckonedPlace {
        ReckonedPlace {
            position,
            radius_nm: 0.0,
        }
    }
}

/// Motion of the ship at a moment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Motion {
    /// True headings that no receiver of satellites gave, the better one first: either may be
    /// wrong.
    pub(super) headings_deg: [Option<f64>; 2],
    pub(super) speed: Speed,
}

/// Speed of the ship, knots.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum Speed {
    /// Nothing is known.
    #[default]
    Unknown,
    /// Read now.
    Read(f64),
    /// As it was last.
    Last(f64),
}

/// Speed of a ship of which nothing is known, knots.
const UNKNOWN_SPEED_KN: f64 = 20.0;

/// Speeds along the heading, and in any direction, knots.
struct Speeds {
    least: f64,
    likeliest: f64,
    most: f64,
    stray: f64,
}

impl Motion {
    fn speeds(self) -> Speeds {
        let (least_kn, likeliest_kn, most_kn) = match self.speed {
            Speed::Read(kn) => (kn * (1.0 - SPEED_ERROR), kn, kn * (1.0 + SPEED_ERROR)),
            // She may have stopped.
            Speed::Last(kn) => (0.0, kn, kn * (1.0 + FASTER)),
            Speed::Unknown => (0.0, 0.0, UNKNOWN_SPEED_KN),
        };
        match self.headings_deg {
            [None, None] => Speeds {
                least: 0.0,
                likeliest: 0.0,
                most: 0.0,
                stray: STREAM_KN + most_kn,
            },
            _ => Speeds {
                least: least_kn,
                likeliest: likeliest_kn,
                most: most_kn,
                stray: STREAM_KN,
            },
        }
    }
}

/// Miles run to the north and to the east, at the least, likeliest and greatest speed.
#[derive(Clone, Copy, Debug, Default)]
struct Run {
    least: [f64; 2],
    likeliest: [f64; 2],
    most: [f64; 2],
}

/// Reckoning from a fix.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reckoning {
    fix: Position,
    /// Run by each heading.
    runs: [Run; 2],
    /// Distance in any direction from what it ran.
    stray_nm: f64,
    /// Time since the fix, seconds.
    pub(super) seconds: f64,
}

impl Reckoning {
    /// Begins at a fix.
    pub(super) fn from_fix(fix: Position) -> Reckoning {
        Reckoning::from_place(fix, FIX_ERROR_NM)
    }

    /// Begins at a place that is known to some miles.
    pub(super) fn from_place(place: Position, radius_nm: f64) -> Reckoning {
        Reckoning {
            fix: place,
            runs: [Run::default(); 2],
            stray_nm: radius_nm,
            seconds: 0.0,
        }
    }

    /// Goes on for some seconds.
    pub(super) fn advance(&mut self, seconds: f64, motion: Motion) {
        let hours = seconds / 3600.0;
        let speeds = motion.speeds();
        let [better, other] = motion.headings_deg;
        for (run, heading) in self
            .runs
            .iter_mut()
            .zip([better.or(other), other.or(better)])
        {
            let (sin, cos) = heading.unwrap_or_default().to_radians().sin_cos();
            for (part, speed_kn) in [
                (&mut run.least, speeds.least),
                (&mut run.likeliest, speeds.likeliest),
                (&mut run.most, speeds.most),
            ] {
                part[0] += speed_kn * hours * cos;
                part[1] += speed_kn * hours * sin;
            }
        }
        self.stray_nm += speeds.stray * hours;
        self.seconds += seconds;
    }

    /// Returns the place now.
    pub(super) fn place(&self) -> ReckonedPlace {
        let run = self.runs[0];
        let apart_nm = |end: [f64; 2]| (end[0] - run.likeliest[0]).hypot(end[1] - run.likeliest[1]);
        let [north_nm, east_nm] = run.likeliest;
        ReckonedPlace {
            position: offset(self.fix, north_nm, east_nm),
            radius_nm: self.stray_nm + apart_nm(run.least).max(apart_nm(run.most)),
        }
    }

    /// Returns whether the ship can be at a fix now, by either heading.
    pub(super) fn allows(&self, fix: Position) -> bool {
        let [north_nm, east_nm] = displacement(self.fix, fix);
        let runs = self.runs.iter();
        let distances = runs.map(|run| run.distance_nm([north_nm, east_nm]));
        distances.fold(f64::INFINITY, f64::min) <= self.stray_nm
    }
}

impl Run {
    /// Returns the distance of a place from what a ship of any of its speeds ran: the line from
    /// the least to the greatest run.
    fn distance_nm(&self, to: [f64; 2]) -> f64 {
        let along = [self.most[0] - self.least[0], self.most[1] - self.least[1]];
        let from = [to[0] - self.least[0], to[1] - self.least[1]];
        let length_2 = along[0].powi(2) + along[1].powi(2);
        let share = if length_2 > 0.0 {
            ((from[0] * along[0] + from[1] * along[1]) / length_2).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (from[0] - share * along[0]).hypot(from[1] - share * along[1])
    }
}

/// Returns the position some miles north and east of another. Nothing lies beyond a pole.
pub fn offset(from: Position, north_nm: f64, east_nm: f64) -> Position {
    let lat_deg = (from.lat_deg() + north_nm / NM_A_DEGREE).clamp(-90.0, 90.0);
    let middle_deg = f64::midpoint(from.lat_deg(), lat_deg);
    let cos = middle_deg.to_radians().cos().max(0.01);
    let lon_deg = from.lon_deg() + east_nm / NM_A_DEGREE / cos;
    let lon_deg = (lon_deg + 180.0).rem_euclid(360.0) - 180.0;
    Position::new(lat_deg, lon_deg).unwrap_or(from)
}

/// Returns the miles north and east from one position to another, on the plane at their middle
/// latitude. Beyond some hundred miles they are rough, which no reckoning of a ship is.
fn displacement(from: Position, to: Position) -> [f64; 2] {
    let middle_deg = f64::midpoint(from.lat_deg(), to.lat_deg());
    let cos = middle_deg.to_radians().cos().max(0.01);
    let east_deg = wrap_180(to.lon_deg() - from.lon_deg());
    [
        (to.lat_deg() - from.lat_deg()) * NM_A_DEGREE,
        east_deg * NM_A_DEGREE * cos,
    ]
}

/// Returns the distance of two positions, nautical miles.
#[cfg(test)]
pub(super) fn distance_nm(a: Position, b: Position) -> f64 {
    let [north_nm, east_nm] = displacement(a, b);
    north_nm.hypot(east_nm)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(lat_deg: f64, lon_deg: f64) -> Position {
        Position::new(lat_deg, lon_deg).unwrap()
    }

    #[test]
    fn a_mile_is_a_minute_of_latitude() {
        assert!((distance_nm(at(43.0, -3.0), at(44.0, -3.0)) - 60.0).abs() < 1e-9);
        assert!((distance_nm(at(60.0, 179.5), at(60.0, -179.5)) - 30.0).abs() < 0.01);
    }

    #[test]
    fn an_offset_is_as_far_as_it_says() {
        for from in [at(0.0, 0.0), at(-60.0, 179.9), at(78.0, -30.0)] {
            let to = offset(from, 3.0, -4.0);
            assert!((distance_nm(from, to) - 5.0).abs() < 0.02, "{from:?}");
        }
    }

    #[test]
    fn an_hour_on_a_heading_is_its_speed_and_the_error_grows() {
        let mut reckoning = Reckoning::from_fix(at(43.0, -3.0));
        let motion = Motion {
            headings_deg: [Some(90.0), None],
            speed: Speed::Read(12.0),
        };
        for _ in 0..60 {
            reckoning.advance(60.0, motion);
        }
        let place = reckoning.place();
        assert!((distance_nm(at(43.0, -3.0), place.position) - 12.0).abs() < 0.02);
        assert!(place.position.lon_deg() > -3.0);
        assert!((place.radius_nm - (0.2 + 5.0 + 1.2)).abs() < 1e-6);
        assert!(reckoning.allows(place.position));
        assert!(!reckoning.allows(at(43.0, -3.0)));
    }

    #[test]
    fn a_fix_is_possible_by_either_heading() {
        let mut reckoning = Reckoning::from_fix(at(0.0, 0.0));
        let motion = Motion {
            headings_deg: [Some(0.0), Some(90.0)],
            speed: Speed::Read(12.0),
        };
        reckoning.advance(3600.0, motion);
        assert!(reckoning.allows(at(0.2, 0.0)) && reckoning.allows(at(0.0, 0.2)));
        assert!(!reckoning.allows(at(-0.2, 0.0)));
    }

    #[test]
    fn a_ship_of_unknown_motion_may_be_anywhere_near() {
        let growth = |heading, speed| {
            let mut reckoning = Reckoning::from_fix(at(43.0, -3.0));
            let motion = Motion {
                headings_deg: [heading, None],
                speed,
            };
            reckoning.advance(3600.0, motion);
            reckoning.place().radius_nm - FIX_ERROR_NM
        };
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a}");
        close(growth(Some(0.0), Speed::Last(10.0)), 15.0);
        close(growth(None, Speed::Read(10.0)), 16.0);
        close(growth(None, Speed::Unknown), 25.0);
    }
}
