use super::*;
use binnacle_compass::sample::SourceId;
use std::time::Duration;

/// Ship on a steady heading with gyro, log and receiver, a second at a time.
struct Ship {
    guard: GnssGuard,
    start: Instant,
    seconds: u64,
    true_place: Position,
    heading_deg: f64,
    speed_kn: f64,
}

impl Ship {
    fn new() -> Ship {
        Ship {
            guard: GnssGuard::default(),
            start: Instant::now(),
            seconds: 0,
            true_place: at(43.0, -3.0),
            heading_deg: 300.0,
            speed_kn: 15.0,
        }
    }

    /// Sails for some seconds; the receiver gives what `receiver` makes of the true place.
    fn sail(&mut self, seconds: u64, mut receiver: impl FnMut(u64, Position) -> Option<Position>) {
        for second in 0..seconds {
            self.seconds += 1;
            let now = self.start + Duration::from_secs(self.seconds);
            let time = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
            let time = time.plus_seconds(self.seconds as f64);
            let (sin, cos) = self.heading_deg.to_radians().sin_cos();
            let run_nm = self.speed_kn / 3600.0;
            self.true_place = offset(self.true_place, run_nm * cos, run_nm * sin);
            self.guard.advance(Some(time), now);
            self.guard.apply(Signal::Gyro(ReferenceHeading {
                heading: TrueHeading::new(self.heading_deg).unwrap(),
                source: SourceId::new(1),
            }));
            if let Some(fix) = receiver(second, self.true_place) {
                self.guard.apply(Signal::Speed(self.speed_kn));
                self.guard.apply(Signal::Position(fix));
            }
        }
    }

    fn is_disturbed(&self) -> bool {
        self.guard.interference().is_some()
    }

    /// Returns the reckoned place's error, and the error stated, nautical miles.
    fn error_nm(&self) -> (f64, f64) {
        let place = self.guard.place().unwrap();
        let error_nm = reckoning::distance_nm(place.position, self.true_place);
        (error_nm, place.radius_nm)
    }
}

fn at(lat_deg: f64, lon_deg: f64) -> Position {
    Position::new(lat_deg, lon_deg).unwrap()
}

#[allow(clippy::unnecessary_wraps, reason = "a receiver may also be silent")]
fn honest(_: u64, place: Position) -> Option<Position> {
    Some(place)
}

#[test]
fn a_receiver_that_tells_the_truth_is_trusted_through_turns_and_silence() {
    let mut ship = Ship::new();
    for heading_deg in [300.0, 30.0, 180.0, 359.0] {
        ship.heading_deg = heading_deg;
        ship.sail(900, honest);
        ship.sail(1200, |_, _| None);
        ship.sail(60, honest);
        assert!(!ship.is_disturbed(), "{heading_deg}");
    }
}

#[test]
fn a_place_far_off_is_not_used_and_the_ship_is_reckoned_on() {
    let mut ship = Ship::new();
    ship.sail(3600, honest);
    ship.sail(3600, |_, _| Some(at(40.47, -3.56)));
    assert!(ship.is_disturbed());
    let (error_nm, radius_nm) = ship.error_nm();
    assert!(error_nm < 1.0 && radius_nm < 25.0, "{error_nm} {radius_nm}");
    ship.sail(599, honest);
    assert!(ship.is_disturbed());
    ship.sail(10, honest);
    assert!(!ship.is_disturbed());
    assert!(ship.error_nm().0 < 0.01);
}

#[test]
fn circles_that_begin_where_she_is_are_noticed() {
    let mut ship = Ship::new();
    ship.sail(3600, honest);
    let mut centre = None;
    ship.sail(1800, |second, place| {
        let centre = *centre.get_or_insert(offset(place, -1.0, 0.0));
        let angle = second as f64 * ship_radians_a_second();
        Some(offset(centre, angle.cos(), angle.sin()))
    });
    assert!(ship.is_disturbed());
    let (error_nm, radius_nm) = ship.error_nm();
    assert!(error_nm < radius_nm, "{error_nm} {radius_nm}");
    ship.sail(1200, honest);
    assert!(!ship.is_disturbed());
}

/// Angle in which a ship of 15 knots goes round a circle of one mile in a second.
fn ship_radians_a_second() -> f64 {
    15.0 / 3600.0
}

#[test]
fn a_position_that_stands_still_is_noticed_by_the_log() {
    let mut ship = Ship::new();
    ship.sail(3600, honest);
    let held = ship.true_place;
    for _ in 0..600 {
        ship.sail(1, |_, _| None);
        ship.guard.apply(Signal::WaterSpeed(15.0));
        ship.guard.apply(Signal::Speed(0.0));
        ship.guard.apply(Signal::Position(held));
    }
    assert!(ship.is_disturbed());
}

#[test]
fn a_log_that_reads_nothing_and_a_gyro_that_is_off_raise_nothing() {
    let mut ship = Ship::new();
    ship.sail(60, honest);
    for _ in 0..1800 {
        let corrected = TrueHeading::new(300.0);
        ship.guard.note_corrected(corrected);
        ship.guard.apply(Signal::WaterSpeed(0.0));
        ship.sail(1, honest);
        ship.guard.apply(Signal::Gyro(ReferenceHeading {
            heading: TrueHeading::new(180.0).unwrap(),
            source: SourceId::new(1),
        }));
    }
    assert!(!ship.is_disturbed());
}

#[test]
fn a_first_fix_that_was_false_gives_way_within_minutes() {
    let mut ship = Ship::new();
    ship.sail(120, |_, _| Some(at(40.47, -3.56)));
    ship.sail(500, honest);
    assert!(ship.is_disturbed());
    ship.sail(200, honest);
    assert!(!ship.is_disturbed());
}

#[test]
fn a_track_elsewhere_is_not_believed_for_moving_as_she_does() {
    let mut ship = Ship::new();
    ship.sail(6 * 3600, honest);
    ship.sail(3 * 3600, |_, place| Some(offset(place, -200.0, 0.0)));
    assert!(ship.is_disturbed());
}

#[test]
fn nothing_of_the_receivers_is_used_meanwhile() {
    let mut ship = Ship::new();
    ship.sail(600, honest);
    ship.sail(1, |_, _| Some(at(40.47, -3.56)));
    let place = Signal::Position(at(40.47, -3.56));
    assert!(matches!(
        ship.guard.apply(place),
        [Some(Signal::Reckoned(_)), Some(Signal::Speed(15.0))]
    ));
    assert_eq!(ship.guard.apply(Signal::Speed(3.0)), [None; 2]);
    let heading = Signal::Satellite(ReferenceHeading {
        heading: TrueHeading::new(10.0).unwrap(),
        source: SourceId::new(1),
    });
    let refused = Signal::Refused(Instrument::Satellite, Refusal::Interference);
    assert_eq!(ship.guard.apply(heading), [Some(refused), None]);
}
