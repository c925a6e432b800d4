//! Tables of the printed record: correctors before and after, steps, predicted deviations, and
//! the model's parameters.

use super::values::{minute, number, word};
use binnacle_adjustment::binnacle::{Binnacle, Setting, Shape};
use binnacle_drawing::angles::{east_west, heading, heading_to_a_tenth, signed};
use binnacle_drawing::paper::{LEFT, Paper, SIZE, VALUE};
use binnacle_drawing::{Style, cut};
use binnacle_fleet::binnacles::describe_setting;
use serde_json::Value;

/// Width of a column of figures.
const COLUMN: f32 = 84.0;
/// Most places in one table.
const PLACES: usize = 5;

/// Corrector settings before and after.
pub(super) fn draw_correctors(paper: &mut Paper, record: &Value) -> anyhow::Result<()> {
    let setting = |name: &str| serde_json::from_value::<Setting>(record[name].clone());
    let (before, after) = (setting("setting_before")?, setting("setting_after")?);
    let binnacle: Binnacle = serde_json::from_value(record["binnacle_after"].clone())?;
    let shape = shape_of(&binnacle, [&after, &before]);
    let design = &binnacle.design;
    paper.title("Correctors");
    paper.fact(
        "Binnacle",
        &format!("{} {}, no. {}", design.maker, design.model, binnacle.serial),
    );
    let lines = describe_setting(&before, shape).into_iter();
    for ((label, before), (_, after)) in lines.zip(describe_setting(&after, shape)) {
        if before == after {
            paper.fact(label, &format!("{after}, as before"));
        } else {
            paper.fact(label, &format!("{after} (before: {before})"));
        }
    }
    Ok(())
}

/// Shape of the quadrantal correctors in one of these settings.
fn shape_of(binnacle: &Binnacle, settings: [&Setting; 2]) -> Option<Shape> {
    let of = |setting: &Setting| -> Option<Shape> {
        let pair = setting.quadrantal.as_ref()?;
        let sizes = &binnacle.design.quadrantal.as_ref()?.sizes;
        Some(sizes.iter().find(|size| size.name == pair.size)?.shape)
    };
    settings.into_iter().find_map(of)
}

/// Reported corrector settings, beside the steps.
pub(super) fn draw_reported_settings(paper: &mut Paper, record: &Value) -> anyhow::Result<()> {
    let binnacle: Binnacle = serde_json::from_value(record["binnacle_after"].clone())?;
    let reports = record["settings_as_said"].as_array().into_iter().flatten();
    for (index, report) in reports.enumerate() {
        paper.keep_together(3);
        if index == 0 {
            paper.title("Correctors, as reported");
        }
        let before: Setting = serde_json::from_value(report["before"].clone())?;
        let after: Setting = serde_json::from_value(report["after"].clone())?;
        let shape = shape_of(&binnacle, [&after, &before]);
        let lines = describe_setting(&before, shape).into_iter();
        let moved: Vec<String> = lines
            .zip(describe_setting(&after, shape))
            .filter(|(before, after)| before != after)
            .map(|((label, before), (_, after))| format!("{label}: {after} (before: {before})"))
            .collect();
        let stands = if moved.is_empty() {
            "as assumed".to_owned()
        } else {
            moved.join("; ")
        };
        let note = match word(&report["note"]) {
            none if none.is_empty() => String::new(),
            note => format!(" “{note}”"),
        };
        let text = format!("received {}: {stands}{note}", minute(&report["at"]));
        paper.lines(LEFT, Style::plain(SIZE), &text);
    }
    Ok(())
}

/// Steps, with the compass readings.
pub(super) fn draw_steps(paper: &mut Paper, record: &Value) {
    let steps = record["steps_as_read"].as_array();
    paper.title("Steps, as shown by the compass");
    if steps.is_none_or(Vec::is_empty) {
        paper.lines(LEFT, Style::plain(SIZE), "None: nothing had to be moved.");
    }
    // Each plan numbers its steps from one; the sheet numbers them continuously.
    for (index, step) in steps.into_iter().flatten().enumerate() {
        let result = &step["said"];
        let turned = (number(&result["after_deg"]) - number(&result["before_deg"]) + 540.0)
            .rem_euclid(360.0);
        paper.keep_together(3);
        let words = format!("{}. {}", index + 1, word(&step["words"]));
        paper.lines(LEFT, Style::plain(SIZE), &words);
        let showed = format!(
            "received {}: compass {} to {}, turned {}, expected {} within {:.1}°: {}",
            minute(&step["at"]),
            heading_to_a_tenth(number(&result["before_deg"])),
            heading_to_a_tenth(number(&result["after_deg"])),
            signed(turned - 180.0),
            signed(number(&result["expected_change_deg"])),
            number(&result["tolerance_deg"]),
            word(&result["words"])
        );
        paper.lines(LEFT + 12.0, Style::plain(SIZE).grey(60), &showed);
    }
}

/// Second readings, and the steps that nothing confirmed.
pub(super) fn draw_second_readings(paper: &mut Paper, record: &Value) {
    let readings = record["second_readings"].as_array();
    let readings = readings.into_iter().flatten();
    for (index, reading) in readings.enumerate() {
        paper.keep_together(5);
        if index == 0 {
            paper.title("The magnetometer after the steps");
        }
        let result = &reading["said"];
        let parts = result["parts"].as_array().into_iter().flatten();
        let parts = parts.zip(["forward", "to starboard", "down"]);
        let microtesla = |value: &Value| format!("{:.2}", number(value) / 1e3);
        let parts: Vec<String> = parts
            .map(|(part, to)| {
                let (read, expected) = (&part["read_nt"], &part["expected_nt"]);
                let figures = format!(
                    "{to} {} µT, predicted {} ± {}",
                    microtesla(read),
                    microtesla(expected),
                    microtesla(&part["standard_error_nt"])
                );
                figures.replace('-', "−")
            })
            .collect();
        let given = &reading["given"];
        let mut text = format!("{}: {}", minute(&given["at"]), word(&result["words"]));
        let could_be = result["could_be"].as_array().into_iter().flatten();
        let could_be: Vec<String> = could_be.map(word).collect();
        if !could_be.is_empty() {
            text += "; it could be that ";
            text += &could_be.join(", or that ");
        }
        paper.lines(LEFT, Style::plain(SIZE), &text);
        let mut figures = parts;
        for (name, what) in [
            ("heading_true_deg", "heading true"),
            ("compass_deg", "compass"),
        ] {
            if let Some(degrees) = given[name].as_f64() {
                figures.push(format!("{what} {}", heading_to_a_tenth(degrees)));
            }
        }
        paper.lines(
            LEFT + 12.0,
            Style::plain(SIZE).grey(60),
            &figures.join("; "),
        );
    }
    let last = record["second_readings"]
        .as_array()
        .and_then(|all| all.last());
    if last.is_some_and(|last| last["said"]["verdict"] == "as_planned") {
        let rests = "The predictions below are based on the last of these readings.";
        paper.lines(LEFT, Style::plain(SIZE), rests);
    }
    let hidden = &record["not_shown"];
    if !hidden.is_object() {
        return;
    }
    let steps = hidden["steps"].as_array().into_iter().flatten();
    let steps: Vec<String> = steps.map(word).collect();
    paper.keep_together(4);
    paper.fact("Not shown", &steps.join("; "));
    paper.fact("which means", &word(&hidden["words"]));
}

/// Deviation by heading, before the adjustment at the berth and after it at each place.
pub(super) fn draw_predicted(paper: &mut Paper, record: &Value) {
    let of = |name: &str| record[name].as_array().into_iter().flatten();
    let before = of("predicted_before")
        .take(1)
        .map(|table| ("before, berth", table));
    let after = of("predicted_after").map(|table| match table["place"].as_str() {
        Some("berth") => ("at the berth", table),
        place => (place.unwrap_or_default(), table),
    });
    let tables: Vec<(&str, &Value)> = before.chain(after).collect();
    for some in tables.chunks(PLACES) {
        paper.keep_together(30);
        paper.title("Predicted deviation, with its 95 % band, by compass heading");
        let across = |index: usize| LEFT + 110.0 + (COLUMN + 16.0) * index as f32;
        let cells = |cell: &dyn Fn(&str, &Value) -> String| -> Vec<(f32, String)> {
            let cells = some.iter().enumerate();
            cells
                .map(|(index, (place, table))| (across(index), cell(place, table)))
                .collect()
        };
        let bold = Style::bold(7.5);
        let places = cells(&|place, _| cut(place, bold.face, bold.size, COLUMN + 12.0));
        paper.row(bold, "Compass", &places);
        for index in 0..24 {
            let row = cells(&|_, table| {
                let row = &table["rows"][index];
                let Some(deviation) = row["deviation_deg"].as_f64() else {
                    return "ambiguous".to_owned();
                };
                let band = row["band95_deg"].as_f64();
                let band = band.map_or(String::new(), |band| format!(" ±{band:.1}°"));
                format!("{}{band}", east_west(deviation))
            });
            paper.row(Style::plain(SIZE), &heading(15.0 * index as f64), &row);
        }
    }
}

/// Parameters over λ with their standard errors, before and as predicted.
pub(super) fn draw_parameters(paper: &mut Paper, record: &Value) {
    const NAMES: [(&str, &str, f64, &str); 8] = [
        ("bx_nt", "bx/λ", 1e-3, "µT"),
        ("chi13", "χ13/λ", 1.0, ""),
        ("by_nt", "by/λ", 1e-3, "µT"),
        ("chi23", "χ23/λ", 1.0, ""),
        ("chi11_minus_chi22", "(χ11 − χ22)/λ", 1.0, ""),
        ("chi12", "χ12/λ", 1.0, ""),
        ("chi21", "χ21/λ", 1.0, ""),
        ("constant_deg", "constant", 1.0, "°"),
    ];
    let models = [&record["model_before"], &record["model_after"]];
    if models.iter().any(|model| !model.is_object()) {
        return;
    }
    paper.keep_together(13);
    paper.title("The model before and after, with standard errors");
    let across = |index: usize| VALUE + 110.0 + 130.0 * index as f32;
    let titles = ["before", "after"].into_iter().enumerate();
    let titles: Vec<_> = titles
        .map(|(index, title)| (across(index), title.to_owned()))
        .collect();
    paper.row(Style::bold(7.5), "", &titles);
    for (place, (name, label, times, unit)) in NAMES.into_iter().enumerate() {
        let cell = |model: &Value| {
            let value = match name {
                "constant_deg" => &model[name],
                _ => &model["parameters_over_lambda"][name],
            };
            let variance = number(&model["covariance"][place][place]);
            let decimals = if unit.is_empty() { 4 } else { 2 };
            let (value, sd) = (times * number(value), times * variance.max(0.0).sqrt());
            let space = if unit == "µT" { " " } else { "" };
            format!("{value:.decimals$} ± {sd:.decimals$}{space}{unit}").replace('-', "−")
        };
        let cells: Vec<_> = models
            .iter()
            .enumerate()
            .map(|(index, model)| (across(index), cell(model)))
            .collect();
        paper.row(Style::plain(SIZE), label, &cells);
    }
    let text = "The full covariance is in record.json.";
    paper.lines(LEFT, Style::plain(7.0).grey(90), text);
}
