//! Orders for a ship: to and fro on its route, with waiting off ports, time
//! alongside, and alterations for traffic.
//!
//! The orders change once a minute. Each is a course and a speed, which
//! [`crate::navigation::motion`] follows within a ship's limits.

use crate::navigation::rhumb;
use crate::random::Random;
use crate::scenario::{RoutePoint, ShipPlan};
use binnacle_compass::angle::wrap_360;
use binnacle_compass::position::Position;
use std::sync::Arc;

/// Distance at which a point is reached.
const ARRIVED_NM: f64 = 1.0;
/// Distance from a port at which ships slow down.
const APPROACH_NM: f64 = 5.0;
const APPROACH_KN: f64 = 8.5;
const WAITING_KN: f64 = 7.5;

/// An order of the bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    /// Steer this course at this speed.
    Steer { course_deg: f64, speed_kn: f64 },
    /// Lie alongside on this heading.
    Alongside { heading_deg: f64 },
}

#[derive(Clone, Debug)]
enum Phase {
    /// Under way to the target.
    Passage,
    /// Under way off the port until there is a berth.
    Waiting {
        left_s: f64,
        leg_s: f64,
        course_deg: f64,
    },
    /// In port.
    Alongside { left_s: f64, heading_deg: f64 },
}

#[derive(Clone, Debug)]
pub(crate) struct Passage {
    route: Arc<[RoutePoint]>,
    target: usize,
    outbound: bool,
    phase: Phase,
    waited: bool,
    speed_kn: f64,
    traffic_every_s: f64,
    next_alteration_s: f64,
    /// Degrees off the route's course, and seconds left.
    alteration: (f64, f64),
    random: Random,
}

impl Passage {
    pub(crate) fn new(plan: &ShipPlan, seed: u64) -> Passage {
        let mut random = Random::new(seed, &plan.name, "passage");
        let traffic_every_s = if plan.traffic_per_day > 0.0 {
            86_400.0 / plan.traffic_per_day
        } else {
            f64::INFINITY
        };
        let mut passage = Passage {
            route: Arc::clone(&plan.route),
            target: plan.start_point,
            outbound: plan.outbound,
            phase: Phase::Passage,
            waited: true,
            speed_kn: plan.speed_kn,
            traffic_every_s,
            next_alteration_s: random.waiting(traffic_every_s),
            alteration: (0.0, 0.0),
            random,
        };
        let stay_share = passage.random.unit();
        passage.arrive();
        if let Phase::Alongside { left_s, .. } = &mut passage.phase {
            *left_s *= stay_share;
        }
        passage
    }

    pub(crate) fn is_alongside(&self) -> bool {
        matches!(self.phase, Phase::Alongside { .. })
    }

    /// Advances by `elapsed_s` and returns the current order.
    pub(crate) fn step(&mut self, elapsed_s: f64, here: Position) -> Order {
        match &mut self.phase {
            Phase::Alongside { left_s, .. } => {
                *left_s -= elapsed_s;
                if *left_s <= 0.0 {
                    self.depart();
                }
            }
            Phase::Waiting { left_s, leg_s, .. } => {
                *left_s -= elapsed_s;
                *leg_s -= elapsed_s;
                if *left_s <= 0.0 {
                    self.waited = true;
                    self.phase = Phase::Passage;
                } else if *leg_s <= 0.0 {
                    self.turn_while_waiting(here);
                }
            }
            Phase::Passage => {
                if self.leg(here).distance_nm < ARRIVED_NM {
                    self.arrive();
                }
            }
        }
        self.alter_for_traffic(elapsed_s);
        self.order(here)
    }

    fn leg(&self, here: Position) -> rhumb::Leg {
        rhumb::leg(here, self.route[self.target].position)
    }

    fn order(&self, here: Position) -> Order {
        match self.phase {
            Phase::Alongside { heading_deg, .. } => Order::Alongside { heading_deg },
            Phase::Waiting { course_deg, .. } => Order::Steer {
                course_deg: wrap_360(course_deg + self.alteration.0),
                speed_kn: WAITING_KN,
            },
            Phase::Passage => {
                let leg = self.leg(here);
                let near = leg.distance_nm < APPROACH_NM;
                let into_port = near && self.route[self.target].port.is_some();
                Order::Steer {
                    course_deg: if near {
                        leg.course_deg
                    } else {
                        wrap_360(leg.course_deg + self.alteration.0)
                    },
                    speed_kn: if into_port {
                        APPROACH_KN
                    } else {
                        self.speed_kn
                    },
                }
            }
        }
    }

    /// At the target: waits, makes fast, or continues.
    fn arrive(&mut self) {
        let point = &self.route[self.target];
        if point.port.is_none() {
            self.go_on();
            return;
        }
        if !self.waited && point.wait_h > 0.0 {
            self.phase = Phase::Waiting {
                left_s: point.wait_h * 3600.0 * self.random.between(0.6, 1.4),
                leg_s: self.random.between(1500.0, 4500.0),
                course_deg: self.random.between(0.0, 360.0),
            };
            return;
        }
        if point.stay_h > 0.0 {
            self.phase = Phase::Alongside {
                left_s: point.stay_h * 3600.0 * self.random.between(0.7, 1.3),
                heading_deg: self.random.between(0.0, 360.0),
            };
            return;
        }
        self.depart();
    }

    fn depart(&mut self) {
        self.waited = false;
        self.phase = Phase::Passage;
        self.go_on();
    }

    fn go_on(&mut self) {
        if self.target + 1 == self.route.len() {
            self.outbound = false;
        } else if self.target == 0 {
            self.outbound = true;
        }
        self.target = if self.outbound {
            self.target + 1
        } else {
            self.target - 1
        };
    }

    /// Ships keep clear of the fairway and turn back before they are far off.
    fn turn_while_waiting(&mut self, here: Position) {
        let leg = self.leg(here);
        let within = self.route[self.target].wait_nm;
        let turn = self.random.sign() * self.random.between(50.0, 150.0);
        let back = leg.course_deg + self.random.between(-40.0, 40.0);
        let next_leg_s = self.random.between(1500.0, 4500.0);
        if let Phase::Waiting {
            leg_s, course_deg, ..
        } = &mut self.phase
        {
            *leg_s = next_leg_s;
            *course_deg = wrap_360(if leg.distance_nm > within {
                back
            } else {
                *course_deg + turn
            });
        }
    }

    fn alter_for_traffic(&mut self, elapsed_s: f64) {
        self.alteration.1 -= elapsed_s;
        if self.alteration.1 <= 0.0 {
            self.alteration = (0.0, 0.0);
        }
        self.next_alteration_s -= elapsed_s;
        if self.next_alteration_s > 0.0 {
            return;
        }
        self.next_alteration_s = self.random.waiting(self.traffic_every_s);
        // Most ships pass each other on the port side, and alter to starboard.
        let side = if self.random.unit() < 0.7 { 1.0 } else { -1.0 };
        let off_deg = side * self.random.between(8.0, 45.0);
        self.alteration = (off_deg, self.random.between(480.0, 1800.0));
    }
}
