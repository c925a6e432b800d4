//! Upper part of the sheet: status, ship, compass, place and time.

use super::style::{LEFT, RIGHT, draw_fact, known};
use crate::card::contents::Card;
use binnacle_drawing::angles::{east_west, latitude, longitude};
use binnacle_drawing::{MARGIN, Sheet, Style};
use binnacle_fleet::compasses::Role;

const FACT_LINE: f32 = 12.5;
/// Left edge of the right column, and its width.
const SECOND: f32 = 306.0;

/// Draws the upper part. Returns its lower edge.
pub(super) fn draw(sheet: &mut Sheet, card: &Card) -> f32 {
    sheet.text((LEFT, MARGIN + 20.0), Style::bold(20.0), "Deviation card");
    mark(sheet, card);
    let rule = MARGIN + 44.0;
    sheet.rule((LEFT, rule), (RIGHT, rule), 1.2);
    let (first, second) = facts(card);
    let column = |sheet: &mut Sheet, x: f32, room: f32, facts: &[(&str, String)]| {
        for (index, (label, value)) in facts.iter().enumerate() {
            let y = rule + 14.0 + FACT_LINE * index as f32;
            draw_fact(sheet, (x, y), label, value, room);
        }
    };
    column(sheet, LEFT, SECOND - LEFT - 12.0, &first);
    column(sheet, SECOND, RIGHT - SECOND, &second);
    let bottom = rule + 18.0 + FACT_LINE * (first.len() - 1) as f32;
    sheet.rule((LEFT, bottom), (RIGHT, bottom), 0.4);
    bottom
}

/// Draws the card's status, so that nobody can overlook it.
fn mark(sheet: &mut Sheet, card: &Card) {
    let predicted_by = card.model.foretold_by.and(card.unverified_order);
    let (word, why) = match &card.verified {
        None if predicted_by.is_some() => (
            "PREDICTED",
            "predicted from an adjustment at the berth; not verified at sea".to_owned(),
        ),
        None => (
            "PREDICTED",
            "by a model of observations under way; no adjuster has signed it".to_owned(),
        ),
        Some(by) => (
            "VERIFIED AT SEA",
            format!(
                "{} headings to {} agree with the prediction",
                by.headings,
                by.until.day()
            ),
        ),
    };
    let (left, top, bottom) = (RIGHT - 250.0, MARGIN, MARGIN + 36.0);
    sheet.frame((left, top), (RIGHT, bottom), 1.5);
    let middle = f32::midpoint(left, RIGHT);
    let says = format!("{word} – NOT A CERTIFICATE");
    sheet.text((middle, top + 17.0), Style::bold(13.0).middle(), says);
    let small = Style::plain(7.5).middle();
    sheet.text((middle, top + 29.0), small, why);
}

type Facts = Vec<(&'static str, String)>;

fn facts(card: &Card) -> (Facts, Facts) {
    let (vessel, compass, place) = (&card.vessel, &card.compass, &card.place);
    let role = match compass.role {
        Role::Standard => "standard compass",
        Role::Steering => "steering compass",
        Role::Transmitting => "transmitting element",
    };
    let of_ship = vec![
        ("Ship", vessel.name.clone()),
        ("IMO number", known(vessel.imo_number.as_deref()).to_owned()),
        ("Call sign", known(vessel.call_sign.as_deref()).to_owned()),
        ("Flag", known(vessel.flag.as_deref()).to_owned()),
        (
            "Place",
            format!("{}  {}", latitude(place.lat), longitude(place.lon)),
        ),
        ("Date", place.at.to_the_minute()),
    ];
    let named = if compass.name.to_lowercase() == role {
        compass.name.clone()
    } else {
        format!("{} ({role})", compass.name)
    };
    let recorded = card
        .correctors
        .as_ref()
        .map(|found| found.binnacle.as_str());
    let binnacle = compass.binnacle.as_deref().or(recorded);
    let of_compass = vec![
        ("Compass", named),
        ("Make and type", known(compass.make.as_deref()).to_owned()),
        (
            "Serial number",
            known(compass.serial_number.as_deref()).to_owned(),
        ),
        ("Binnacle", known(binnacle).to_owned()),
        (
            "Variation",
            format!(
                "{} by {}",
                east_west(place.variation_deg),
                source(&place.variation_source)
            ),
        ),
        (
            "Earth’s field",
            format!(
                "horizontal {:.1} µT, vertical {:.1} µT {}",
                place.h_nt / 1000.0,
                place.z_nt.abs() / 1000.0,
                if place.z_nt < 0.0 { "up" } else { "down" }
            ),
        ),
    ];
    (of_ship, of_compass)
}

/// Returns a field model's name as its makers write it.
fn source(name: &str) -> String {
    name.to_uppercase().replace("IGRF", "IGRF-")
}
