//! How a binnacle's correctors stand, in words.

use binnacle_magnetics::binnacle::{Red, Setting, Shape, Side, Tray};

/// What a corrector is, and how it stands; a line for each there may be.
pub fn in_words(setting: &Setting, shape: Option<Shape>) -> [(&'static str, String); 5] {
    let pair = match shape {
        Some(Shape::Sphere) => "Spheres",
        Some(Shape::Box) => "Boxes",
        Some(Shape::Plate) => "Plates",
        None => "Quadrantal",
    };
    let quadrantal = setting.quadrantal.as_ref().map(|pair| {
        format!(
            "{} at {} mm{}",
            pair.size,
            pair.mark_mm,
            slewed(pair.slew_deg)
        )
    });
    let flinders = setting.flinders.as_ref().map(|bar| {
        let side = match bar.side {
            Side::Forward => "forward",
            Side::Aft => "aft",
        };
        format!("{} mm {side}{}", bar.length_mm, slewed(bar.slew_deg))
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
        format!("{count} × {} in {hole}, red {}", tray.magnet, red(tray.red))
    });
    let all: Vec<String> = words.collect();
    or_none((!all.is_empty()).then(|| all.join("; ")))
}

fn or_none(words: Option<String>) -> String {
    words.unwrap_or_else(|| "none".to_owned())
}

fn slewed(slew_deg: f64) -> String {
    if slew_deg == 0.0 {
        return String::new();
    }
    format!(", slewed {slew_deg}°")
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
