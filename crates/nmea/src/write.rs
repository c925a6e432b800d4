//! Writes one sentence, with checksum and line end.

use crate::alert;
use crate::checksum;
use crate::print;
use crate::sentence::{Data, Gga, Gll, Rmc, Sentence, Vtg, Xdr};

const KMH_A_KNOT: f64 = 1.852;

/// Appends the sentence with its checksum, CR and LF.
///
/// Directions are wrapped, numbers rounded to six decimals; callers that want a
/// shorter sentence round first. A number that is not finite becomes an empty
/// field. Only `out` may grow; nothing else is allocated.
pub fn write(sentence: &Sentence, out: &mut Vec<u8>) {
    out.push(b'$');
    let start = out.len();
    out.extend_from_slice(&sentence.talker);
    out.extend_from_slice(sentence.data.kind().name().as_bytes());
    fields(&sentence.data, out);
    let sum = checksum::compute(&out[start..]);
    checksum::append(sum, out);
    out.extend_from_slice(b"\r\n");
}

fn fields(data: &Data, out: &mut Vec<u8>) {
    match data {
        Data::Hdg(hdg) => {
            print::direction(out, hdg.reading_deg);
            print::east_west(out, hdg.deviation_deg_east);
            print::east_west(out, hdg.variation_deg_east);
        }
        Data::Hdm(hdm) => print::direction_from(out, hdm.heading_deg_magnetic, b'M'),
        Data::Hdt(hdt) => print::direction_from(out, hdt.heading_deg_true, b'T'),
        Data::Ths(ths) => print::direction_from(out, ths.heading_deg_true, ths.mode.letter()),
        Data::Vhw(vhw) => {
            print::direction_from(out, vhw.heading_deg_true, b'T');
            print::direction_from(out, vhw.heading_deg_magnetic, b'M');
            speed(out, vhw.water_speed_kn);
        }
        Data::Rot(rot) => {
            let rate = rot.rate_deg_min_starboard;
            print::number(out, rate);
            print::text(out, if rate.is_some() { b"A" } else { b"V" });
        }
        Data::Rmc(Some(rmc)) => rmc_fields(rmc, out),
        Data::Rmc(None) => {
            print::text(out, b"");
            print::text(out, b"V");
            print::empty(out, 9);
            print::text(out, b"N");
        }
        Data::Gga(Some(gga)) => gga_fields(gga, out),
        Data::Gga(None) => {
            print::empty(out, 5);
            print::text(out, b"0");
            print::empty(out, 8);
        }
        Data::Gll(Some(Gll { position, time })) => {
            print::position(out, *position);
            print::time(out, *time);
            print::text(out, b"A");
            print::text(out, b"A");
        }
        Data::Gll(None) => {
            print::empty(out, 5);
            print::text(out, b"V");
            print::text(out, b"N");
        }
        Data::Zda(zda) => {
            print::time(out, zda.time);
            print::integer(out, zda.date.map(|date| u32::from(date.day())), 2);
            print::integer(out, zda.date.map(|date| u32::from(date.month())), 2);
            print::integer(out, zda.date.map(|date| u32::from(date.year())), 4);
            print::text(out, b"00");
            print::text(out, b"00");
        }
        Data::Vtg(Some(vtg)) => vtg_fields(vtg, out),
        Data::Vtg(None) => {
            print::empty(out, 8);
            print::text(out, b"N");
        }
        Data::Xdr(xdr) => xdr_fields(xdr, out),
        Data::Mta(mta) => {
            print::number(out, mta.air_temperature_c);
            print::text(out, b"C");
        }
        Data::Hbt(hbt) => {
            print::number(out, hbt.interval_s);
            print::text(out, if hbt.normal { b"A" } else { b"V" });
            print::integer(out, hbt.sequence.map(u32::from), 1);
        }
        Data::Acn(acn) => {
            print::time(out, acn.time);
            alert::identity(acn.alert, out);
            print::text(out, &[acn.command.letter()]);
            print::text(out, b"C");
        }
    }
}

fn rmc_fields(rmc: &Rmc, out: &mut Vec<u8>) {
    print::time(out, rmc.time);
    print::text(out, b"A");
    print::position(out, rmc.position);
    print::number(out, rmc.sog_kn);
    print::direction(out, rmc.cog_deg_true);
    print::short_date(out, rmc.date);
    print::east_west(out, rmc.variation_deg_east);
    print::text(out, b"A");
}

fn gga_fields(gga: &Gga, out: &mut Vec<u8>) {
    print::time(out, gga.time);
    print::position(out, gga.position);
    print::integer(out, Some(u32::from(gga.quality)), 1);
    print::integer(out, gga.satellites.map(u32::from), 2);
    print::number(out, gga.hdop);
    print::number(out, gga.altitude_m);
    print::text(out, b"M");
    print::number(out, gga.geoid_separation_m);
    print::text(out, b"M");
    print::empty(out, 2);
}

fn vtg_fields(vtg: &Vtg, out: &mut Vec<u8>) {
    print::direction_from(out, vtg.cog_deg_true, b'T');
    print::direction_from(out, vtg.cog_deg_magnetic, b'M');
    speed(out, vtg.sog_kn);
    print::text(out, b"A");
}

/// Knots, then the same speed in kilometres an hour to one decimal.
fn speed(out: &mut Vec<u8>, knots: Option<f64>) {
    print::number(out, knots);
    print::text(out, b"N");
    let kmh = knots.map(|knots| (knots * KMH_A_KNOT * 10.0).round() / 10.0);
    print::number(out, kmh);
    print::text(out, b"K");
}

fn xdr_fields(xdr: &Xdr, out: &mut Vec<u8>) {
    if let Some(roll) = xdr.roll_deg_starboard_down {
        transducer(out, [b"A", b"D"], roll, b"ROLL");
    }
    if let Some(pitch) = xdr.pitch_deg_bow_up {
        transducer(out, [b"A", b"D"], pitch, b"PTCH");
    }
    if let Some(temperature) = xdr.air_temperature_c {
        transducer(out, [b"C", b"C"], temperature, b"TempAir");
    }
}

fn transducer(out: &mut Vec<u8>, [kind, unit]: [&[u8]; 2], value: f64, name: &[u8]) {
    print::text(out, kind);
    print::number(out, Some(value));
    print::text(out, unit);
    print::text(out, name);
}
