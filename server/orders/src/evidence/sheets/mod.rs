//! Printed record, drawn from the record's own text alone.
//!
//! Invariant: each sheet states that it is a prediction and not a certificate, the order, and the
//! SHA-256 of its record.

mod as_found;
mod tables;
mod values;

use crate::work_orders::log::canonical_json::sha256_hex;
use anyhow::Context;
use binnacle_compass::time::Timestamp;
use binnacle_drawing::angles::{east_west, heading_to_a_tenth, latitude, longitude};
use binnacle_drawing::paper::{LEFT, Paper, RIGHT};
use binnacle_drawing::{About, Sheet, Style, pdf, svg};
use serde_json::Value;
use values::{local_minute, minute, number, word};

/// Draws the record as PDF.
///
/// # Errors
/// Fails when the text is not an adjustment record.
pub fn record_pdf(text: &str) -> anyhow::Result<Vec<u8>> {
    let (sheets, about) = draw(text)?;
    pdf(&sheets, &about)
}

/// Draws the record as a picture, its sheets one below the other.
///
/// # Errors
/// Fails when the text is not an adjustment record.
pub fn record_svg(text: &str) -> anyhow::Result<String> {
    let (sheets, about) = draw(text)?;
    Ok(svg(&sheets, &about.title))
}

fn draw(text: &str) -> anyhow::Result<(Vec<Sheet>, About)> {
    let record: Value = serde_json::from_str(text)?;
    let at = record["adjusted_at"].as_str().context("adjusted_at")?;
    let mut paper = Paper::new();
    draw_head(&mut paper, &record);
    draw_basis(&mut paper, &record);
    as_found::draw_as_found(&mut paper, &record);
    tables::draw_correctors(&mut paper, &record)?;
    draw_plan(&mut paper, &record);
    tables::draw_steps(&mut paper, &record);
    tables::draw_reported_settings(&mut paper, &record)?;
    tables::draw_second_readings(&mut paper, &record);
    tables::draw_predicted(&mut paper, &record);
    tables::draw_parameters(&mut paper, &record);
    draw_photos(&mut paper, &record);
    draw_signatures(&mut paper, &record);
    let foot = [
        format!(
            "A prediction, not a certificate. Work order {}; its log has the later verification \
                at sea.",
            word(&record["order"])
        ),
        format!("SHA-256 of record.json: {}", sha256_hex(text.as_bytes())),
    ];
    let about = About {
        title: format!("Adjustment record: {}", word(&record["vessel"]["name"])),
        created: Timestamp::parse(at)?,
    };
    Ok((paper.finish(&foot), about))
}

/// Lists the predicted residuals of a record, one row for each place and heading.
///
/// # Errors
/// Fails when the text is not an adjustment record.
pub fn predicted_csv(text: &str) -> anyhow::Result<String> {
    let record: Value = serde_json::from_str(text)?;
    let tables = record["predicted_after"].as_array();
    let mut lines = vec!["place,compass_deg,predicted_deviation_deg,band95_deg".to_owned()];
    for table in tables.into_iter().flatten() {
        for row in table["rows"].as_array().into_iter().flatten() {
            let band = row["band95_deg"].as_f64();
            let band = band.map_or(String::new(), |band| format!("{band:.2}"));
            lines.push(format!(
                "{},{:.0},{:.2},{band}",
                word(&table["place"]),
                number(&row["compass_deg"]),
                number(&row["deviation_deg"])
            ));
        }
    }
    lines.push(String::new());
    Ok(lines.join("\n"))
}

fn join_nonempty(parts: &[String]) -> String {
    let given: Vec<&str> = parts.iter().map(String::as_str).collect();
    let given: Vec<&str> = given.into_iter().filter(|part| !part.is_empty()).collect();
    given.join(", ")
}

fn draw_head(paper: &mut Paper, record: &Value) {
    paper.put(LEFT, Style::bold(18.0), "Adjustment record");
    let text = "PREDICTED – NOT A CERTIFICATE";
    paper.put(RIGHT, Style::bold(11.0).end(), text);
    paper.down(20.0);
    let (vessel, compass) = (&record["vessel"], &record["compass"]);
    let numbered = |label: &str, value: &Value| match word(value).as_str() {
        "" => String::new(),
        number => format!("{label} {number}"),
    };
    for (label, value) in [
        ("Ship", word(&vessel["name"])),
        ("IMO number", word(&vessel["imo_number"])),
        (
            "Call sign, flag",
            join_nonempty(&[word(&vessel["call_sign"]), word(&vessel["flag"])]),
        ),
        (
            "Compass",
            join_nonempty(&[
                word(&compass["name"]),
                word(&compass["make"]),
                numbered("no.", &compass["serial_number"]),
            ]),
        ),
        (
            "Port, berth",
            join_nonempty(&[word(&record["port"]), word(&record["berth"])]),
        ),
        ("Agreed hours", word(&record["agreed_hours"]["words"])),
        ("Adjusted at", adjusted_at(record)),
        ("Work order", word(&record["order"])),
    ] {
        paper.fact(label, &value);
    }
}

/// Time of the adjustment, with the port's own where the record has it.
fn adjusted_at(record: &Value) -> String {
    let at = minute(&record["adjusted_at"]);
    match local_minute(&record["adjusted_at_local"]) {
        Some(local) => format!("{at}; {local}, port's time"),
        None => at,
    }
}

fn draw_basis(paper: &mut Paper, record: &Value) {
    let (read, check) = (&record["reading"], &record["berth_check"]);
    let (earth, data) = (&record["earth_at_berth"], &record["data"]);
    paper.title("Basis");
    paper.fact(
        "Model",
        &format!(
            "version {} by {}, data up to {}",
            data["model_version"],
            word(&data["estimator"]),
            minute(&data["until"])
        ),
    );
    paper.fact("its data", &format!("SHA-256 {}", word(&data["sha256"])));
    paper.fact(
        "Berth",
        &format!(
            "{}, {}; variation {}, horizontal {:.1} µT, vertical {:.1} µT ({})",
            latitude(number(&read["lat"])),
            longitude(number(&read["lon"])),
            east_west(number(&earth["variation_deg"])),
            number(&earth["h_nt"]) / 1e3,
            number(&earth["z_nt"]) / 1e3,
            word(&earth["model"])
        ),
    );
    paper.fact(
        "Heading",
        &format!(
            "{} true, {}; heel {}°",
            heading_to_a_tenth(number(&read["heading_true_deg"])),
            match read["heading_from"].as_str() {
                Some("ashore") => "from ashore",
                _ => "by the reference of the model",
            },
            read["heel_deg"]
        ),
    );
    paper.fact("Magnetometer", &magnetometer(read));
    paper.fact(
        "Read",
        &join_nonempty(&[
            minute(&read["at"]),
            if read["steel_nearby"] == true {
                "steel nearby".to_owned()
            } else {
                String::new()
            },
            if read["cargo_on_board"] == true {
                "magnetic cargo on board".to_owned()
            } else {
                String::new()
            },
        ]),
    );
    paper.fact(
        "Shielding factor",
        &format!(
            "{:.3} ± {:.3}; the field points {:.1}° off the model: {}",
            number(&check["lambda"]),
            number(&check["lambda_sd"]),
            number(&check["consistency_deg"]).abs(),
            word(&check["verdict"])
        ),
    );
}

fn magnetometer(read: &Value) -> String {
    let (unit, microtesla) = match read["unit"].as_str() {
        Some("nanotesla") => ("nT", 1e-3),
        Some("microtesla") => ("µT", 1.0),
        Some("gauss") => ("G", 100.0),
        _ => ("mG", 0.1),
    };
    let part = |name: &str, to: &str| {
        let value = read[name].as_f64();
        value.map_or(String::new(), |value| {
            format!("{:.2} µT {to}", value * microtesla).replace('-', "−")
        })
    };
    let read_in = match unit {
        "µT" => String::new(),
        other => format!("read in {other}"),
    };
    join_nonempty(&[
        word(&read["magnetometer"]),
        word(&read["magnetometer_serial"]),
        part("forward", "forward"),
        part("starboard", "to starboard"),
        part("down", "down"),
        read_in,
    ])
}

fn draw_plan(paper: &mut Paper, record: &Value) {
    let (plan, limits) = (&record["plan"], &record["limits"]);
    paper.title("The plan");
    paper.fact(
        "Followed",
        &format!(
            "{}; worst residual {:.1}°, weighted over the waters; widest band ±{:.1}°",
            step_counts(record),
            number(&plan["worst_residual_deg"]),
            number(&plan["widest_band_deg"])
        ),
    );
    let optimality = &plan["optimality"];
    if optimality.is_object() {
        let proven = if optimality["proven"] == true {
            "proven: no setting of the correctors on board is better"
        } else {
            "not proven: another setting may be better"
        };
        let gap = number(&optimality["gap_deg"]);
        paper.fact("Search", &format!("{proven} by more than {gap:.3}°"));
    }
    if limits.is_object() {
        paper.fact(
            "Limits",
            &format!(
                "residual with its band {}°, band {}°, model {} days",
                limits["residual_deg"], limits["band_deg"], limits["model_age_days"]
            ),
        );
    }
    let heeling = &plan["heeling"];
    let heel = |value: &Value| {
        value
            .as_f64()
            .map(|value| format!("{value:.2}").replace('-', "−"))
    };
    match (
        heel(&heeling["before_deg_per_deg"]),
        heel(&heeling["after_deg_per_deg"]),
    ) {
        (Some(before), Some(after)) => paper.fact(
            "Heeling error",
            &format!("{before}° for each degree of heel before, {after}° after"),
        ),
        _ => paper.fact(
            "Heeling magnets",
            "left as found: the vertical field was not read, or cannot be right",
        ),
    }
    for note in plan["notes"].as_array().into_iter().flatten() {
        paper.fact("Note", &word(note));
    }
}

/// Numbers of steps, including those before a new plan, and of steps that moved correctors.
fn step_counts(record: &Value) -> String {
    let steps = record["steps_as_read"].as_array().into_iter().flatten();
    let (moved, read): (Vec<&Value>, Vec<&Value>) = steps.partition(|step| step["moved"] == true);
    let count = |steps: usize| match steps {
        1 => "1 step".to_owned(),
        steps => format!("{steps} steps"),
    };
    match (moved.len(), read.len()) {
        (moved, 0) => count(moved),
        (moved, read) => format!("{}, {moved} of which moved correctors", count(moved + read)),
    }
}

fn draw_photos(paper: &mut Paper, record: &Value) {
    let photos = record["photos"].as_array();
    let photos = photos.filter(|photos| !photos.is_empty());
    let Some(photos) = photos else {
        return;
    };
    paper.title("Photographs");
    for (index, photo) in photos.iter().enumerate() {
        let caption = match word(&photo["caption"]) {
            none if none.is_empty() => "without caption".to_owned(),
            words => words,
        };
        let text = format!("{caption}; SHA-256 {}", word(&photo["sha256"]));
        paper.fact(&format!("{}", index + 1), &text);
    }
}

fn draw_signatures(paper: &mut Paper, record: &Value) {
    let adjuster = &record["adjuster"];
    paper.keep_together(8);
    paper.title("Signed");
    paper.fact(
        "Adjuster",
        &format!(
            "{}, licence {}",
            word(&adjuster["name"]),
            word(&adjuster["licence"])
        ),
    );
    paper.fact("Firm", &word(&adjuster["firm"]));
    paper.fact(
        "Signature",
        &format!("typed: {}", word(&adjuster["signature"])),
    );
    paper.fact("Given by", &word(&adjuster["account"]));
    paper.fact(
        "Log",
        &format!(
            "{} entries before this record, the last with SHA-256 {}",
            record["log"]["entries"],
            word(&record["log"]["last_sha256"])
        ),
    );
}
