//! Reads one sentence.

use crate::checksum;
use crate::fields::Fields;
use crate::rejected::Rejected;
use crate::sentence::{
    Acn, AlertCommand, AlertId, Data, Gga, Gll, Hbt, Hdg, Hdm, Hdt, Kind, Mta, Rmc, Rot, Sentence,
    Ths, ThsMode, Vhw, Vtg, Xdr, Zda,
};
use crate::time::Date;

/// The longest sentence that is read, from `$` to the checksum. The standard
/// says 82, which many instruments exceed.
pub const MAX_SENTENCE_BYTES: usize = 256;

/// Usual names of a transducer in the open air; others may be in an engine.
const AIR_TEMPERATURE: [&[u8]; 4] = [b"TempAir", b"AirTemp", b"ENV_OUTAIR_T", b"ENV_OUTSIDE_T"];

/// Reads one sentence, from `$` to the checksum; white space after it is
/// ignored.
///
/// # Errors
/// The reason why the line is not used.
pub fn parse(line: &[u8]) -> Result<Sentence, Rejected> {
    let line = line.trim_ascii_end();
    let Some((start, rest)) = line.split_first() else {
        return Err(Rejected::NotASentence);
    };
    if !matches!(start, b'$' | b'!') {
        return Err(Rejected::NotASentence);
    }
    if line.len() > MAX_SENTENCE_BYTES {
        return Err(Rejected::TooLong);
    }
    let body = checksum::checked(rest)?;
    // Sentences that start with `!` are encapsulated (AIS); none is read here.
    if *start == b'!' {
        return Err(Rejected::UnknownSentence);
    }
    let (talker, kind, rest) = address(body).ok_or(Rejected::UnknownSentence)?;
    let data = data(kind, Fields::new(kind, rest))?;
    Ok(Sentence { talker, data })
}

type Address<'a> = ([u8; 2], Kind, Option<&'a [u8]>);

/// Two letters for the talker, three for the sentence, then a comma or nothing.
fn address(body: &[u8]) -> Option<Address<'_>> {
    let (&[first, second, code @ ..], rest) = body.split_first_chunk::<5>()?;
    let rest = match rest {
        [] => None,
        [b',', rest @ ..] => Some(rest),
        _ => return None,
    };
    let is_talker = |byte: u8| byte.is_ascii_uppercase() || byte.is_ascii_digit();
    if !is_talker(first) || !is_talker(second) {
        return None;
    }
    Some(([first, second], Kind::from_code(code)?, rest))
}

fn data(kind: Kind, mut fields: Fields<'_>) -> Result<Data, Rejected> {
    let fields = &mut fields;
    Ok(match kind {
        Kind::Hdg => Data::Hdg(hdg(fields)?),
        Kind::Hdm => Data::Hdm(hdm(fields)?),
        Kind::Hdt => Data::Hdt(hdt(fields)?),
        Kind::Ths => Data::Ths(ths(fields)?),
        Kind::Vhw => Data::Vhw(vhw(fields)?),
        Kind::Rot => Data::Rot(rot(fields)?),
        Kind::Rmc => Data::Rmc(rmc(fields)?),
        Kind::Gga => Data::Gga(gga(fields)?),
        Kind::Gll => Data::Gll(gll(fields)?),
        Kind::Zda => Data::Zda(zda(fields)?),
        Kind::Vtg => Data::Vtg(vtg(fields)?),
        Kind::Xdr => Data::Xdr(xdr(fields)?),
        Kind::Mta => Data::Mta(mta(fields)?),
        Kind::Hbt => Data::Hbt(hbt(fields)?),
        Kind::Acn => Data::Acn(acn(fields)?),
    })
}

fn hdg(fields: &mut Fields<'_>) -> Result<Hdg, Rejected> {
    Ok(Hdg {
        reading_deg: fields.direction("reading")?,
        deviation_deg_east: fields.east_west(),
        variation_deg_east: fields.east_west(),
    })
}

fn hdm(fields: &mut Fields<'_>) -> Result<Hdm, Rejected> {
    let heading_deg_magnetic = fields.direction("heading")?;
    fields.letter_after(heading_deg_magnetic, b'M', "reference")?;
    Ok(Hdm {
        heading_deg_magnetic,
    })
}

fn hdt(fields: &mut Fields<'_>) -> Result<Hdt, Rejected> {
    let heading_deg_true = fields.direction("heading")?;
    fields.letter_after(heading_deg_true, b'T', "reference")?;
    Ok(Hdt { heading_deg_true })
}

fn ths(fields: &mut Fields<'_>) -> Result<Ths, Rejected> {
    let heading_deg_true = fields.direction("heading")?;
    let mode = fields.letter("mode")?.and_then(ThsMode::from_letter);
    Ok(Ths {
        heading_deg_true,
        mode: mode.ok_or(fields.bad("mode"))?,
    })
}

fn vhw(fields: &mut Fields<'_>) -> Result<Vhw, Rejected> {
    let heading_deg_true = fields.direction("true heading")?;
    fields.letter_after(heading_deg_true, b'T', "true reference")?;
    let heading_deg_magnetic = fields.direction("magnetic heading")?;
    fields.letter_after(heading_deg_magnetic, b'M', "magnetic reference")?;
    let water_speed_kn = fields.number("speed")?;
    fields.letter_after(water_speed_kn, b'N', "speed unit")?;
    Ok(Vhw {
        heading_deg_true,
        heading_deg_magnetic,
        water_speed_kn,
    })
}

fn rot(fields: &mut Fields<'_>) -> Result<Rot, Rejected> {
    let rate = fields.number("rate")?;
    let valid = fields.status()?;
    Ok(Rot {
        rate_deg_min_starboard: rate.filter(|_| valid),
    })
}

fn rmc(fields: &mut Fields<'_>) -> Result<Option<Rmc>, Rejected> {
    let time = fields.time()?;
    if !fields.status()? {
        return Ok(None);
    }
    let mut rmc = Rmc {
        time,
        position: fields.position()?,
        sog_kn: fields.magnitude("speed")?,
        cog_deg_true: fields.direction("course")?,
        date: fields.short_date()?,
        variation_deg_east: None,
    };
    let (variation_deg_east, is_a_fix) = fields.variation_and_mode()?;
    rmc.variation_deg_east = variation_deg_east;
    Ok(is_a_fix.then_some(rmc))
}

fn gga(fields: &mut Fields<'_>) -> Result<Option<Gga>, Rejected> {
    let time = fields.time()?;
    let position = fields.position()?;
    // 0 is no fix; 6, 7 and 8 are dead reckoning, put in by hand, simulated.
    let quality = match fields.integer("quality", 8)? {
        Some(quality @ 1..=5) => quality as u8,
        _ => return Ok(None),
    };
    // The fix does not depend on the following, which may be in any state.
    let satellites = fields.integer("satellites", 255).ok().flatten();
    let hdop = fields.magnitude("dilution").ok().flatten();
    let altitude_m = fields.metres();
    let geoid_separation_m = fields.metres();
    Ok(Some(Gga {
        time,
        position,
        quality,
        satellites: satellites.map(|count| count as u8),
        hdop,
        altitude_m,
        geoid_separation_m,
    }))
}

fn gll(fields: &mut Fields<'_>) -> Result<Option<Gll>, Rejected> {
    let position = fields.position()?;
    let time = fields.time()?;
    let valid = fields.status()? && fields.mode_is_a_fix()?;
    Ok(valid.then_some(Gll { position, time }))
}

fn zda(fields: &mut Fields<'_>) -> Result<Zda, Rejected> {
    let time = fields.time()?;
    let day = fields.integer("day", 31)?;
    let month = fields.integer("month", 12)?;
    let year = fields.integer("year", 9999)?;
    let date = match (year, month, day) {
        (Some(year), Some(month), Some(day)) => {
            Some(Date::new(year as u16, month as u8, day as u8).ok_or(fields.bad("date"))?)
        }
        _ => None,
    };
    Ok(Zda { time, date })
}

fn vtg(fields: &mut Fields<'_>) -> Result<Option<Vtg>, Rejected> {
    let cog_deg_true = fields.direction("true course")?;
    fields.letter_after(cog_deg_true, b'T', "true reference")?;
    let cog_deg_magnetic = fields.magnetic_course();
    let sog_kn = fields.magnitude("speed")?;
    fields.letter_after(sog_kn, b'N', "speed unit")?;
    // The speed repeated in kilometres an hour.
    fields.skip(2);
    let vtg = Vtg {
        cog_deg_true,
        cog_deg_magnetic,
        sog_kn,
    };
    Ok(fields.mode_is_a_fix()?.then_some(vtg))
}

fn xdr(fields: &mut Fields<'_>) -> Result<Xdr, Rejected> {
    let mut xdr = Xdr::default();
    while !fields.is_done() {
        let (transducer, value) = (fields.text(), fields.text());
        let (unit, name) = (fields.text(), fields.text());
        let number = |field| Fields::new(Kind::Xdr, Some(value)).number(field);
        let is_one_of =
            |names: &[&[u8]]| names.iter().any(|known| name.eq_ignore_ascii_case(known));
        match (transducer, unit) {
            (b"A", b"D") if is_one_of(&[b"ROLL"]) => {
                xdr.roll_deg_starboard_down = number("roll")?;
            }
            (b"A", b"D") if is_one_of(&[b"PTCH", b"PITCH"]) => {
                xdr.pitch_deg_bow_up = number("pitch")?;
            }
            (b"C", b"C") if is_one_of(&AIR_TEMPERATURE) => {
                xdr.air_temperature_c = number("air temperature")?;
            }
            _ => {}
        }
    }
    Ok(xdr)
}

fn mta(fields: &mut Fields<'_>) -> Result<Mta, Rejected> {
    let air_temperature_c = fields.number("air temperature")?;
    fields.letter_after(air_temperature_c, b'C', "unit")?;
    Ok(Mta { air_temperature_c })
}

fn hbt(fields: &mut Fields<'_>) -> Result<Hbt, Rejected> {
    Ok(Hbt {
        interval_s: fields.magnitude("interval")?,
        normal: fields.status()?,
        sequence: fields.integer("sequence", 9)?.map(|count| count as u8),
    })
}

fn acn(fields: &mut Fields<'_>) -> Result<Acn, Rejected> {
    let time = fields.time()?;
    let manufacturer = match fields.text() {
        b"" => None,
        text => Some(mnemonic(text).ok_or(fields.bad("manufacturer"))?),
    };
    let number = fields.integer("alert identifier", 9_999_999)?;
    let alert = AlertId {
        manufacturer,
        number: number.ok_or(fields.bad("alert identifier"))?,
        instance: fields.integer("instance", 999_999)?,
    };
    let command = fields
        .letter("command")?
        .and_then(AlertCommand::from_letter);
    let command = command.ok_or(fields.bad("command"))?;
    if fields.text() != b"C" {
        return Err(fields.bad("status flag"));
    }
    Ok(Acn {
        time,
        alert,
        command,
    })
}

/// Three capital letters or digits.
fn mnemonic(text: &[u8]) -> Option<[u8; 3]> {
    let is_plain = |byte: &u8| byte.is_ascii_uppercase() || byte.is_ascii_digit();
    let mnemonic: [u8; 3] = text.try_into().ok()?;
    mnemonic.iter().all(is_plain).then_some(mnemonic)
}
