//! Samples from a ship's readings: one a minute, and means of ten.

use super::{Faults, Mean, gauss};
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::sample::Sample;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Minutes' readings, and the means of ten.
#[derive(Default)]
pub(super) struct Kept {
    pub(super) minutes: Vec<Sample>,
    pub(super) samples: Vec<Sample>,
    mean: Mean,
}

impl Kept {
    /// Drops an incomplete mean.
    pub(super) fn break_off(&mut self) {
        self.mean = Mean::default();
    }

    /// Adds a minute's reading, without the gyro's fault; ten of them may be wild.
    pub(super) fn take(
        &mut self,
        at: Sample,
        read: [f64; 3],
        gyro_off: f64,
        faults: &Faults,
        rng: &mut ChaCha8Rng,
    ) {
        let sample = |[compass, gyro, satellite]: [f64; 3], windows| Sample {
            compass: CompassHeading::new(compass).unwrap(),
            gyro: TrueHeading::new(gyro),
            satellite: TrueHeading::new(satellite).filter(|_| faults.satellite),
            windows,
            ..at
        };
        self.minutes
            .push(sample([read[0], read[1] + gyro_off, read[2]], at.windows));
        let Some([compass, gyro, satellite]) = self.mean.add(read) else {
            return;
        };
        let mut wild = [0.0; 2];
        for wild in &mut wild {
            if rng.random::<f64>() < faults.outliers {
                *wild = 10.0 * gauss(rng);
            }
        }
        let [gyro_wild, compass_wild] = wild;
        for minute in self.minutes.iter_mut().rev().take(10) {
            let compass = minute.compass.degrees() + compass_wild;
            minute.compass = CompassHeading::new(compass).unwrap();
            let gyro = minute.gyro.map(|gyro| gyro.degrees() + gyro_wild);
            minute.gyro = gyro.and_then(TrueHeading::new);
        }
        let gyro = gyro + gyro_off + gyro_wild;
        self.samples
            .push(sample([compass + compass_wild, gyro, satellite], 55));
    }
}
