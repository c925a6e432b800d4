//! A hand that follows a step's words, and knows nothing else of the step.

use super::world::Binnacle;

/// Moves correctors as the words say.
pub(crate) fn done(binnacle: &mut Binnacle, words: &str) {
    let (corrector, rest) = words.split_once(": ").unwrap();
    let (from, to) = match rest.split_once(' ').unwrap() {
        ("fit", to) => (None, Some(to)),
        ("take", from) => (Some(from.strip_prefix("out ").unwrap()), None),
        ("from", places) => {
            let (from, to) = places.split_once(" to ").unwrap();
            (Some(from), Some(to))
        }
        _ => panic!("{words}"),
    };
    match corrector {
        "fore-and-aft magnets" => magnets(binnacle, "forward", from, to),
        "athwartship magnets" => magnets(binnacle, "starboard", from, to),
        "Flinders bar" => {
            assert_eq!(binnacle.bar, from.map(bar), "{words}");
            binnacle.bar = to.map(bar);
        }
        "quadrantal correctors" => {
            assert_eq!(binnacle.spheres, from.map(spheres), "{words}");
            binnacle.spheres = to.map(spheres);
        }
        "heeling magnets" => {
            assert_eq!(binnacle.bucket, from.map(bucket), "{words}");
            binnacle.bucket = to.map(bucket);
        }
        _ => panic!("{words}"),
    }
}

fn magnets(binnacle: &mut Binnacle, axis: &'static str, from: Option<&str>, to: Option<&str>) {
    if let Some(from) = from {
        let (hole, held) = tray(from);
        assert_eq!(binnacle.magnets.remove(&(axis, hole)), Some(held), "{from}");
    }
    if let Some(to) = to {
        let (hole, held) = tray(to);
        let taken = binnacle.magnets.insert((axis, hole), held);
        assert_eq!(taken, None, "a hole takes magnets once: {to}");
    }
}

/// `tray at hole 5 with 2 of 200 mm, red aft`
fn tray(words: &str) -> (u16, (u8, String)) {
    let rest = words.split_once("hole ").unwrap().1;
    let (hole, rest) = rest.split_once(" with ").unwrap();
    let (count, rest) = rest.split_once(" of ").unwrap();
    let red = rest.split_once(", red ").unwrap().1;
    let held = (count.parse().unwrap(), red.to_owned());
    (hole.parse().unwrap(), held)
}

/// `400 mm (200 + 200 mm, the longest on top) forward of the card, 20 degrees to port`
fn bar(words: &str) -> (f64, f64) {
    let length_mm: f64 = words.split_once(" mm").unwrap().0.parse().unwrap();
    let (_, place) = words.split_once(") ").unwrap();
    let (side, slew) = place.split_once("the card").unwrap();
    let slewed = |towards: &str| {
        let slew = slew.strip_prefix(", ")?;
        let degrees = slew.strip_suffix(&format!(" degrees to {towards}"))?;
        Some(degrees.parse::<f64>().unwrap())
    };
    let to_starboard = slewed("starboard").or(slewed("port").map(|degrees| -degrees));
    assert!(slew.is_empty() || to_starboard.is_some(), "{words}");
    let to_starboard = to_starboard.unwrap_or(0.0);
    let clockwise_deg = match side {
        "forward of " => to_starboard,
        "abaft " => 180.0 - to_starboard,
        _ => panic!("{words}"),
    };
    (length_mm / 1e3, clockwise_deg)
}

/// `7 inch at 320 mm, starboard one 20 degrees aft`
fn spheres(words: &str) -> (f64, f64) {
    let rest = words.split_once(" at ").unwrap().1;
    let (mark_mm, slew) = rest.split_once(" mm").unwrap();
    let aft_deg = match slew.strip_prefix(", starboard one ") {
        None => 0.0,
        Some(slew) => {
            let (degrees, side) = slew.split_once(" degrees ").unwrap();
            let degrees: f64 = degrees.parse().unwrap();
            match side {
                "aft" => degrees,
                "forward" => -degrees,
                _ => panic!("{words}"),
            }
        }
    };
    (mark_mm.parse::<f64>().unwrap() / 1e3, aft_deg)
}

/// `position 4 with 1, red up`
fn bucket(words: &str) -> (u16, u8, String) {
    let rest = words.strip_prefix("position ").unwrap();
    let (position, rest) = rest.split_once(" with ").unwrap();
    let (count, red) = rest.split_once(", red ").unwrap();
    let numbers = (position.parse().unwrap(), count.parse().unwrap());
    (numbers.0, numbers.1, red.to_owned())
}
