//! The well-known outcomes of a ten-second window, counted in a batch's tally.
//!
//! Each has a number in the frame, which never changes its meaning. An agent
//! may count under other names too: they are sent as text.

/// The window went into a sample.
pub const ACCEPTED: &str = "accepted";
/// Too slow over ground.
pub const SLOW: &str = "slow";
/// The rate of turn was above the limit.
pub const TURNING: &str = "turning";
/// Too soon after a turn: the Gaussian error has not decayed.
pub const SETTLING: &str = "settling";
/// The heading swung too far.
pub const SWINGING: &str = "swinging";
/// No compass heading.
pub const NO_COMPASS: &str = "no_compass";
/// Neither gyro nor satellite compass.
pub const NO_REFERENCE: &str = "no_reference";
/// No position.
pub const NO_POSITION: &str = "no_position";
/// No speed over ground.
pub const NO_SPEED: &str = "no_speed";
/// The crew set the hold "lying alongside".
pub const HOLD_BERTHED: &str = "hold_berthed";
/// The crew set the hold "magnetic cargo on board".
pub const HOLD_MAGNETIC_CARGO: &str = "hold_magnetic_cargo";
/// The crew set the hold "degaussing".
pub const HOLD_DEGAUSSING: &str = "hold_degaussing";
/// The horizontal field is too weak or the place too near a pole.
pub const HIGH_LATITUDE: &str = "high_latitude";
/// The clock went backwards or jumped.
pub const CLOCK: &str = "clock";
/// Too few readings within the window.
pub const SPARSE: &str = "sparse";
/// No time stamp fell into the window.
pub const NO_TIME: &str = "no_time";

/// The reasons in the order of their numbers, from 1.
const KNOWN: [&str; 16] = [
    ACCEPTED,
    SLOW,
    TURNING,
    SETTLING,
    SWINGING,
    NO_COMPASS,
    NO_REFERENCE,
    NO_POSITION,
    NO_SPEED,
    HOLD_BERTHED,
    HOLD_MAGNETIC_CARGO,
    HOLD_DEGAUSSING,
    HIGH_LATITUDE,
    CLOCK,
    SPARSE,
    NO_TIME,
];

/// Returns a reason's number in a frame; `None` when it is sent by name.
pub(crate) fn number(name: &str) -> Option<u64> {
    let index = KNOWN.iter().position(|known| *known == name)?;
    Some(index as u64 + 1)
}

/// Returns the reason of a number; `None` for 0 and for numbers of later
/// versions.
pub(crate) fn name(number: u64) -> Option<&'static str> {
    let index = usize::try_from(number.checked_sub(1)?).ok()?;
    KNOWN.get(index).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_leads_back_to_its_name() {
        for known in KNOWN {
            assert_eq!(number(known).and_then(name), Some(known));
        }
        assert_eq!(number("no such reason"), None);
        assert_eq!((name(0), name(17), name(u64::MAX)), (None, None, None));
    }
}
