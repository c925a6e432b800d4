//! The place of the content in a recorded line.

use super::LineFormat;

/// A delta's field that no other JSON of a logger has, and that of the server's
/// greeting.
const DELTA_FIELDS: [&[u8]; 3] = [b"\"updates\"", b"\"\"updates\"\"", b"\"self\""];

/// Finds the first content that can be read.
///
/// A `$` that no address follows is taken where nothing better is: the parser
/// then says why it is no sentence.
pub(super) fn find_start(line: &[u8]) -> Option<(usize, LineFormat)> {
    let mut spoilt = None;
    let mut may_be_delta = true;
    for (at, &byte) in line.iter().enumerate() {
        let rest = &line[at + 1..];
        match byte {
            b'$' | b'!' if begins_address(rest) => return Some((at, LineFormat::Sentence)),
            b'\\' if at == 0 || begins_tag_block(rest) => return Some((at, LineFormat::Sentence)),
            b'$' => spoilt = spoilt.or(Some((at, LineFormat::Sentence))),
            b'{' if may_be_delta => {
                if DELTA_FIELDS.iter().any(|field| contains(rest, field)) {
                    return Some((at, LineFormat::Delta));
                }
                // What is in no larger part is in no smaller one.
                may_be_delta = false;
            }
            _ => {}
        }
    }
    spoilt
}

/// Returns the end of a sentence, given what stands before it: behind its
/// checksum, at the quote that encloses it, or at the end of the line.
pub(super) fn sentence_end(sentence: &[u8], before: &[u8]) -> usize {
    for (at, window) in sentence.windows(3).enumerate() {
        let [b'*', high, low] = window else {
            continue;
        };
        let after = sentence.get(at + 3);
        if high.is_ascii_hexdigit()
            && low.is_ascii_hexdigit()
            && after.is_none_or(|&byte| is_separator(byte))
        {
            return at + 3;
        }
    }
    let quote = before.last().copied().filter(|&byte| is_quote(byte));
    let closing = quote.and_then(|quote| sentence.iter().position(|&byte| byte == quote));
    closing.unwrap_or(sentence.len())
}

/// Returns the end of a delta: behind the last brace.
pub(super) fn delta_end(delta: &[u8]) -> usize {
    let last = delta.iter().rposition(|&byte| byte == b'}');
    last.map_or(delta.len(), |last| last + 1)
}

/// Returns whether two capitals or digits follow, as of a talker.
fn begins_address(rest: &[u8]) -> bool {
    let is_capital = |byte: &u8| byte.is_ascii_uppercase() || byte.is_ascii_digit();
    rest.get(..2)
        .is_some_and(|talker| talker.iter().all(is_capital))
}

/// Returns whether a parameter of a TAG block follows, as `s:` or `1G2:`.
fn begins_tag_block(rest: &[u8]) -> bool {
    let is_code = |byte: &&u8| byte.is_ascii_alphanumeric();
    let length = rest.iter().take(5).take_while(is_code).count();
    length > 0 && rest.get(length) == Some(&b':')
}

fn is_separator(byte: u8) -> bool {
    is_quote(byte)
        || byte.is_ascii_whitespace()
        || matches!(byte, b',' | b';' | b'|' | b']' | b')' | b'}' | b'>')
}

fn is_quote(byte: u8) -> bool {
    matches!(byte, b'"' | b'\'')
}

fn contains(bytes: &[u8], part: &[u8]) -> bool {
    bytes.windows(part.len()).any(|window| window == part)
}
