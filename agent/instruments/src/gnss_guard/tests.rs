use super::*;
use binnacle_compass::sample::SourceId;
use binnacle_observation::Source;
use std::time::Duration;

/// Ship on a steady heading with gyro, log and receiver, a second at a time.
struct Ship {
    guard: GnssGuard,
    start: Instant,
    seconds: u64,
    true_place: Position,
    heading_deg: f64,
    speed_kn: f64,
    used_place: Option<Position>,
}

impl Ship {
    fn new() -> Ship {
        Ship {
            guard: GnssGuard::new(15.0),
            start: Instant::now(),
            seconds: 0,
            true_place: at(43.0, -3.0),
            heading_deg: 300.0,
            speed_kn: 15.0,
            used_place: None,
        }
    }

    /// Sails for some seconds; the receiver gives what `receiver` makes of the true place.
    fn sail(&mut self, seconds: u64, mut receiver: impl FnMut(u64, Position) -> Option<Position>) {
        self.sail_with(seconds, |second, place| [receiver(second, place), None]);
    }

    /// Sails for some seconds with two receivers.
    fn sail_with(
        &mut self,
        seconds: u64,
        mut receivers: impl FnMut(u64, Position) -> [Option<Position>; 2],
    ) {
        for second in 0..seconds {
            self.seconds += 1;
            let now = self.start + Duration::from_secs(self.seconds);
            let time = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
            let time = time.plus_seconds(self.seconds as f64);
            let (sin, cos) = self.heading_deg.to_radians().sin_cos();
            let run_nm = self.speed_kn / 3600.0;
            self.true_place = offset(self.true_place, run_nm * cos, run_nm * sin);
            self.guard.advance(Some(time), now);
            let gyro = Signal::Gyro(ReferenceHeading {
                heading: TrueHeading::new(self.heading_deg).unwrap(),
                source: SourceId::new(1),
            });
            self.guard.apply(gyro, None);
            let fixes = receivers(second, self.true_place);
            for (rank, fix) in fixes.into_iter().enumerate() {
                let Some(fix) = fix else { continue };
                let used = self.receive(rank, Signal::Position(fix));
                if let Some(Signal::Position(place) | Signal::Reckoned(place)) = used[0] {
                    self.used_place = Some(place);
                }
                self.receive(rank, Signal::Speed(self.speed_kn));
            }
        }
    }

    /// Applies a signal of a receiver.
    fn receive(&mut self, rank: usize, signal: Signal) -> [Option<Signal>; 2] {
        let source = sentence([*b"GP", *b"GN"][rank], *b"RMC");
        let of = GnssSource {
            source: &source,
            rank,
            names_talker: true,
        };
        self.guard.apply(signal, Some(of))
    }

    /// Returns the distance of the place that was used last, nautical miles.
    fn used_error_nm(&self) -> f64 {
        reckoning::distance_nm(self.used_place.unwrap(), self.true_place)
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
        ship.guard.apply(Signal::WaterSpeed(15.0), None);
        ship.receive(0, Signal::Speed(0.0));
        ship.receive(0, Signal::Position(held));
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
        ship.guard.apply(Signal::WaterSpeed(0.0), None);
        ship.sail(1, honest);
        let gyro = Signal::Gyro(ReferenceHeading {
            heading: TrueHeading::new(180.0).unwrap(),
            source: SourceId::new(1),
        });
        ship.guard.apply(gyro, None);
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
        ship.receive(0, place),
        [Some(Signal::Reckoned(_)), Some(Signal::Speed(15.0))]
    ));
    assert_eq!(ship.receive(0, Signal::Speed(3.0)), [None; 2]);
    let heading = Signal::Satellite(ReferenceHeading {
        heading: TrueHeading::new(10.0).unwrap(),
        source: SourceId::new(1),
    });
    let refused = Signal::Refused(Instrument::Satellite, Refusal::Interference);
    assert_eq!(ship.guard.apply(heading, None), [Some(refused), None]);
}

/// A place far from the ship.
fn madrid() -> Position {
    at(40.47, -3.56)
}

#[test]
fn the_second_receiver_is_used_while_the_first_is_not_trusted() {
    let mut ship = Ship::new();
    ship.sail_with(3600, |_, place| [Some(place), Some(place)]);
    ship.sail_with(3600, |_, place| [Some(madrid()), Some(place)]);
    assert!(!ship.is_disturbed());
    assert!(ship.used_error_nm() < 0.01, "{}", ship.used_error_nm());
    let problems: Vec<String> = ship.guard.problems().collect();
    assert_eq!(problems.len(), 1);
    assert!(
        problems[0].contains("bridge GPRMC is not trusted")
            && problems[0].contains("bridge GNRMC is used"),
        "{problems:?}"
    );
    // Its speed is not used either.
    assert_eq!(ship.receive(0, Signal::Speed(3.0)), [None; 2]);
    assert_ne!(ship.receive(1, Signal::Speed(3.0)), [None; 2]);
    // It is right again.
    ship.sail_with(610, |_, place| [Some(place), Some(place)]);
    assert_eq!(ship.guard.problems().count(), 0);
    assert_ne!(ship.receive(0, Signal::Speed(3.0)), [None; 2]);
}

#[test]
fn a_first_receiver_that_is_drawn_away_slowly_does_not_take_the_second_with_it() {
    let mut ship = Ship::new();
    ship.sail_with(3600, |_, place| [Some(place), Some(place)]);
    // It drifts off at 12 knots.
    ship.sail_with(1200, |second, place| {
        let drawn = offset(place, -12.0 * second as f64 / 3600.0, 0.0);
        [Some(drawn), Some(place)]
    });
    assert!(!ship.is_disturbed());
    assert!(ship.used_error_nm() < 0.01, "{}", ship.used_error_nm());
}

#[test]
fn two_receivers_that_are_both_false_are_interference_and_the_first_to_recover_ends_it() {
    let mut ship = Ship::new();
    ship.sail_with(3600, |_, place| [Some(place), Some(place)]);
    ship.sail_with(1800, |_, _| [Some(madrid()), Some(at(41.0, -4.0))]);
    assert!(ship.is_disturbed());
    assert!(ship.error_nm().0 < 1.0);
    ship.sail_with(620, |_, place| [Some(madrid()), Some(place)]);
    assert!(!ship.is_disturbed());
    assert!(ship.used_error_nm() < 0.01);
}

#[test]
fn a_false_track_is_never_accepted_while_another_receiver_says_otherwise() {
    let mut ship = Ship::new();
    ship.sail_with(1800, |_, place| [Some(place), Some(place)]);
    ship.sail_with(30 * 3600, |_, place| {
        [Some(offset(place, -20.0, 0.0)), Some(place)]
    });
    assert!(ship.used_error_nm() < 0.01, "{}", ship.used_error_nm());
}

#[test]
fn the_first_receiver_is_used_again_at_once_after_silence() {
    let mut ship = Ship::new();
    ship.sail_with(600, |_, place| [Some(place), None]);
    let mark = |place| offset(place, 0.05, 0.0);
    ship.sail_with(60, |_, place| [None, Some(mark(place))]);
    assert!((ship.used_error_nm() - 0.05).abs() < 0.01);
    ship.sail_with(1, |_, place| [Some(place), Some(mark(place))]);
    assert!(ship.used_error_nm() < 0.01);
    assert!(!ship.is_disturbed());
}

#[test]
fn a_receiver_that_is_false_when_it_is_first_heard_changes_nothing() {
    let mut ship = Ship::new();
    ship.sail_with(600, |_, place| [Some(place), None]);
    ship.sail_with(600, |_, place| [Some(place), Some(madrid())]);
    assert!(!ship.is_disturbed());
    assert!(ship.used_error_nm() < 0.01);
    let heading = Signal::Satellite(ReferenceHeading {
        heading: TrueHeading::new(10.0).unwrap(),
        source: SourceId::new(1),
    });
    assert_eq!(ship.guard.apply(heading, None), [Some(heading), None]);
}

impl Ship {
    /// Restarts after some seconds in which she sails on. The computer knows of `known_s` of them.
    fn restart(&mut self, seconds: u64, known_s: f64) {
        let noon = Timestamp::parse("2026-11-21T12:00:00Z").unwrap();
        let saved = self.guard.checkpoint(noon).unwrap();
        self.guard = GnssGuard::new(15.0);
        self.guard.restore(saved, noon.plus_seconds(known_s));
        self.seconds += seconds;
        let run_nm = self.speed_kn / 3600.0 * seconds as f64;
        let (sin, cos) = self.heading_deg.to_radians().sin_cos();
        self.true_place = offset(self.true_place, run_nm * cos, run_nm * sin);
    }
}

#[test]
fn a_false_fix_is_false_after_a_restart_too() {
    let elsewhere = |second: u64, place| {
        let angle = second as f64 / 60.0;
        offset(place, -200.0 + angle.cos(), angle.sin())
    };
    for is_spoofed_before in [true, false] {
        let mut ship = Ship::new();
        ship.sail(900, |_, place| Some(place));
        if is_spoofed_before {
            ship.sail(60, |second, place| Some(elsewhere(second, place)));
            assert!(ship.is_disturbed());
        }
        ship.restart(120, 120.0);
        ship.sail(1_800, |second, place| Some(elsewhere(second, place)));
        assert!(ship.is_disturbed());
        let (error_nm, place) = (ship.used_error_nm(), ship.guard.place().unwrap());
        assert!(error_nm < place.radius_nm, "{error_nm} {place:?}");
        ship.sail(700, |_, place| Some(place));
        assert!(!ship.is_disturbed());
    }
}

#[test]
fn where_she_sailed_meanwhile_the_fix_is_trusted_whatever_the_computer_knows() {
    for known_s in [0.0, 86_400.0, -86_400.0] {
        let mut ship = Ship::new();
        ship.sail(900, |_, place| Some(place));
        ship.restart(86_400, known_s);
        ship.sail(2, |_, place| Some(place));
        assert!(
            !ship.is_disturbed() && ship.used_error_nm() < 0.1,
            "{known_s}"
        );
    }
}

fn sentence(talker: [u8; 2], sentence: [u8; 3]) -> Source {
    Source::of_sentence("bridge".into(), talker, sentence)
}

/// Returns the receiver of a source that a selection without a talker matches.
fn of_any_talker(source: &Source) -> GnssSource<'_> {
    GnssSource {
        source,
        rank: 0,
        names_talker: false,
    }
}

#[test]
fn a_receiver_that_names_the_systems_it_uses_at_the_moment_is_one() {
    let mut guard = GnssGuard::new(15.0);
    let place = at(43.0, -3.0);
    for talker in [*b"GN", *b"GP", *b"GN"] {
        let source = sentence(talker, *b"RMC");
        let used = guard.apply(Signal::Position(place), Some(of_any_talker(&source)));
        assert_eq!(used[0], Some(Signal::Position(place)));
    }
    let source = sentence(*b"GN", *b"RMC");
    guard.apply(
        Signal::Position(at(40.0, -3.0)),
        Some(of_any_talker(&source)),
    );
    for (talker, trust) in [(*b"GP", Trust::NotTrusted), (*b"SN", Trust::NotTrusted)] {
        let clock = sentence(talker, *b"ZDA");
        assert_eq!(guard.trust(of_any_talker(&clock)), trust);
    }
}
