//! Angles and positions in nautical notation.

/// Formats an angle to a tenth with E or W, east positive; zero has no side.
pub fn east_west(degrees: f64) -> String {
    sided(degrees, "E", "W")
}

fn sided(degrees: f64, positive: &str, negative: &str) -> String {
    let size = format!("{:.1}", degrees.abs());
    let side = match size.as_str() {
        "0.0" => return format!("{size}°"),
        _ if degrees < 0.0 => negative,
        _ => positive,
    };
    format!("{size}° {side}")
}

/// Formats a signed angle to a tenth, with a true minus sign.
pub fn signed(degrees: f64) -> String {
    let size = format!("{:.1}°", degrees.abs());
    match size.as_str() {
        "0.0°" => size,
        _ if degrees < 0.0 => format!("−{size}"),
        _ => format!("+{size}"),
    }
}

/// Formats a heading with three digits; one that rounds to 360 is 000.
pub fn heading(degrees: f64) -> String {
    format!("{:03.0}°", degrees.round().rem_euclid(360.0))
}

/// Formats a heading with three digits and a decimal; one that rounds to 360 is 000.
pub fn heading_to_a_tenth(degrees: f64) -> String {
    let tenths = (10.0 * degrees).round().rem_euclid(3600.0);
    format!("{:05.1}°", tenths / 10.0)
}

/// Formats a latitude in degrees and minutes.
pub fn latitude(degrees: f64) -> String {
    minutes(degrees, 2, "N", "S")
}

/// Formats a longitude in degrees and minutes.
pub fn longitude(degrees: f64) -> String {
    minutes(degrees, 3, "E", "W")
}

fn minutes(degrees: f64, figures: usize, positive: &str, negative: &str) -> String {
    let tenths = (degrees.abs() * 600.0).round() as u32;
    let side = if degrees < 0.0 { negative } else { positive };
    let (whole, minutes) = (tenths / 600, f64::from(tenths % 600) / 10.0);
    format!("{whole:0figures$}° {minutes:04.1}′ {side}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn east_and_west_are_never_taken_for_each_other_and_nil_has_no_side() {
        let cases = [2.34, -2.34, 0.04, -0.04, 0.06, -0.06, -0.0];
        let words = [
            "2.3° E", "2.3° W", "0.0°", "0.0°", "0.1° E", "0.1° W", "0.0°",
        ];
        assert_eq!(cases.map(east_west), words);
        assert_eq!([1.26, -1.26, -0.04].map(signed), ["+1.3°", "−1.3°", "0.0°"]);
    }

    #[test]
    fn headings_have_three_figures_and_no_360() {
        assert_eq!(
            [0.0, 7.4, 359.4, 359.6].map(heading),
            ["000°", "007°", "359°", "000°"]
        );
        let tenths = [0.04, 7.25, 359.94, 359.96].map(heading_to_a_tenth);
        assert_eq!(tenths, ["000.0°", "007.3°", "359.9°", "000.0°"]);
    }

    #[test]
    fn a_place_is_printed_in_degrees_and_minutes_of_its_own_side() {
        assert_eq!(latitude(43.456), "43° 27.4′ N");
        assert_eq!(latitude(-0.5), "00° 30.0′ S");
        assert_eq!(longitude(-3.1), "003° 06.0′ W");
        assert_eq!(longitude(179.999_9), "180° 00.0′ E");
    }
}
