//! The agent's corrected headings as an autopilot reads them, without any code
//! of the product.

use anyhow::{Context, Result, bail, ensure};
use std::net::SocketAddr;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::net::TcpStream;
use tokio::time::timeout;

/// An HDG, the THS after it, and the PBINQ with their quality.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// Compass reading.
    pub compass_deg: f64,
    /// Deviation, positive to the east.
    pub deviation_deg: f64,
    /// Variation, positive to the east.
    pub variation_deg: f64,
    /// True heading of a THS in mode E.
    pub true_deg: f64,
    /// Version of the model, from PBINQ.
    pub model_version: u32,
    /// Standard error of the deviation, degrees, from PBINQ.
    pub standard_error_deg: f64,
}

/// Listens until `count` complete corrections have arrived.
///
/// # Errors
/// Fails when they do not arrive `within` the time, or a sentence is wrong.
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
        Ok(received) => received.map(|()| found),
        Err(_) => bail!("received {} of {count} corrected headings", found.len()),
    }
}

/// Returns the fields of a sentence with a right checksum.
fn fields_of(line: &str) -> Result<Vec<&str>> {
    let (body, sum) = line
        .strip_prefix('$')
        .and_then(|rest| rest.split_once('*'))
        .with_context(|| format!("not a sentence: {line:?}"))?;
    let computed = body.bytes().fold(0, |sum, byte| sum ^ byte);
    ensure!(sum == format!("{computed:02X}"), "wrong checksum: {line:?}");
    Ok(body.split(',').collect())
}

/// Fields of an HDG sentence, degrees, east positive.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::struct_field_names, reason = "units stand in names")]
struct Hdg {
    compass_deg: f64,
    deviation_deg: f64,
    variation_deg: f64,
}

/// Returns the fields of HDG; `None` if one is unknown.
fn hdg(fields: &[&str]) -> Result<Option<Hdg>> {
    ensure!(fields.len() == 6, "HDG has five fields: {fields:?}");
    if fields.iter().any(|field| field.is_empty()) {
        return Ok(None);
    }
    let deviation_deg = east(fields[2], fields[3])?;
    let variation_deg = east(fields[4], fields[5])?;
    Ok(Some(Hdg {
        compass_deg: fields[1].parse()?,
        deviation_deg,
        variation_deg,
    }))
}

fn east(degrees: &str, side: &str) -> Result<f64> {
    let degrees: f64 = degrees.parse()?;
    match side {
        "E" => Ok(degrees),
        "W" => Ok(-degrees),
        _ => bail!("neither east nor west: {side:?}"),
    }
}

/// Returns the heading in mode E.
fn ths(fields: &[&str]) -> Option<f64> {
    let heading = fields.get(1)?.parse().ok()?;
    (fields.get(2) == Some(&"E")).then_some(heading)
}

/// Combines all three sentences, when each has its values.
fn correction(hdg: Option<Hdg>, ths: Option<f64>, pbinq: &[&str]) -> Option<Correction> {
    let hdg = hdg?;
    Some(Correction {
        compass_deg: hdg.compass_deg,
        deviation_deg: hdg.deviation_deg,
        variation_deg: hdg.variation_deg,
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
        assert_eq!(
            reading,
            Some(Hdg {
                compass_deg: 101.5,
                deviation_deg: -2.0,
                variation_deg: 3.5
            })
        );
        assert_eq!(ths(&["IITHS", "103.0", "E"]), Some(103.0));
        assert_eq!(ths(&["IITHS", "", "V"]), None);
        let quality = ["PBINQ", "A", "3", "1.0", "0.25"];
        let received = correction(reading, Some(103.0), &quality).unwrap();
        assert_eq!((received.model_version, received.compass_deg), (3, 101.5));
        assert_eq!(correction(reading, None, &quality), None);
    }

    #[test]
    fn an_unknown_value_gives_no_correction() {
        assert_eq!(hdg(&["IIHDG", "101.5", "", "", "3.5", "E"]).unwrap(), None);
        assert!(hdg(&["IIHDG", "101.5", "2.0", "X", "3.5", "E"]).is_err());
    }
}
