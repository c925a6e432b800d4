//! The clock against receivers and computers that are wrong.

use super::*;
use std::ops::Range;
use std::time::Duration;

const FIRST: TimeSource = TimeSource::Receiver(0, Trust::Trusted);
const SECOND: TimeSource = TimeSource::Receiver(1, Trust::Trusted);

fn at(seconds: i64) -> Timestamp {
    Timestamp::from_micros((1_700_000_000 + seconds) * 1_000_000).unwrap()
}

#[test]
fn one_wrong_stamp_moves_nothing() {
    let mut clock = GnssClock::new(1, 15.0);
    assert_eq!(clock.observe(FIRST, at(0)), Step::Advanced(at(0)));
    assert_eq!(clock.observe(FIRST, at(86_400 * 3000)), Step::Held);
    assert_eq!(clock.observe(FIRST, at(-7200)), Step::Held);
    assert_eq!(clock.observe(FIRST, at(1)), Step::Advanced(at(1)));
}

#[test]
fn a_jump_that_is_borne_out_is_a_jump() {
    for jump in [-7200, -30, 601, 86_400] {
        let mut clock = GnssClock::new(1, 15.0);
        clock.observe(FIRST, at(0));
        assert_eq!(clock.observe(FIRST, at(jump)), Step::Held);
        assert_eq!(
            clock.observe(FIRST, at(jump + 1)),
            Step::Jumped(at(jump + 1))
        );
        assert_eq!(
            clock.observe(FIRST, at(jump + 2)),
            Step::Advanced(at(jump + 2))
        );
    }
}

/// A clock on board; the computer is off by `computer`, and the receiver says 0.
fn on_board_clock(computer: i64) -> (GnssClock, Instant) {
    let mut clock = GnssClock::new(1, 15.0);
    let start = Instant::now();
    clock.set_reference(at(computer), start);
    assert_eq!(clock.observe(FIRST, at(0)), Step::Advanced(at(0)));
    (clock, start)
}

/// Observes a stamp a second, `off_s` from the true time; returns the steps.
fn hear(clock: &mut GnssClock, start: Instant, seconds: Range<i64>, off_s: i64) -> Vec<Step> {
    let steps = seconds.map(|second| {
        clock.set_receive_time(start + Duration::from_secs(second.unsigned_abs()));
        clock.observe(FIRST, at(second + off_s))
    });
    steps.collect()
}

const YEARS_S: i64 = 5 * 365 * 86_400;

#[test]
fn no_time_passes_while_the_receiver_is_a_day_off() {
    // Whether the computer knows the time or not.
    for computer in [0, YEARS_S] {
        for off_s in [86_400, -86_400, 7_200, 1_200] {
            let (mut clock, start) = on_board_clock(computer);
            hear(&mut clock, start, 1..60, 0);
            let steps = hear(&mut clock, start, 60..4_000, off_s);
            assert!(steps.iter().all(|step| *step == Step::Held), "{off_s}");
            // What moves meanwhile is reckoned on by the receiver's own seconds.
            let running_s = clock.running().unwrap().seconds_since(at(0));
            assert!((3_990.0..4_000.0).contains(&running_s), "{running_s}");
            let problem = clock.problem().unwrap();
            assert!(problem.contains("nothing is sampled"), "{problem}");
            assert_eq!(clock.now(), Some(at(59)));
            let back = hear(&mut clock, start, 4_000..4_002, 0);
            assert_eq!(back, [Step::Jumped(at(4_000)), Step::Advanced(at(4_001))]);
            assert_eq!(clock.problem(), None);
        }
    }
}

#[test]
fn a_receiver_that_comes_to_its_senses_is_believed() {
    // It was wrong from the start, as the computer says; then it is right.
    let (mut clock, start) = on_board_clock(86_400);
    hear(&mut clock, start, 1..60, 0);
    let steps = hear(&mut clock, start, 60..62, 86_400);
    assert_eq!(steps[1], Step::Jumped(at(61 + 86_400)));
}

#[test]
fn what_lasts_for_a_day_with_nothing_against_it_is_believed() {
    let (mut clock, start) = on_board_clock(YEARS_S);
    let steps = hear(&mut clock, start, 1..86_500, -40_000);
    let jumps: Vec<&Step> = steps.iter().filter(|step| **step != Step::Held).collect();
    assert!(matches!(jumps[0], Step::Jumped(_)), "{jumps:?}");
    let (mut clock, start) = on_board_clock(0);
    let steps = hear(&mut clock, start, 1..86_500, -40_000);
    assert!(steps.iter().all(|step| *step == Step::Held));
}

#[test]
fn silence_is_no_jump_if_as_much_time_has_passed() {
    for computer in [0, YEARS_S] {
        let (mut clock, start) = on_board_clock(computer);
        let steps = hear(&mut clock, start, 90_000..90_002, 0);
        assert_eq!(steps[1], Step::Jumped(at(90_001)));
    }
}

#[test]
fn a_date_of_1024_weeks_ago_is_put_right() {
    const WEEKS_S: i64 = -1_024 * 7 * 86_400;
    let (mut clock, start) = on_board_clock(0);
    let steps = hear(&mut clock, start, 1..9, WEEKS_S);
    let wanted: Vec<Step> = (1..9).map(|second| Step::Advanced(at(second))).collect();
    assert_eq!(steps, wanted);
    assert!(clock.problem().unwrap().contains("1024 weeks"));
    hear(&mut clock, start, 9..10, 0);
    assert_eq!(clock.problem(), None);
}

#[test]
fn a_receiver_that_rolled_over_before_is_put_right_and_an_old_log_stays_old() {
    let mut clock = GnssClock::new(1, 15.0);
    clock.set_reference(at(90 * 86_400), Instant::now());
    let rolled = clock.observe(FIRST, at(0).plus_seconds(-2.0 * ROLL_OVER_S));
    assert_eq!(rolled, Step::Advanced(at(0)));
    let mut clock = GnssClock::new(1, 15.0);
    clock.set_reference(at(0), Instant::now());
    let old = at(-2 * YEARS_S);
    assert_eq!(clock.observe(FIRST, old), Step::Advanced(old));
}

/// A clock on board after a restart, with a computer that knows the time.
fn restarted() -> (GnssClock, Instant) {
    let mut clock = GnssClock::new(1, 15.0);
    let start = Instant::now();
    clock.set_reference(at(0), start);
    clock.restore_checkpoint(ClockCheckpoint {
        ship: at(-9_000),
        computer: at(-9_000),
    });
    (clock, start)
}

#[test]
fn a_first_stamp_that_cannot_be_right_is_not_believed() {
    const WEEK_S: i64 = 7 * 86_400;
    for off_s in [WEEK_S, -WEEK_S, 4 * YEARS_S, -4 * YEARS_S] {
        let (mut clock, start) = restarted();
        let steps = hear(&mut clock, start, 0..90_000, off_s);
        assert!(steps.iter().all(|step| *step == Step::Held), "{off_s}");
        let problem = clock.problem().unwrap();
        assert!(problem.contains("nothing is sampled"), "{problem}");
        let back = hear(&mut clock, start, 90_000..90_002, 0);
        assert_eq!(back, [Step::Jumped(at(90_000)), Step::Advanced(at(90_001))]);
        assert_eq!(clock.problem(), None);
    }
    let (mut clock, start) = restarted();
    let steps = hear(&mut clock, start, 0..1, 60_000);
    assert_eq!(steps, [Step::Advanced(at(60_000))]);
}

#[test]
fn an_uncertain_first_stamp_is_accepted_when_the_server_confirms_it() {
    const WEEK_S: i64 = 7 * 86_400;
    let (mut clock, start) = restarted();
    hear(&mut clock, start, 0..60, WEEK_S);
    clock.correct_reference(at(60 + WEEK_S), start + Duration::from_mins(1));
    let steps = hear(&mut clock, start, 60..61, WEEK_S);
    assert_eq!(steps, [Step::Jumped(at(60 + WEEK_S))]);
}

#[test]
fn a_receiver_that_was_1024_weeks_ahead_is_believed_when_it_is_right_again() {
    const WEEKS_S: i64 = 1_024 * 7 * 86_400;
    let mut clock = GnssClock::new(1, 15.0);
    let start = Instant::now();
    clock.set_reference(at(0), start);
    hear(&mut clock, start, 0..60, WEEKS_S);
    let steps = hear(&mut clock, start, 60..62, 0);
    assert_eq!(steps[1], Step::Jumped(at(61)));
    assert_eq!(clock.problem(), None);
}

#[test]
fn a_roll_over_is_put_right_by_a_computer_that_lost_its_time_as_well() {
    let mut clock = GnssClock::new(1, 15.0);
    clock.set_reference(Timestamp::from_micros(0).unwrap(), Instant::now());
    clock.restore_checkpoint(ClockCheckpoint {
        ship: at(-86_400),
        computer: at(-86_400),
    });
    let step = clock.observe(FIRST, at(0).plus_seconds(-ROLL_OVER_S));
    assert_eq!(step, Step::Advanced(at(0)));
}

#[test]
fn a_second_receiver_a_little_behind_is_no_jump() {
    let mut clock = GnssClock::new(1, 15.0);
    clock.observe(FIRST, at(10));
    for _ in 0..5 {
        assert_eq!(clock.observe(FIRST, at(9)), Step::Held);
    }
    assert_eq!(clock.now(), Some(at(10)));
}

#[test]
fn a_worse_source_takes_over_after_silence_and_hands_back_at_once() {
    let mut clock = GnssClock::new(2, 15.0);
    clock.observe(FIRST, at(0));
    assert_eq!(clock.observe(SECOND, at(5000)), Step::Held);
    clock.observe(FIRST, at(1));
    for second in 2..17 {
        assert_eq!(clock.observe(SECOND, at(second)), Step::Held);
    }
    assert_eq!(clock.observe(SECOND, at(17)), Step::Advanced(at(17)));
    assert_eq!(clock.observe(FIRST, at(18)), Step::Advanced(at(18)));
    assert_eq!(clock.observe(SECOND, at(19)), Step::Held);
}

#[test]
fn a_date_before_gps_is_not_believed() {
    let mut clock = GnssClock::new(1, 15.0);
    let year_1850 = Timestamp::parse("1850-06-01T00:00:00Z").unwrap();
    for _ in 0..3 {
        assert_eq!(clock.observe(FIRST, year_1850), Step::Held);
    }
    assert_eq!(clock.now(), None);
}

#[test]
fn a_jump_of_seconds_is_noticed_once_the_time_has_run_in_step() {
    for off_s in [5, 30, 599, -5, -30, -599] {
        let (mut clock, start) = on_board_clock(0);
        hear(&mut clock, start, 1..600, 0);
        let steps = hear(&mut clock, start, 600..4_000, off_s);
        assert!(steps.iter().all(|step| *step == Step::Held), "{off_s}");
        let problem = clock.problem().unwrap();
        assert!(problem.contains("jumped by ") && problem.contains(" s: nothing is sampled"));
        let back = hear(&mut clock, start, 4_000..4_002, 0);
        assert_eq!(back, [Step::Jumped(at(4_000)), Step::Advanced(at(4_001))]);
        assert_eq!(clock.problem(), None);
    }
}

#[test]
fn a_jump_of_seconds_is_accepted_when_it_has_lasted_as_long_or_the_computer_says_so() {
    // The computer is minutes off: it cannot say.
    let (mut clock, start) = on_board_clock(300);
    hear(&mut clock, start, 1..1_200, 0);
    let steps = hear(&mut clock, start, 1_200..2_700, 18);
    let jump = steps
        .iter()
        .position(|step| matches!(step, Step::Jumped(_)));
    assert!(
        jump.is_some_and(|jump| (1_195..1_205).contains(&jump)),
        "{jump:?}"
    );
    assert_eq!(steps[1_499], Step::Advanced(at(2_699 + 18)));
    // The receiver has learnt its leap seconds.
    let (mut clock, start) = on_board_clock(18);
    hear(&mut clock, start, 1..1_200, 0);
    let steps = hear(&mut clock, start, 1_200..1_202, 18);
    assert_eq!(steps[1], Step::Jumped(at(1_201 + 18)));
}

#[test]
fn a_delay_on_the_way_and_its_end_are_no_jump() {
    let (mut clock, start) = on_board_clock(0);
    hear(&mut clock, start, 1..600, 0);
    // For half a minute nothing comes, then all of it at once, and again with some delay.
    for second in 600..630 {
        clock.set_receive_time(start + Duration::from_secs(630));
        assert_eq!(clock.observe(FIRST, at(second)), Step::Advanced(at(second)));
    }
    for delay_s in [20, 0, 9] {
        for second in 0..60 {
            let now = clock.now().unwrap().plus_seconds(1.0);
            let heard_s = now.seconds_since(at(0)) + f64::from(delay_s);
            clock.set_receive_time(start + Duration::from_secs_f64(heard_s));
            assert_eq!(
                clock.observe(FIRST, now),
                Step::Advanced(now),
                "{delay_s} {second}"
            );
        }
    }
    assert_eq!(clock.problem(), None);
}

#[test]
fn silence_and_the_drift_of_a_quartz_are_no_jump() {
    let (mut clock, start) = on_board_clock(0);
    for minute in 1..3_000 {
        let heard = start + Duration::from_secs_f64(60.0 * f64::from(minute) * (1.0 + 1e-4));
        clock.set_receive_time(heard);
        let stamp = at(60 * i64::from(minute));
        assert_eq!(clock.observe(FIRST, stamp), Step::Advanced(stamp));
    }
    let late = start + Duration::from_hours(50 + 24);
    clock.set_receive_time(late);
    clock.observe(FIRST, at(180_000 + 86_400));
    let steps = clock.observe(FIRST, at(180_000 + 86_401));
    assert_eq!(steps, Step::Jumped(at(180_000 + 86_401)));
}

#[test]
fn accelerated_instruments_are_not_judged_by_the_seconds() {
    let (mut clock, start) = on_board_clock(0);
    for second in 1..4_000_i64 {
        // A thousand seconds in one, with a gap of minutes now and then.
        clock.set_receive_time(start + Duration::from_millis(second.unsigned_abs()));
        let stamp = at(second + 300 * (second / 500));
        assert_eq!(clock.observe(FIRST, stamp), Step::Advanced(stamp));
    }
}

#[test]
fn a_receiver_that_is_not_trusted_does_not_set_the_time_that_a_trusted_one_has() {
    let spoofed = TimeSource::Receiver(0, Trust::NotTrusted);
    let mut clock = GnssClock::new(2, 15.0);
    clock.observe(FIRST, at(0));
    for second in 1..60 {
        clock.observe(spoofed, at(second + 2_400));
        clock.observe(SECOND, at(second));
    }
    assert_eq!(clock.now(), Some(at(59)));
    assert_eq!(clock.observe(FIRST, at(60)), Step::Advanced(at(60)));
}

#[test]
fn the_false_time_of_a_receiver_that_is_not_trusted_is_never_accepted_for_having_lasted() {
    let (mut clock, start) = on_board_clock(YEARS_S);
    hear(&mut clock, start, 1..1_000, 0);
    let mut say = |second: i64, off_s: i64, trust| {
        clock.set_receive_time(start + Duration::from_secs(second.unsigned_abs()));
        clock.observe(TimeSource::Receiver(0, trust), at(second + off_s))
    };
    let steps = (1_000..90_000).map(|second| say(second, 300, Trust::NotTrusted));
    assert!(steps.into_iter().all(|step| step == Step::Held));
    assert_eq!(say(90_000, 0, Trust::Trusted), Step::Jumped(at(90_000)));
}
