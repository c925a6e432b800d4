//! Time to plan an adjustment of a full binnacle: 4 magnet trays of 20 holes, 3 sizes of
//! spheres at 12 marks, 8 lengths of bar. Spheres that slew to 7 angles make seven times as
//! many choices of iron.

#![allow(missing_docs)] // divan's attribute makes public items
#![allow(clippy::unwrap_used)]

#[path = "../tests/adjusting/mod.rs"]
#[allow(dead_code)]
mod adjusting;

use adjusting::knowledge::{FLUXGATE, model, reading, waters};
use adjusting::random::Random;
use binnacle_adjustment::adjust::{Adjustment, Circumstances, Limits, plan};
use binnacle_adjustment::binnacle::{Binnacle, BinnacleForm, DesignForm};
use divan::Bencher;

fn main() {
    divan::main();
}

#[divan::bench(args = [0, 1, 2, 3], sample_count = 5, sample_size = 1)]
fn full_binnacle(bencher: Bencher<'_, '_>, seed: u64) {
    bench(bencher, seed, &[0.0]);
}

#[divan::bench(args = [0, 1, 2, 3], sample_count = 5, sample_size = 1)]
fn with_spheres_that_slew(bencher: Bencher<'_, '_>, seed: u64) {
    bench(bencher, seed, &[-30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0]);
}

fn bench(bencher: Bencher<'_, '_>, seed: u64, slews_deg: &[f64]) {
    let mut rng = Random::new(seed);
    let mut form: BinnacleForm = adjusting::binnacle(&mut rng, 0).into();
    let mut design: DesignForm = form.design.into();
    design.quadrantal.as_mut().unwrap().slews_deg = slews_deg.to_vec();
    form.design = design.try_into().unwrap();
    let binnacle = Binnacle::try_from(form).unwrap();
    let truth = adjusting::ship(&mut rng, &binnacle).with(&binnacle.setting);
    let waters = waters(&mut rng, 1.0);
    let model = model(&mut rng, &truth, &waters);
    let berth = waters[0].earth();
    let mut exact = FLUXGATE;
    // A refused berth would end the search early.
    exact.heading_sd_deg = 0.1;
    let found = reading(&mut rng, &truth, (berth.h_nt, berth.z_nt), exact);
    let adjustment = Adjustment {
        model: &model,
        earth: berth,
        reading: &found.reading,
        scale_sd: 0.003,
        compass_deg: None,
        vertical: None,
        binnacle: &binnacle,
        now: None,
        waters: &waters,
        circumstances: Circumstances::default(),
        limits: Limits {
            residual_deg: 90.0,
            band_deg: 90.0,
            ..Limits::default()
        },
    };
    assert!(plan(&adjustment).unwrap().optimality.unwrap().proven);
    bencher.bench_local(|| plan(&adjustment).unwrap());
}
