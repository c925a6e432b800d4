//! Fields of a message, little-endian. A value of all ones, or the greatest of a signed one, is
//! not available, and the one below it is an error.

/// Reads fields from the front of a message. A field beyond its end is not available: older
/// devices send shorter messages.
pub(super) struct Fields<'a> {
    rest: &'a [u8],
}

impl<'a> Fields<'a> {
    pub(super) fn new(data: &'a [u8]) -> Fields<'a> {
        Fields { rest: data }
    }

    pub(super) fn skip(&mut self, bytes: usize) {
        self.rest = self.rest.get(bytes..).unwrap_or_default();
    }

    /// A byte of flags; all ones without one.
    pub(super) fn flags(&mut self) -> u8 {
        self.take::<1>().map_or(0xff, |[byte]| byte)
    }

    pub(super) fn u16(&mut self) -> Option<f64> {
        let value = u16::from_le_bytes(self.take()?);
        (value < u16::MAX - 1).then(|| f64::from(value))
    }

    pub(super) fn u32(&mut self) -> Option<f64> {
        let value = u32::from_le_bytes(self.take()?);
        (value < u32::MAX - 1).then(|| f64::from(value))
    }

    pub(super) fn i16(&mut self) -> Option<f64> {
        let value = i16::from_le_bytes(self.take()?);
        (value < i16::MAX - 1).then(|| f64::from(value))
    }

    pub(super) fn i32(&mut self) -> Option<f64> {
        let value = i32::from_le_bytes(self.take()?);
        (value < i32::MAX - 1).then(|| f64::from(value))
    }

    pub(super) fn i64(&mut self) -> Option<f64> {
        let value = i64::from_le_bytes(self.take()?);
        (value < i64::MAX - 1).then_some(value as f64)
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.rest.split_first_chunk::<N>().or_else(|| {
            self.rest = &[];
            None
        })?;
        self.rest = rest;
        Some(*taken)
    }
}

/// Returns a value as an unsigned number of steps; all ones for none or one out of range.
pub(super) fn u16_steps(value: Option<f64>, step: f64) -> [u8; 2] {
    let steps = value.map(|value| (value / step).round());
    let steps = steps.filter(|steps| (0.0..f64::from(u16::MAX - 1)).contains(steps));
    steps.map_or(u16::MAX, |steps| steps as u16).to_le_bytes()
}

/// Returns a value as a signed number of steps; the greatest for none or one out of range.
pub(super) fn i16_steps(value: Option<f64>, step: f64) -> [u8; 2] {
    let steps = value.map(|value| (value / step).round());
    let range = f64::from(i16::MIN)..f64::from(i16::MAX - 1);
    let steps = steps.filter(|steps| range.contains(steps));
    steps.map_or(i16::MAX, |steps| steps as i16).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_available_or_an_error_is_none() {
        let mut fields = Fields::new(&[0xff, 0xff, 0xfe, 0xff, 0xff, 0x7f, 0xfe, 0x7f, 0x01, 0x80]);
        assert_eq!((fields.u16(), fields.u16()), (None, None));
        assert_eq!((fields.i16(), fields.i16()), (None, None));
        assert_eq!(fields.i16(), Some(-32_767.0));
        assert_eq!((fields.i32(), fields.flags()), (None, 0xff));
    }

    #[test]
    fn a_number_out_of_range_is_written_as_not_available() {
        assert_eq!(u16_steps(Some(1.0), 0.5), [2, 0]);
        assert_eq!(u16_steps(None, 0.5), [0xff, 0xff]);
        assert_eq!(u16_steps(Some(-1.0), 0.5), [0xff, 0xff]);
        assert_eq!(i16_steps(Some(-1.0), 0.5), [0xfe, 0xff]);
        assert_eq!(i16_steps(Some(1e6), 0.5), [0xff, 0x7f]);
    }
}
