//! Digits and separators of a token, read from left to right.

/// Unread bytes of a token.
#[derive(Clone, Copy, Debug)]
pub(super) struct Digits<'a>(pub(super) &'a [u8]);

impl Digits<'_> {
    pub(super) fn is_done(self) -> bool {
        self.0.is_empty()
    }

    /// Reads one of some bytes.
    pub(super) fn one_of(&mut self, bytes: &[u8]) -> Option<u8> {
        let (&first, rest) = self.0.split_first()?;
        if !bytes.contains(&first) {
            return None;
        }
        self.0 = rest;
        Some(first)
    }

    /// Reads a number of `least` to `most` digits, and of no more.
    pub(super) fn number(&mut self, least: usize, most: usize) -> Option<u64> {
        let length = self.leading_digits();
        if !(least..=most).contains(&length) {
            return None;
        }
        self.take(length)
    }

    /// Reads the next `length` bytes as a number, whatever follows them.
    pub(super) fn take(&mut self, length: usize) -> Option<u64> {
        let (digits, rest) = self.0.split_at_checked(length)?;
        let mut number = 0_u64;
        for digit in digits {
            if !digit.is_ascii_digit() {
                return None;
            }
            number = number
                .checked_mul(10)?
                .checked_add(u64::from(digit - b'0'))?;
        }
        self.0 = rest;
        Some(number)
    }

    /// Reads decimals as microseconds; further decimals are dropped.
    pub(super) fn decimals(&mut self) -> Option<u32> {
        let length = self.leading_digits();
        if length == 0 {
            return None;
        }
        let mut micros = 0;
        for place in 0..6 {
            let digit = self.0[..length].get(place).map_or(0, |digit| digit - b'0');
            micros = micros * 10 + u32::from(digit);
        }
        self.0 = &self.0[length..];
        Some(micros)
    }

    pub(super) fn leading_digits(self) -> usize {
        self.0
            .iter()
            .take_while(|byte| byte.is_ascii_digit())
            .count()
    }
}
