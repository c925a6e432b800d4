//! Any bytes as frames of an NMEA 2000 bus and as lines of its gateways: nothing panics, messages
//! and values stay within their bounds, and what the outputs write reads back the same.

#![no_main]

use binnacle_nmea::n2k::text::{Content, parse_line};
use binnacle_nmea::n2k::{Assembler, Data, Frame, Header, Message, split};
use binnacle_observation::n2k::N2kReader;
use binnacle_observation::signalk::DeltaCounts;
use libfuzzer_sys::fuzz_target;

/// Longest message of a fast packet.
const MOST_BYTES: usize = 223;
/// Steps of angles are 0.0001 rad.
const HALF_STEP_DEG: f64 = 0.003;

fuzz_target!(|bytes: &[u8]| {
    for line in bytes.split(|byte| *byte == b'\n') {
        match parse_line(line).map(|line| line.content) {
            Some(Content::Frame(frame)) => read(&[frame]),
            Some(Content::Message(message)) => check(&message),
            None => {}
        }
    }
    let frames: Vec<Frame> = bytes.chunks(12).filter_map(frame).collect();
    read(&frames);
});

/// Makes a frame of an identifier, of which a few bits choose a known group, and up to eight bytes.
fn frame(chunk: &[u8]) -> Option<Frame> {
    const KNOWN: [u32; 12] = [
        127_250, 127_251, 127_257, 127_258, 128_259, 129_025, 129_026, 129_029, 126_992, 126_996,
        60_928, 59_904,
    ];
    let (identifier, data) = chunk.split_first_chunk::<4>()?;
    let header = Header::from_identifier(u32::from_le_bytes(*identifier));
    assert_eq!(Header::from_identifier(header.identifier()), header);
    let known = KNOWN.get(usize::from(identifier[1] & 0x0f));
    let pgn = known.copied().unwrap_or(header.pgn);
    Frame::new(Header { pgn, ..header }, data)
}

fn read(frames: &[Frame]) {
    let mut assembler = Assembler::default();
    let mut reader = N2kReader::new("fuzz".into());
    let mut counts = DeltaCounts::default();
    for frame in frames {
        if let Some(message) = assembler.add(frame) {
            check(&message);
        }
        let mut count = 0;
        reader.frame(frame, &mut counts, |_| count += 1);
        assert!(count <= 2, "{count} observations of a message");
    }
}

fn check(message: &Message) {
    assert!(message.data.len() <= MOST_BYTES);
    let frames = split(message, 3);
    let mut assembler = Assembler::default();
    let whole = frames
        .iter()
        .filter_map(|frame| assembler.add(frame))
        .last();
    if let Some(whole) = whole {
        assert_eq!(whole.header, message.header);
        assert_eq!(whole.data, message.data);
    }
    let Some(data) = Data::parse(message) else {
        return;
    };
    let Some(written) = data.write(message.header.source, 0) else {
        return;
    };
    let again = Data::parse(&written);
    match (data, again) {
        (
            Data::Heading { deg, reference, .. },
            Some(Data::Heading {
                deg: read,
                reference: same,
                ..
            }),
        ) => {
            let off_deg = (deg - read + 540.0).rem_euclid(360.0) - 180.0;
            assert!(
                off_deg.abs() <= HALF_STEP_DEG && reference == same,
                "{deg} {read}"
            );
        }
        (Data::Variation { deg_east }, Some(Data::Variation { deg_east: read })) => {
            assert!(
                (deg_east - read).abs() <= HALF_STEP_DEG,
                "{deg_east} {read}"
            );
        }
        (data, again) => assert_eq!(Some(data), again),
    }
}
