//! Any bytes as messages of an NMEA 2000 bus: nothing panics, an address claim is answered by few
//! messages, and each of those comes back whole from its frames and from its gateway's text.
#![no_main]

use binnacle_nmea::n2k::text::{self, Content};
use binnacle_nmea::n2k::{
    Address, AddressClaim, Assembler, Device, Frame, Header, Message, actisense, split,
};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let device = Device {
        unique_number: 42,
        manufacturer: 2046,
        model: "Binnacle".to_owned(),
        software: "0.1.0".to_owned(),
        serial: "42".to_owned(),
    };
    let Some(address) = Address::new(35) else {
        return;
    };
    let (mut claim, _) = AddressClaim::begin(device, address);
    actisense::Decoder::of_stream().push(bytes, |_, message| answer(&mut claim, &message));
    let mut assembler = Assembler::default();
    for frame in bytes.chunks(12) {
        let Some((identifier, data)) = frame.split_first_chunk() else {
            continue;
        };
        let header = Header::from_identifier(u32::from_le_bytes(*identifier));
        let Some(frame) = Frame::new(header, data) else {
            continue;
        };
        if let Some(message) = assembler.add(&frame) {
            answer(&mut claim, &message);
        }
    }
});

fn answer(claim: &mut AddressClaim, message: &Message) {
    claim.confirm();
    let responses = claim.observe(message);
    assert!(responses.len() <= 2);
    for response in responses {
        let frames = split(&response, 3);
        let mut assembler = Assembler::default();
        let whole: Vec<Message> = frames.iter().filter_map(|f| assembler.add(f)).collect();
        assert_eq!(whole, [response]);
        for frame in frames {
            let line = format!("00:00:00.000 T {}", text::write_ydwg(&frame));
            let read = text::parse_line(line.as_bytes()).map(|line| line.content);
            assert_eq!(read, Some(Content::Frame(frame)));
        }
    }
}
