//! Ships, binnacles and berths that share no code with the planner or with its formulas.
//! Magnets are rows of small dipoles, each with a moment and a place of its own, and
//! spheres are separate. The card settles where its needles, with their induction in the
//! spheres, are at rest.

#![allow(clippy::unwrap_used)] // a study

pub(crate) mod iron;
pub(crate) mod knowledge;
pub(crate) mod random;
pub(crate) mod scene;

use binnacle_adjustment::binnacle::{
    BarSetting, Binnacle, BinnacleForm, Design, DesignForm, HeelingSetting, Inventory, Lot,
    PairSetting, Red, SHIPPED, Setting, Side, Tray, VERSION,
};
use iron::Fitted;
use random::Random;

/// The earth's field: horizontal and vertical, nT.
pub(crate) type Place = (f64, f64);

/// A true ship with its correctors.
pub(crate) struct Truth {
    pub(crate) bare_chi: [[f64; 3]; 3],
    pub(crate) bare_b_nt: [f64; 3],
    /// Error of the compass's lubber line, degrees.
    pub(crate) alignment_deg: f64,
    /// True strength and place of each corrector.
    pub(crate) fitted: Fitted,
}

/// A true ship with one setting of its correctors; everything is linear in the earth's
/// field.
pub(crate) struct Standing {
    chi: [[f64; 3]; 3],
    b_nt: [f64; 3],
    /// Field induced in the spheres by the needles, by the card's direction, nT.
    needle_nt: [[f64; 2]; 2],
    alignment_deg: f64,
}

impl Truth {
    pub(crate) fn with(&self, setting: &Setting) -> Standing {
        let b = self.fitted.field(setting, [0.0; 3]);
        let columns: [[f64; 3]; 3] = std::array::from_fn(|column| {
            let mut earth = [0.0; 3];
            earth[column] = 1e6;
            let with = self.fitted.field(setting, earth);
            std::array::from_fn(|row| (with[row] - b[row]) / 1e6)
        });
        let needles = [[1.0, 0.0], [0.0, 1.0]].map(|n| self.fitted.of_needles(setting, n));
        let plus = |row: usize| self.bare_b_nt[row] + b[row];
        Standing {
            chi: std::array::from_fn(|row| {
                std::array::from_fn(|column| self.bare_chi[row][column] + columns[column][row])
            }),
            b_nt: std::array::from_fn(plus),
            needle_nt: [0, 1].map(|row| [0, 1].map(|column| needles[column][row])),
            alignment_deg: self.alignment_deg,
        }
    }
}

impl Standing {
    /// Adds steel beside the ship, of this field in ship axes, nT.
    pub(crate) fn beside(mut self, steel_nt: [f64; 2]) -> Standing {
        self.b_nt[0] += steel_nt[0];
        self.b_nt[1] += steel_nt[1];
        self
    }

    /// Compass heading on a magnetic heading, degrees.
    pub(crate) fn compass_deg(&self, place: Place, magnetic_deg: f64) -> f64 {
        let [x, y, _] = self.field(place, magnetic_deg);
        let (mut north, mut across) = (x / x.hypot(y), y / x.hypot(y));
        // The needles turn with their induction in the spheres until they are at rest.
        for _ in 0..30 {
            let [[a, b], [c, d]] = self.needle_nt;
            let (fx, fy) = (x + a * north + b * across, y + c * north + d * across);
            (north, across) = (fx / fx.hypot(fy), fy / fx.hypot(fy));
        }
        (-across).atan2(north).to_degrees() - self.alignment_deg
    }

    /// The field at the card's place without bowl and needles, nT.
    pub(crate) fn field(&self, place: Place, magnetic_deg: f64) -> [f64; 3] {
        let (sin, cos) = magnetic_deg.to_radians().sin_cos();
        let earth = [place.0 * cos, -place.0 * sin, place.1];
        std::array::from_fn(|axis| {
            let induced: f64 = (0..3).map(|c| self.chi[axis][c] * earth[c]).sum();
            earth[axis] + induced + self.b_nt[axis]
        })
    }

    /// Deviation on a compass heading, including alignment, degrees.
    pub(crate) fn deviation_deg(&self, place: Place, compass_deg: f64) -> f64 {
        let off = |magnetic: f64| wrap(self.compass_deg(place, magnetic) - compass_deg);
        let (mut low, mut high) = (compass_deg - 60.0, compass_deg + 60.0);
        for _ in 0..40 {
            let middle = f64::midpoint(low, high);
            if off(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        wrap(f64::midpoint(low, high) - compass_deg)
    }

    /// Heeling error on north, degrees per degree of heel to starboard: the field across
    /// the ship from heel, over the mean directive force.
    pub(crate) fn heeling_error(&self, place: Place) -> f64 {
        let lambda = self.lambda();
        let across = (self.chi[1][1] - self.chi[2][2]) * place.1 - self.b_nt[2];
        across / (lambda * place.0)
    }

    /// Mean share of the earth's horizontal field that reaches the compass.
    pub(crate) fn lambda(&self) -> f64 {
        1.0 + f64::midpoint(self.chi[0][0], self.chi[1][1])
    }

    /// Seven ratios to λ, as determined by headings in a mean field.
    pub(crate) fn ratios(&self, h_nt: f64) -> [f64; 7] {
        // The needles' induction along themselves turns nothing, and the rest turns them
        // with the same force at any directive force.
        let along = f64::midpoint(self.needle_nt[0][0], self.needle_nt[1][1]);
        let whole = |row: usize, column: usize| {
            let unit = if row == column { along } else { 0.0 };
            self.chi[row][column] + (self.needle_nt[row][column] - unit) / h_nt
        };
        let lambda = 1.0 + f64::midpoint(whole(0, 0), whole(1, 1));
        [
            self.b_nt[0],
            self.chi[0][2],
            self.b_nt[1],
            self.chi[1][2],
            whole(0, 0) - whole(1, 1),
            whole(0, 1),
            whole(1, 0),
        ]
        .map(|part| part / lambda)
    }

    /// Greatest deviation on any heading, degrees.
    pub(crate) fn worst_deg(&self, place: Place) -> f64 {
        (0..72)
            .map(|i| self.deviation_deg(place, f64::from(i) * 5.0).abs())
            .fold(0.0, f64::max)
    }
}

/// Wraps degrees into (−180, 180].
pub(crate) fn wrap(degrees: f64) -> f64 {
    let turned = degrees.rem_euclid(360.0);
    if turned > 180.0 {
        turned - 360.0
    } else {
        turned
    }
}

/// A binnacle of one of the shipped designs, with random correctors.
pub(crate) fn binnacle(rng: &mut Random, which: usize) -> Binnacle {
    let design: Design = serde_json::from_str(SHIPPED[which].1).unwrap();
    let large = which == 0;
    let magnet = if large { "200 mm" } else { "95 mm" };
    let bucket = if large {
        "heeling 150 mm"
    } else {
        "heeling 80 mm"
    };
    let holes = design.fore_and_aft.holes.len() as f64;
    let mut tray = |red: [Red; 2]| Tray {
        hole: 1 + (rng.unit() * 0.6 * holes) as u16,
        magnet: magnet.to_owned(),
        count: 1 + (rng.unit() * 2.0) as u8,
        red: red[usize::from(rng.unit() < 0.5)],
    };
    let fore_and_aft = vec![tray([Red::Forward, Red::Aft])];
    let athwartship = vec![tray([Red::Starboard, Red::Port])];
    let sizes = design.quadrantal.as_ref().unwrap().sizes.clone();
    let marks = design.quadrantal.as_ref().unwrap().marks.clone();
    let quadrantal = PairSetting {
        size: sizes[rng.below(sizes.len())].name.clone(),
        mark_mm: marks[rng.below(marks.len())].mark_mm,
        slew_deg: 0.0,
    };
    let lot = |magnet: &str, count| Lot {
        magnet: magnet.to_owned(),
        count,
        tested_moment_am2: None,
        tested_sd: None,
    };
    let pieces = if large {
        vec![300.0, 150.0, 75.0, 75.0]
    } else {
        Vec::new()
    };
    let flinders = large.then(|| BarSetting {
        length_mm: [75.0, 150.0, 225.0, 300.0][rng.below(4)],
        side: Side::Forward,
        slew_deg: 0.0,
    });
    Binnacle::try_from(BinnacleForm {
        version: VERSION,
        serial: "study".to_owned(),
        inventory: Inventory {
            magnets: vec![lot(magnet, 12), lot(bucket, 1)],
            quadrantal: sizes.iter().map(|size| size.name.clone()).collect(),
            flinders_pieces_mm: pieces,
        },
        setting: Setting {
            fore_and_aft,
            athwartship,
            quadrantal: Some(quadrantal),
            flinders,
            heeling: Some(HeelingSetting {
                position: 4,
                count: 1,
                red: Red::Up,
            }),
        },
        design,
        calibration: Vec::new(),
    })
    .unwrap()
}

/// Returns the binnacle without tolerances.
pub(crate) fn without_tolerances(binnacle: Binnacle) -> Binnacle {
    let mut form: BinnacleForm = binnacle.into();
    let mut design: DesignForm = form.design.into();
    for kind in &mut design.magnets {
        kind.moment_tolerance = 0.0;
    }
    for rack in [&mut design.fore_and_aft, &mut design.athwartship] {
        rack.position_sd_mm = 0.0;
    }
    for iron in design
        .quadrantal
        .iter_mut()
        .flat_map(|iron| &mut iron.sizes)
    {
        iron.tolerance = 0.0;
    }
    if let Some(bar) = &mut design.flinders {
        bar.tolerance = 0.0;
    }
    form.design = design.try_into().unwrap();
    Binnacle::try_from(form).unwrap()
}

/// A random ship for such a binnacle.
pub(crate) fn ship(rng: &mut Random, binnacle: &Binnacle) -> Truth {
    let mut chi = [[0.0; 3]; 3];
    for row in &mut chi {
        for part in row {
            *part = 0.006 * rng.gaussian();
        }
    }
    chi[0][0] = -0.06 + 0.02 * rng.gaussian();
    chi[1][1] = -0.16 + 0.02 * rng.gaussian();
    chi[0][2] = -0.02 + 0.012 * rng.gaussian();
    let mut fitted = Fitted::new(rng, binnacle);
    let of_magnets = fitted.field(&binnacle.setting, [0.0; 3]);
    // Once correct magnets, and a ship that has changed since.
    let b = |axis: usize, rng: &mut Random| -0.8 * of_magnets[axis] + 1_500.0 * rng.gaussian();
    let bare_b_nt = [b(0, rng), b(1, rng), 2_000.0 * rng.gaussian()];
    fitted.needle_am2 = binnacle.design.needle_moment_am2 * (1.0 + 0.1 * rng.gaussian());
    Truth {
        bare_chi: chi,
        bare_b_nt,
        alignment_deg: 0.3 * rng.gaussian(),
        fitted,
    }
}
