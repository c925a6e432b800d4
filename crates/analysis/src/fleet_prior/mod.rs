//! Prior knowledge of a vessel's magnetism from its sister ships, or from its operator's
//! whole fleet.
//!
//! A hierarchical normal model over the vessels of a class: each vessel's seven ratios are
//! drawn about the class's mean with the class's spread, and its own headings showed them
//! with its model's covariance. Mean and spread of each ratio follow from the vessels, so
//! that the data decide how much a class says of it: correctors and builder's magnetism
//! differ between sisters, soft iron less. The equations are in docs/science.md, §13.
//!
//! Invariants:
//! - a prior for a vessel that is in the class itself is made of the others alone, to the
//!   byte as though it had never been there;
//! - the order of the vessels changes nothing, nor does writing and reading as JSON;
//! - the population remains a hypothesis in every prior, for a vessel unlike its sisters;
//! - one other vessel is no fleet: the class is refused by name, and the population's prior
//!   remains.

mod class_fit;
mod error;
mod evidence;
mod ship_prior;

pub use error::FleetPriorError;
pub use evidence::ShipEvidence;
pub use ship_prior::{Basis, PriorComponent, ShipPrior, ShipUsed};

use binnacle_compass::ship::PARAMETERS;
use binnacle_compass::time::Timestamp;
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

/// Version of the method. Another one makes other priors from the same vessels.
pub const METHOD: u32 = 1;

/// Fewest vessels, besides the one that the prior is for, that show a spread.
pub const FEWEST_SHIPS: usize = 2;

type Vector = SVector<f64, PARAMETERS>;
type Matrix = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// Vessels that inform each other's priors.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(tag = "kind", content = "name", rename_all = "snake_case")]
pub enum Class {
    /// Sister ships, under the name that the operator gave the class.
    Sisters(String),
    /// All vessels of an operator, by the operator's id.
    Operator(String),
}

impl std::fmt::Display for Class {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Class::Sisters(name) => write!(f, "sister class {name:?}"),
            Class::Operator(name) => write!(f, "fleet of operator {name:?}"),
        }
    }
}

/// Published artefact: the evidence of a class's vessels at one time. Each vessel's prior
/// follows from it and from nothing else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct FleetPrior {
    method: u32,
    made_at: Timestamp,
    class: Class,
    ships: Vec<ShipEvidence>,
}

/// Fields of a [`FleetPrior`] as read, before its laws are checked.
#[derive(Deserialize)]
struct Unchecked {
    method: u32,
    made_at: Timestamp,
    class: Class,
    ships: Vec<ShipEvidence>,
}

impl TryFrom<Unchecked> for FleetPrior {
    type Error = FleetPriorError;

    fn try_from(read: Unchecked) -> Result<FleetPrior, FleetPriorError> {
        if read.method != METHOD {
            return Err(FleetPriorError::OtherMethod {
                method: read.method,
            });
        }
        FleetPrior::new(read.class, read.ships, read.made_at)
    }
}

impl FleetPrior {
    /// Makes the artefact of a class from its vessels, in any order.
    ///
    /// # Errors
    /// Fails when there are fewer than two vessels, or when one is given twice.
    pub fn new(
        class: Class,
        mut ships: Vec<ShipEvidence>,
        made_at: Timestamp,
    ) -> Result<FleetPrior, FleetPriorError> {
        ships.sort_by(|a, b| a.vessel().cmp(b.vessel()));
        if let Some(twice) = ships.windows(2).find(|w| w[0].vessel() == w[1].vessel()) {
            let vessel = twice[0].vessel().to_owned();
            return Err(FleetPriorError::SameShipTwice { class, vessel });
        }
        enough(&class, ships.len())?;
        Ok(FleetPrior {
            method: METHOD,
            made_at,
            class,
            ships,
        })
    }

    /// Version of the method.
    pub fn method(&self) -> u32 {
        self.method
    }

    /// Time of making.
    pub fn made_at(&self) -> Timestamp {
        self.made_at
    }

    /// Class of the vessels.
    pub fn class(&self) -> &Class {
        &self.class
    }

    /// Evidence of each vessel, in the order of their ids.
    pub fn ships(&self) -> &[ShipEvidence] {
        &self.ships
    }

    /// Returns the artefact without `vessel`.
    ///
    /// # Errors
    /// Fails when fewer than two vessels remain.
    pub fn without(&self, vessel: &str) -> Result<FleetPrior, FleetPriorError> {
        let mut others = self.clone();
        others.ships.retain(|ship| ship.vessel() != vessel);
        enough(&others.class, others.ships.len())?;
        Ok(others)
    }

    /// Returns the prior for `vessel`, made of all vessels but that one.
    ///
    /// # Errors
    /// Fails when there are fewer than two others; [`ShipPrior::population`] is then the
    /// vessel's prior.
    pub fn prior_for(&self, vessel: &str) -> Result<ShipPrior, FleetPriorError> {
        let others = self.without(vessel)?;
        let fit = class_fit::fit(&others.ships);
        let class = PriorComponent::from_population_units(fit.weight, &fit.mean, &fit.covariance);
        let at_large = PriorComponent::population(1.0 - class.weight);
        Ok(ShipPrior {
            basis: Some(others.basis()),
            components: vec![class, at_large],
        })
    }

    fn basis(&self) -> Basis {
        Basis {
            method: self.method,
            made_at: self.made_at,
            class: self.class.clone(),
            ships: self.ships.iter().map(ShipEvidence::used).collect(),
        }
    }
}

fn enough(class: &Class, ships: usize) -> Result<(), FleetPriorError> {
    if ships < FEWEST_SHIPS {
        let class = class.clone();
        return Err(FleetPriorError::TooFewShips { class, ships });
    }
    Ok(())
}
