//! Curve beside the table, with headings downwards and west to the left.

use super::style::{GREY, LINE, RIGHT};
use super::table::{Lines, line_name};
use crate::card::contents::{Card, CardRow};
use binnacle_drawing::angles::east_west;
use binnacle_drawing::{Pen, Point, Sheet, Style};
use binnacle_fleet::deviation::DeviationRow;

const LEFT: f32 = 352.0;
const BAND: u8 = 214;

/// Horizontal scale of deviations.
struct Across {
    most_deg: f64,
}

/// Draws the curve.
pub(super) fn draw(sheet: &mut Sheet, card: &Card, lines: &Lines) {
    let curve: Vec<DeviationRow> = around(&card.curve);
    let (step_deg, steps) = scale(&curve, &card.rows);
    let across = Across {
        most_deg: step_deg * f64::from(steps),
    };
    band(sheet, &curve, lines, &across);
    grid(sheet, lines, &across, step_deg, steps);
    let points = curve.iter().map(|row| {
        let x = across.x(row.deviation_deg);
        (x, lines.y(row.compass_deg))
    });
    sheet.line(points.collect(), Pen::black(1.4));
    for row in &card.rows {
        cross(sheet, row, lines, &across);
    }
    legend(sheet, lines);
}

/// Closes the curve from 0 to 360.
fn around(curve: &[DeviationRow]) -> Vec<DeviationRow> {
    let again = curve.first().map(|row| DeviationRow {
        compass_deg: 360.0,
        ..*row
    });
    curve.iter().copied().chain(again).collect()
}

/// Degrees from one line of the grid to the next, and how many to each side, so that all
/// that was observed is in sight.
fn scale(curve: &[DeviationRow], rows: &[CardRow]) -> (f64, u32) {
    let reach = |row: &DeviationRow| row.deviation_deg.abs() + row.band95_deg.unwrap_or(0.0);
    let observed = rows.iter().filter_map(observed_deg).map(f64::abs);
    let most_deg = curve.iter().map(reach).chain(observed).fold(1.0, f64::max);
    let steps_deg = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0];
    let step_deg = steps_deg
        .into_iter()
        .find(|step_deg| most_deg <= 4.0 * step_deg)
        .unwrap_or(90.0);
    (step_deg, (most_deg / step_deg).ceil() as u32)
}

impl Across {
    fn x(&self, deviation_deg: f64) -> f32 {
        let middle = f32::midpoint(LEFT, RIGHT);
        middle + (RIGHT - LEFT) / 2.0 * (deviation_deg / self.most_deg) as f32
    }
}

fn band(sheet: &mut Sheet, curve: &[DeviationRow], lines: &Lines, across: &Across) {
    let edge = |sign: f64| {
        move |row: &DeviationRow| -> Point {
            let band_deg = row.band95_deg.unwrap_or(0.0);
            let x = across.x(row.deviation_deg + sign * band_deg);
            (x, lines.y(row.compass_deg))
        }
    };
    let there = curve.iter().map(edge(1.0));
    let back = curve.iter().rev().map(edge(-1.0));
    sheet.area(there.chain(back).collect(), BAND);
    for sign in [1.0, -1.0] {
        let points = curve.iter().map(edge(sign)).collect();
        sheet.line(points, Pen::black(0.5).grey(120).dashed(2.0));
    }
}

fn grid(sheet: &mut Sheet, lines: &Lines, across: &Across, step_deg: f64, steps: u32) {
    let (top, bottom) = (lines.y(0.0), lines.y(360.0));
    let steps = i32::try_from(steps).unwrap_or(i32::MAX);
    for step in -steps..=steps {
        let degrees = f64::from(step) * step_deg;
        let x = across.x(degrees);
        let pen = match step {
            0 => Pen::black(0.8),
            _ => Pen::black(0.3).grey(150),
        };
        sheet.line(vec![(x, top), (x, bottom)], pen);
        // The outermost would stand over the margin.
        if step.abs() < steps {
            let label = Style::plain(7.0).grey(GREY).middle();
            sheet.text((x, top - 11.5), label, whole(degrees));
        }
    }
    for eighth in 0..=8 {
        let compass_deg = f64::from(eighth) * 45.0;
        let y = lines.y(compass_deg);
        sheet.line(vec![(LEFT, y), (RIGHT, y)], Pen::black(0.3).grey(150));
        let label = Style::plain(7.0).grey(GREY).end();
        sheet.text((LEFT - 4.0, y + 2.5), label, line_name(compass_deg));
    }
}

/// Formats degrees, without the tenth where it is zero.
fn whole(degrees: f64) -> String {
    east_west(degrees).replace(".0°", "°")
}

/// Returns the mean deviation observed near a heading.
fn observed_deg(row: &CardRow) -> Option<f64> {
    Some(row.deviation_deg + row.residual_deg?)
}

/// Draws the observed deviation near a heading.
fn cross(sheet: &mut Sheet, row: &CardRow, lines: &Lines, across: &Across) {
    const ARM: f32 = 2.4;
    let Some(observed_deg) = observed_deg(row) else {
        return;
    };
    let (x, y) = (across.x(observed_deg), lines.y(row.compass_deg));
    sheet.rule((x - ARM, y - ARM), (x + ARM, y + ARM), 0.7);
    sheet.rule((x - ARM, y + ARM), (x + ARM, y - ARM), 0.7);
}

fn legend(sheet: &mut Sheet, lines: &Lines) {
    let y = lines.bottom() + LINE / 2.0 + 2.0;
    let style = Style::plain(7.0).grey(GREY);
    let text = "line: deviation · grey: 95 % band · ×: mean observed";
    sheet.text((RIGHT, y), style.end(), text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_disagrees_most_is_within_the_chart() {
        let curve = [DeviationRow {
            compass_deg: 285.0,
            magnetic_deg: 284.9,
            deviation_deg: -0.1,
            band95_deg: Some(1.2),
        }];
        let row = |residual_deg: Option<f64>| CardRow {
            compass_deg: 285.0,
            magnetic_deg: 284.9,
            deviation_deg: -0.1,
            band95_deg: 1.2,
            samples: 9,
            residual_deg,
        };
        let most_deg = |rows: &[CardRow]| {
            let (step_deg, steps) = scale(&curve, rows);
            step_deg * f64::from(steps)
        };
        assert!((most_deg(&[row(None)]) - 1.5).abs() < 1e-9);
        assert!((most_deg(&[row(None), row(Some(-1.8))]) - 2.0).abs() < 1e-9);
    }
}
