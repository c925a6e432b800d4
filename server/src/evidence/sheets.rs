//! The record for people, on paper: drawn from the record's own text and nothing else.

use crate::sheet::words::{east_west, heading, latitude, longitude};
use crate::sheet::{About, MARGIN, Sheet, Style, pdf, wrap};
use anyhow::Context;
use binnacle_magnetics::time::Timestamp;
use serde_json::Value;

const LEFT: f32 = MARGIN + 6.0;
const RIGHT: f32 = 595.28 - MARGIN - 6.0;
const BOTTOM: f32 = 841.89 - MARGIN - 14.0;
const LINE: f32 = 11.5;
const SIZE: f32 = 8.5;
/// Where a figure of a table stands, from one to the next.
const COLUMN: f32 = 84.0;
/// So many places stand beside each other.
const PLACES: usize = 5;

/// The record as PDF.
///
/// # Errors
/// When the text is no record of ours.
pub fn record_pdf(record: &str) -> anyhow::Result<Vec<u8>> {
    let record: Value = serde_json::from_str(record)?;
    let at = record["adjusted_at"].as_str().context("adjusted_at")?;
    let mut paper = Paper::new();
    head(&mut paper, &record);
    reading(&mut paper, &record);
    correctors(&mut paper, &record);
    steps(&mut paper, &record);
    predicted(&mut paper, &record);
    foot(&mut paper, &record);
    let about = About {
        title: "Adjustment record".to_owned(),
        created: Timestamp::parse(at)?,
    };
    pdf(&paper.sheets, &about)
}

/// Sheets that are written from the top.
struct Paper {
    sheets: Vec<Sheet>,
    y: f32,
}

impl Paper {
    fn new() -> Paper {
        let mut paper = Paper {
            sheets: Vec::new(),
            y: 0.0,
        };
        paper.turn();
        paper
    }

    fn turn(&mut self) {
        let mut sheet = Sheet::a4();
        let says = "PREDICTED, NOT A CERTIFICATE until headings at sea agree";
        let small = Style::plain(7.5).middle();
        sheet.text((f32::midpoint(LEFT, RIGHT), BOTTOM + 14.0), small, says);
        self.sheets.push(sheet);
        self.y = MARGIN + 14.0;
    }

    fn room_for(&mut self, lines: usize) {
        if self.y + LINE * lines as f32 > BOTTOM {
            self.turn();
        }
    }

    fn put(&mut self, x: f32, style: Style, text: &str) {
        let y = self.y;
        if let Some(sheet) = self.sheets.last_mut() {
            sheet.text((x, y), style, text);
        }
    }

    fn title(&mut self, text: &str) {
        self.room_for(3);
        self.y += 6.0;
        self.put(LEFT, Style::bold(10.5), text);
        self.y += LINE + 2.0;
    }

    fn lines(&mut self, text: &str) {
        for line in wrap(text, Style::plain(SIZE).face, SIZE, RIGHT - LEFT) {
            self.room_for(1);
            self.put(LEFT, Style::plain(SIZE), &line);
            self.y += LINE;
        }
    }

    fn fact(&mut self, label: &str, value: &str) {
        if value.is_empty() {
            return;
        }
        let room = RIGHT - LEFT - 120.0;
        let lines = wrap(value, Style::plain(SIZE).face, SIZE, room);
        for (index, line) in lines.iter().enumerate() {
            self.room_for(1);
            if index == 0 {
                self.put(LEFT, Style::plain(SIZE).grey(90), label);
            }
            self.put(LEFT + 120.0, Style::plain(SIZE), line);
            self.y += LINE;
        }
    }
}

fn word(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => String::new(),
        other => other.to_string(),
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_default()
}

fn head(paper: &mut Paper, record: &Value) {
    paper.put(LEFT, Style::bold(18.0), "Adjustment record");
    let says = "PREDICTED – NOT A CERTIFICATE";
    paper.put(RIGHT, Style::bold(11.0).end(), says);
    paper.y += 18.0;
    let (vessel, compass) = (&record["vessel"], &record["compass"]);
    for (label, value) in [
        ("Ship", word(&vessel["name"])),
        ("IMO number", word(&vessel["imo_number"])),
        (
            "Call sign, flag",
            joined(&[&vessel["call_sign"], &vessel["flag"]]),
        ),
        (
            "Compass",
            joined(&[
                &compass["name"],
                &compass["make"],
                &compass["serial_number"],
            ]),
        ),
        ("Port, berth", joined(&[&record["port"], &record["berth"]])),
        ("Adjusted at", word(&record["adjusted_at"])),
        ("Work order", word(&record["order"])),
    ] {
        paper.fact(label, &value);
    }
}

fn joined(parts: &[&Value]) -> String {
    let given: Vec<String> = parts.iter().map(|part| word(part)).collect();
    let given: Vec<String> = given.into_iter().filter(|part| !part.is_empty()).collect();
    given.join(", ")
}

fn reading(paper: &mut Paper, record: &Value) {
    let (read, check) = (&record["reading"], &record["berth_check"]);
    let (earth, data) = (&record["earth_at_berth"], &record["data"]);
    paper.title("What it rests on");
    paper.fact(
        "Model",
        &format!(
            "version {}, data up to {}, SHA-256 {}",
            data["model_version"],
            word(&data["until"]),
            word(&data["sha256"])
        ),
    );
    paper.fact(
        "Berth",
        &format!(
            "{}, {}; variation {}, H {:.1} µT, Z {:.1} µT ({})",
            latitude(number(&read["lat"])),
            longitude(number(&read["lon"])),
            east_west(number(&earth["variation_deg"])),
            number(&earth["h_nt"]) / 1e3,
            number(&earth["z_nt"]) / 1e3,
            word(&earth["model"])
        ),
    );
    paper.fact(
        "Magnetometer",
        &format!(
            "{} forward, {} to starboard, {}; true heading {}; {}",
            read["forward"],
            read["starboard"],
            word(&read["unit"]),
            heading(number(&read["heading_true_deg"])),
            word(&read["magnetometer"])
        ),
    );
    paper.fact(
        "Shielding factor",
        &format!(
            "{:.3} ± {:.3}; the field points {:.1}° from the model's: {}",
            number(&check["lambda"]),
            number(&check["lambda_sd"]),
            number(&check["consistency_deg"]),
            word(&check["verdict"])
        ),
    );
}

fn correctors(paper: &mut Paper, record: &Value) {
    paper.title("Correctors");
    for (label, setting) in [
        ("Before", &record["setting_before"]),
        ("After", &record["setting_after"]),
    ] {
        paper.fact(label, &standing(setting));
    }
}

/// How the correctors stand, in words.
fn standing(setting: &Value) -> String {
    let mut parts = Vec::new();
    for (axis, name) in [
        ("fore_and_aft", "fore-and-aft"),
        ("athwartship", "athwartship"),
    ] {
        for tray in setting[axis].as_array().into_iter().flatten() {
            parts.push(format!(
                "{} {name} magnets {} in {}, red {}",
                tray["count"],
                word(&tray["magnet"]),
                tray["hole"],
                word(&tray["red"])
            ));
        }
    }
    let (pair, bar, bucket) = (
        &setting["quadrantal"],
        &setting["flinders"],
        &setting["heeling"],
    );
    if pair.is_object() {
        parts.push(format!(
            "{} at {} mm, slewed {}°",
            word(&pair["size"]),
            pair["mark_mm"],
            pair["slew_deg"]
        ));
    }
    if bar.is_object() {
        parts.push(format!(
            "Flinders bar {} mm {}",
            bar["length_mm"],
            word(&bar["side"])
        ));
    }
    if bucket.is_object() {
        parts.push(format!(
            "{} heeling magnets in {}, red {}",
            bucket["count"],
            bucket["position"],
            word(&bucket["red"])
        ));
    }
    if parts.is_empty() {
        return "none".to_owned();
    }
    parts.join("; ")
}

fn steps(paper: &mut Paper, record: &Value) {
    let steps = record["steps_as_read"].as_array();
    paper.title("Steps, as the compass showed them");
    for step in steps.into_iter().flatten() {
        let said = &step["said"];
        paper.lines(&format!(
            "{}. {} Compass {:.1}° to {:.1}°, expected to turn by {:.1}°: {}.",
            said["number"],
            word(&step["words"]),
            number(&said["before_deg"]),
            number(&said["after_deg"]),
            number(&said["expected_change_deg"]),
            word(&said["words"])
        ));
    }
}

fn predicted(paper: &mut Paper, record: &Value) {
    let tables: Vec<&Value> = record["predicted_after"]
        .as_array()
        .into_iter()
        .flatten()
        .collect();
    for some in tables.chunks(PLACES) {
        paper.room_for(28);
        paper.title("Deviation foretold, with its 95 % band, by compass heading");
        let row = |paper: &mut Paper, style: Style, first: &str, cells: Vec<String>| {
            paper.put(LEFT, style, first);
            for (index, cell) in cells.iter().enumerate() {
                let x = LEFT + 100.0 + COLUMN * index as f32;
                paper.put(x, style.end(), cell);
            }
            paper.y += LINE;
        };
        let places = some.iter().map(|table| word(&table["place"])).collect();
        row(paper, Style::bold(7.5), "Compass", places);
        for index in 0..24 {
            let cells = some.iter().map(|table| {
                let row = &table["rows"][index];
                match row["band95_deg"].as_f64() {
                    Some(band) => {
                        format!("{} ±{band:.1}°", east_west(number(&row["deviation_deg"])))
                    }
                    None => "–".to_owned(),
                }
            });
            let compass = heading(15.0 * index as f64);
            row(paper, Style::plain(SIZE), &compass, cells.collect());
        }
    }
}

fn foot(paper: &mut Paper, record: &Value) {
    let adjuster = &record["adjuster"];
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
    paper.fact(
        "Log",
        &format!(
            "{} entries before this record, the last with SHA-256 {}",
            record["log"]["entries"],
            word(&record["log"]["last_sha256"])
        ),
    );
}
