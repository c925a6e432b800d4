//! Reads lines and counts the result of each: every line counts once, under its
//! kind or under the reason for its refusal.

use crate::rejected::Rejected;
use crate::sentence::Kind;
use crate::tag::{Tagged, parse_tagged};

/// Counts of sentences read by kind, and of lines refused by reason.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    read: [u64; Kind::ALL.len()],
    rejected: [u64; Rejected::REASONS.len()],
}

impl Tally {
    /// Reads a line and counts it.
    ///
    /// A sentence may start within a spoilt line: the line end before it was
    /// lost, or noise came between. That sentence is read too, and both are
    /// counted.
    pub fn read<'a>(&mut self, line: &'a [u8]) -> Option<Tagged<'a>> {
        self.read_noting(line, |_| {})
    }

    /// Reads a line like [`Tally::read`], and hands each refusal to `note` too.
    pub fn read_noting<'a>(
        &mut self,
        line: &'a [u8],
        mut note: impl FnMut(Rejected),
    ) -> Option<Tagged<'a>> {
        let mut rest = line;
        loop {
            let rejected = match parse_tagged(rest) {
                Ok(tagged) => {
                    self.read[tagged.sentence.data.kind() as usize] += 1;
                    return Some(tagged);
                }
                Err(rejected) => rejected,
            };
            self.reject(rejected);
            note(rejected);
            rest = next_start(rest)?;
        }
    }

    /// Counts a refusal.
    pub fn reject(&mut self, rejected: Rejected) {
        self.rejected[rejected.index()] += 1;
    }

    /// Adds the counts of another tally.
    pub fn add(&mut self, other: &Tally) {
        for (mine, more) in self.read.iter_mut().zip(other.read) {
            *mine += more;
        }
        for (mine, more) in self.rejected.iter_mut().zip(other.rejected) {
            *mine += more;
        }
    }

    /// Sentences read, by kind; kinds not seen are left out.
    pub fn sentences(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let counts = Kind::ALL.into_iter().zip(self.read);
        counts
            .map(|(kind, count)| (kind.name(), count))
            .filter(|(_, count)| *count > 0)
    }

    /// Lines refused, by reason; reasons not seen are left out.
    pub fn rejected(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let counts = Rejected::REASONS.into_iter().zip(self.rejected);
        counts.filter(|(_, count)| *count > 0)
    }

    /// All sentences read.
    pub fn total_read(&self) -> u64 {
        self.read.iter().sum()
    }

    /// All lines refused.
    pub fn total_rejected(&self) -> u64 {
        self.rejected.iter().sum()
    }
}

/// The rest from the next `$` on, which no field may contain.
fn next_start(line: &[u8]) -> Option<&[u8]> {
    let beyond = line.get(1..)?;
    let start = beyond.iter().position(|&byte| byte == b'$')?;
    // A refused TAG block also spoils the sentence behind it.
    if start > 0 && beyond[start - 1] == b'\\' || line[0] == b'\\' && start == 0 {
        return next_start(&beyond[start..]);
    }
    Some(&beyond[start..])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rejected(tally: &Tally) -> Vec<(&'static str, u64)> {
        tally.rejected().collect()
    }

    #[test]
    fn a_sentence_behind_noise_or_a_cut_one_is_read() {
        let mut tally = Tally::default();
        assert!(tally.read(b"\xff\x00noise$GPHDT,274.07,T*03").is_some());
        assert!(tally.read(b"$GPRMC,1234$GPHDT,274.07,T*03").is_some());
        assert_eq!(tally.sentences().collect::<Vec<_>>(), [("HDT", 2)]);
        assert_eq!(
            rejected(&tally),
            [("not a sentence", 1), ("wrong checksum", 1)]
        );
    }

    #[test]
    fn a_sentence_behind_a_bad_tag_block_is_not_read() {
        let mut tally = Tally::default();
        assert!(tally.read(b"\\s:HE0001*00\\$GPHDT,274.07,T*03").is_none());
        assert_eq!(rejected(&tally), [("bad tag block", 1)]);
    }

    #[test]
    fn a_spoilt_line_is_counted_once_for_each_start() {
        let mut tally = Tally::default();
        assert!(tally.read(b"$$$$").is_none());
        assert_eq!(tally.total_rejected(), 4);
        assert_eq!(tally.total_read(), 0);
    }
}
