//! Tenants: operators with a fleet, and firms that adjust compasses.

use crate::db::Question;
use crate::ids::{FirmId, OperatorId, VesselId};
use uuid::Uuid;

/// Operator or firm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tenant {
    /// Company with a fleet.
    Operator(OperatorId),
    /// Company that adjusts compasses.
    Firm(FirmId),
}

/// Question for the owner of a vessel; `None` where there is no such vessel.
#[derive(Clone, Copy, Debug)]
pub struct OwnerOf(pub VesselId);

impl Question for OwnerOf {
    type Answer = Option<VesselOwner>;
}

/// Owner of a vessel, and the name that the owner gave to it.
#[derive(Clone, Debug, PartialEq, Eq, sqlx::FromRow)]
pub struct VesselOwner {
    /// Operator of the vessel.
    pub operator_id: OperatorId,
    /// Name of the vessel.
    pub name: String,
}

impl Tenant {
    /// Returns the operator, if the tenant is one: the value for a column of operators.
    pub fn operator(self) -> Option<OperatorId> {
        match self {
            Tenant::Operator(operator) => Some(operator),
            Tenant::Firm(_) => None,
        }
    }

    /// Returns the firm, if the tenant is one.
    pub fn firm(self) -> Option<FirmId> {
        match self {
            Tenant::Operator(_) => None,
            Tenant::Firm(firm) => Some(firm),
        }
    }

    /// Returns the id of the operator or firm.
    pub fn id(self) -> Uuid {
        match self {
            Tenant::Operator(operator) => operator.0,
            Tenant::Firm(firm) => firm.0,
        }
    }
}

impl From<OperatorId> for Tenant {
    fn from(operator: OperatorId) -> Tenant {
        Tenant::Operator(operator)
    }
}

impl From<FirmId> for Tenant {
    fn from(firm: FirmId) -> Tenant {
        Tenant::Firm(firm)
    }
}
