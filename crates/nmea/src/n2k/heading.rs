//! Parameter groups that a sender of headings makes: 127250, Vessel Heading, and 127258, Magnetic
//! Variation.
//!
//! Invariant: a value that is not known is sent as not available (all ones, or the greatest of a
//! signed field), so that no receiver can read it as one.

use super::data::{ANGLE_RAD, Reference};
use super::fields::{i16_steps, u16_steps};
use super::frame::{ALL, Header, Message};
use super::identity::Address;

/// Number of the parameter group of a heading.
pub(super) const VESSEL_HEADING: u32 = 127_250;
/// Number of the parameter group of the variation.
pub(super) const MAGNETIC_VARIATION: u32 = 127_258;
/// Sequence numbers of measurements: 253 to 255 are reserved.
const SEQUENCES: u8 = 253;
/// Source of the variation: calculated from a field model; the reserved bits are set.
const AUTOMATIC_CALCULATION: u8 = 0xf3;

/// Content of 127250.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VesselHeading {
    /// Heading in degrees.
    pub deg: Option<f64>,
    /// North that it is counted from.
    pub reference: Reference,
    /// Deviation still to be applied, degrees east.
    pub deviation_deg_east: Option<f64>,
    /// Variation, degrees east.
    pub variation_deg_east: Option<f64>,
}

impl VesselHeading {
    /// Returns the message, to all. Messages of one measurement have one sequence number.
    pub fn message(&self, source: Address, sequence: u8) -> Message {
        let [h0, h1] = u16_steps(self.deg.map(circle_rad), ANGLE_RAD);
        let [d0, d1] = i16_steps(self.deviation_deg_east.map(f64::to_radians), ANGLE_RAD);
        let [v0, v1] = i16_steps(self.variation_deg_east.map(f64::to_radians), ANGLE_RAD);
        // The reserved bits are set.
        let reference = match self.reference {
            Reference::True => 0xfc,
            Reference::Magnetic => 0xfd,
        };
        let sequence = sequence % SEQUENCES;
        let data = vec![sequence, h0, h1, d0, d1, v0, v1, reference];
        to_all(2, VESSEL_HEADING, source, data)
    }
}

/// Returns 127258 with a variation in degrees east, to all.
pub fn variation_message(deg_east: Option<f64>, source: Address, sequence: u8) -> Message {
    let [v0, v1] = i16_steps(deg_east.map(f64::to_radians), ANGLE_RAD);
    // The age of the field model is not available.
    let (sequence, source_of_value) = (sequence % SEQUENCES, AUTOMATIC_CALCULATION);
    let data = vec![sequence, source_of_value, 0xff, 0xff, v0, v1, 0xff, 0xff];
    to_all(7, MAGNETIC_VARIATION, source, data)
}

/// Returns a direction in radians that is below a full circle after rounding.
fn circle_rad(deg: f64) -> f64 {
    const STEPS: f64 = std::f64::consts::TAU / ANGLE_RAD;
    let steps = (deg.rem_euclid(360.0).to_radians() / ANGLE_RAD).round();
    if steps >= STEPS {
        0.0
    } else {
        steps * ANGLE_RAD
    }
}

fn to_all(priority: u8, pgn: u32, source: Address, data: Vec<u8>) -> Message {
    let header = Header {
        priority,
        pgn,
        source: source.number(),
        destination: ALL,
    };
    Message { header, data }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::n2k::Data;

    fn source() -> Address {
        Address::new(35).unwrap()
    }

    fn near(a: Option<f64>, b: Option<f64>) -> bool {
        match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() < 0.003,
            (a, b) => a == b,
        }
    }

    #[test]
    fn a_heading_that_is_written_reads_back() {
        for reference in [Reference::True, Reference::Magnetic] {
            for (deg, deviation, variation) in [
                (0.0, Some(-3.0), Some(12.5)),
                (359.99, None, Some(-180.0)),
                (180.0, Some(0.0), Some(180.0)),
            ] {
                let heading = VesselHeading {
                    deg: Some(deg),
                    reference,
                    deviation_deg_east: deviation,
                    variation_deg_east: variation,
                };
                let Some(Data::Heading {
                    deg: read,
                    reference: of,
                    deviation_deg_east,
                    variation_deg_east,
                }) = Data::parse(&heading.message(source(), 9))
                else {
                    panic!("no heading");
                };
                assert!(near(Some(read), Some(deg)) && of == reference);
                assert!(near(deviation_deg_east, deviation));
                assert!(near(variation_deg_east, variation));
            }
        }
    }

    #[test]
    fn a_heading_has_the_bytes_that_other_programs_read() {
        let heading = VesselHeading {
            deg: Some(2.46_f64.to_degrees()),
            reference: Reference::Magnetic,
            deviation_deg_east: None,
            variation_deg_east: None,
        };
        let message = heading.message(source(), 0);
        assert_eq!(message.header.identifier(), 0x09f1_1223);
        // A message of canboatjs's tests (test/pgns/127250.js), but for its sequence number.
        assert_eq!(
            message.data[1..],
            [0x18, 0x60, 0xff, 0x7f, 0xff, 0x7f, 0xfd]
        );
        let heading = VesselHeading {
            deg: Some(1.2345_f64.to_degrees()),
            deviation_deg_east: Some(0.0),
            variation_deg_east: Some((-0.0436_f64).to_degrees()),
            ..heading
        };
        // Encoded by canboatjs 3.20.
        let bytes = [0x05, 0x39, 0x30, 0x00, 0x00, 0x4c, 0xfe, 0xfd];
        assert_eq!(heading.message(source(), 5).data, bytes);
    }

    #[test]
    fn a_variation_has_the_bytes_that_other_programs_read() {
        let message = variation_message(Some((-0.0436_f64).to_degrees()), source(), 5);
        // Encoded by canboatjs 3.20.
        let bytes = [0x05, 0xf3, 0xff, 0xff, 0x4c, 0xfe, 0xff, 0xff];
        assert_eq!(message.data, bytes);
    }

    #[test]
    fn what_is_not_known_is_sent_as_not_available() {
        let nothing = VesselHeading {
            deg: None,
            reference: Reference::Magnetic,
            deviation_deg_east: None,
            variation_deg_east: None,
        };
        let message = nothing.message(source(), 4);
        assert_eq!(message.data, [4, 0xff, 0xff, 0xff, 0x7f, 0xff, 0x7f, 0xfd]);
        assert_eq!(Data::parse(&message), None);
        let message = variation_message(None, source(), 253);
        assert_eq!(message.data, [0, 0xf3, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff]);
        assert_eq!(Data::parse(&message), None);
    }

    #[test]
    fn a_heading_never_rounds_up_to_a_full_circle() {
        for deg in [359.999_9, 360.0, 720.0, -0.000_1] {
            let heading = VesselHeading {
                deg: Some(deg),
                reference: Reference::True,
                deviation_deg_east: None,
                variation_deg_east: None,
            };
            let data = heading.message(source(), 0).data;
            let steps = u16::from_le_bytes([data[1], data[2]]);
            assert!(steps < 62_832, "{deg}: {steps}");
        }
    }

    #[test]
    fn a_variation_of_either_sign_reads_back() {
        for deg in [-24.7, 0.0, 3.21] {
            let read = Data::parse(&variation_message(Some(deg), source(), 0));
            let Some(Data::Variation { deg_east }) = read else {
                panic!("no variation");
            };
            assert!((deg_east - deg).abs() < 0.003);
        }
    }
}
