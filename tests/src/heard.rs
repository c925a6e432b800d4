//! What an autopilot hears from the agent: its own reading of the sentences,
//! with nothing of the product's code.

use anyhow::{Context, Result, bail, ensure};
use std::net::SocketAddr;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::net::TcpStream;
use tokio::time::timeout;

/// An HDG, the THS after it, and the PBINQ that says how good they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// What the compass reads.
    pub compass_deg: f64,
    /// East positive.
    pub deviation_deg: f64,
    /// East positive.
    pub variation_deg: f64,
    /// The true heading of a THS in mode E.
    pub true_deg: f64,
    /// The version of the model, by PBINQ.
    pub model_version: u32,
    /// The deviation's standard error, degrees, by PBINQ.
    pub standard_error_deg: f64,
}

/// Listens until `count` whole corrections were heard.
///
/// # Errors
/// When they are not `within` the time, or a sentence is wrong.
pub async fn corrections(
    agent: SocketAddr,
    count: usize,
    within: Duration,
) -> Result<Vec<Correction>> {
    let mut found = Vec::new();
    let listening = async {
        let stream = TcpStream::connect(agent).await?;
        let mut lines = BufReader::new(stream).lines();
        let (mut reading, mut heading) = (None, None);
        while found.len() < count {
            let line = lines.next_line().await?.context("the agent hung up")?;
            let fields = fields_of(&line)?;
            match fields[0] {
                "IIHDG" => reading = hdg(&fields)?,
                "IITHS" => heading = ths(&fields),
                "PBINQ" => found.extend(correction(reading.take(), heading.take(), &fields)),
                _ => {}
            }
        }
        anyhow::Ok(())
    };
    match timeout(within, listening).await {
        Ok(heard) => heard.map(|()| found),
        Err(_) => bail!("heard {} of {count} corrected headings", found.len()),
    }
}

/// The fields of a sentence whose checksum is right.
fn fields_of(line: &str) -> Result<Vec<&str>> {
    let (body, sum) = line
        .strip_prefix('$')
        .and_then(|rest| rest.split_once('*'))
        .with_context(|| format!("not a sentence: {line:?}"))?;
    let computed = body.bytes().fold(0, |sum, byte| sum ^ byte);
    ensure!(sum == format!("{computed:02X}"), "wrong checksum: {line:?}");
    Ok(body.split(',').collect())
}

/// Reading, deviation, variation; `None` where one is not known.
fn hdg(fields: &[&str]) -> Result<Option<(f64, f64, f64)>> {
    ensure!(fields.len() == 6, "HDG has five fields: {fields:?}");
    if fields.iter().any(|field| field.is_empty()) {
        return Ok(None);
    }
    let deviation = east(fields[2], fields[3])?;
    let variation = east(fields[4], fields[5])?;
    Ok(Some((fields[1].parse()?, deviation, variation)))
}

fn east(degrees: &str, side: &str) -> Result<f64> {
    let degrees: f64 = degrees.parse()?;
    match side {
        "E" => Ok(degrees),
        "W" => Ok(-degrees),
        _ => bail!("neither east nor west: {side:?}"),
    }
}

/// The heading of mode E.
fn ths(fields: &[&str]) -> Option<f64> {
    let heading = fields.get(1)?.parse().ok()?;
    (fields.get(2) == Some(&"E")).then_some(heading)
}

/// All three together, when each has something to say.
fn correction(
    hdg: Option<(f64, f64, f64)>,
    ths: Option<f64>,
    pbinq: &[&str],
) -> Option<Correction> {
    let (compass_deg, deviation_deg, variation_deg) = hdg?;
    Some(Correction {
        compass_deg,
        deviation_deg,
        variation_deg,
        true_deg: ths?,
        model_version: pbinq.get(2)?.parse().ok()?,
        standard_error_deg: pbinq.get(4)?.parse().ok()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_is_read_with_its_sides() {
        let line = "$IIHDG,101.5,2.0,W,3.5,E*5A";
        assert!(fields_of("$IIHDG,101.5,2.0,W,3.5,E*00").is_err());
        let reading = hdg(&fields_of(line).unwrap()).unwrap();
        assert_eq!(reading, Some((101.5, -2.0, 3.5)));
        assert_eq!(ths(&["IITHS", "103.0", "E"]), Some(103.0));
        assert_eq!(ths(&["IITHS", "", "V"]), None);
        let quality = ["PBINQ", "A", "3", "1.0", "0.25"];
        let heard = correction(reading, Some(103.0), &quality).unwrap();
        assert_eq!((heard.model_version, heard.compass_deg), (3, 101.5));
        assert_eq!(correction(reading, None, &quality), None);
    }

    #[test]
    fn what_is_not_known_is_no_correction() {
        assert_eq!(hdg(&["IIHDG", "101.5", "", "", "3.5", "E"]).unwrap(), None);
        assert!(hdg(&["IIHDG", "101.5", "2.0", "X", "3.5", "E"]).is_err());
    }
}
