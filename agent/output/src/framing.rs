//! Framing of NMEA 0183 sentences.

/// Frames the text between `$` and `*` as a sentence.
pub fn frame_sentence(body: &str) -> Vec<u8> {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n").into_bytes()
}
