//! Description of a binnacle's corrector setting as text.

use binnacle_adjustment::binnacle::{Red, Setting, Shape, Side, Tray};

/// Describes each corrector and its setting, a line for each possible kind.
pub fn describe_setting(setting: &Setting, shape: Option<Shape>) -> [(&'static str, String); 5] {
    let pair = match shape {
        Some(Shape::Sphere) => "Kelvin spheres",
        Some(Shape::Box) => "Boxes",
        Some(Shape::Plate) => "Plates",
        None => "Quadrantal",
    };
    let quadrantal = setting.quadrantal.as_ref().map(|pair| {
        format!(
            "{} at {} mm{}",
            pair.size,
            pair.mark_mm,
            slewed(
                pair.slew_deg,
                ["starboard one aft", "starboard one forward"]
            )
        )
    });
    let flinders = setting.flinders.as_ref().map(|bar| {
        // Seen from above, clockwise from forward is to starboard, from abaft to port.
        let (side, ways) = match bar.side {
            Side::Forward => ("forward", ["to starboard", "to port"]),
            Side::Aft => ("aft", ["to port", "to starboard"]),
        };
        format!("{} mm {side}{}", bar.length_mm, slewed(bar.slew_deg, ways))
    });
    let heeling = setting.heeling.as_ref().map(|bucket| {
        let (count, position) = (bucket.count, bucket.position);
        format!("{count} in position {position}, red {}", red(bucket.red))
    });
    [
        ("Fore-and-aft", magnets(&setting.fore_and_aft)),
        ("Athwartship", magnets(&setting.athwartship)),
        (pair, or_none(quadrantal)),
        ("Flinders bar", or_none(flinders)),
        ("Heeling magnet", or_none(heeling)),
    ]
}

fn magnets(trays: &[Tray]) -> String {
    let words = trays.iter().map(|tray| {
        let (count, hole) = (tray.count, tray.hole);
        format!(
            "{count} × {} in hole {hole}, red {}",
            tray.magnet,
            red(tray.red)
        )
    });
    let all: Vec<String> = words.collect();
    or_none((!all.is_empty()).then(|| all.join("; ")))
}

fn or_none(words: Option<String>) -> String {
    words.unwrap_or_else(|| "none".to_owned())
}

/// Describes an angle and its direction: clockwise seen from above, or the other way.
fn slewed(slew_deg: f64, [clockwise, other]: [&str; 2]) -> String {
    if slew_deg == 0.0 {
        return String::new();
    }
    let way = if slew_deg > 0.0 { clockwise } else { other };
    format!(", slewed {}°, {way}", slew_deg.abs())
}

fn red(red: Red) -> &'static str {
    match red {
        Red::Forward => "forward",
        Red::Aft => "aft",
        Red::Starboard => "to starboard",
        Red::Port => "to port",
        Red::Up => "up",
        Red::Down => "down",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_adjustment::binnacle::{BarSetting, PairSetting};

    #[test]
    fn slewed_iron_says_which_way() {
        let setting = |side, slew_deg| Setting {
            quadrantal: Some(PairSetting {
                size: "7 inch".to_owned(),
                mark_mm: 320.0,
                slew_deg,
            }),
            flinders: Some(BarSetting {
                length_mm: 225.0,
                side,
                slew_deg,
            }),
            ..Setting::default()
        };
        for (side, slew_deg, pair, bar) in [
            (
                Side::Forward,
                10.0,
                "7 inch at 320 mm, slewed 10°, starboard one aft",
                "225 mm forward, slewed 10°, to starboard",
            ),
            (
                Side::Forward,
                -10.0,
                "7 inch at 320 mm, slewed 10°, starboard one forward",
                "225 mm forward, slewed 10°, to port",
            ),
            (
                Side::Aft,
                10.0,
                "7 inch at 320 mm, slewed 10°, starboard one aft",
                "225 mm aft, slewed 10°, to port",
            ),
            (Side::Aft, 0.0, "7 inch at 320 mm", "225 mm aft"),
        ] {
            let words = describe_setting(&setting(side, slew_deg), Some(Shape::Sphere));
            assert_eq!((words[2].0, words[2].1.as_str()), ("Kelvin spheres", pair));
            assert_eq!(words[3].1, bar);
        }
    }
}
