//! Tenants: operators with a fleet, and firms that adjust compasses.

use crate::ids::{FirmId, OperatorId};
use uuid::Uuid;

/// An operator or a firm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tenant {
    /// A company with a fleet.
    Operator(OperatorId),
    /// A company that adjusts compasses.
    Firm(FirmId),
}

impl Tenant {
    /// The operator, if it is one: what a column of operators is compared with.
    pub fn operator(self) -> Option<OperatorId> {
        match self {
            Tenant::Operator(operator) => Some(operator),
            Tenant::Firm(_) => None,
        }
    }

    /// The firm, if it is one.
    pub fn firm(self) -> Option<FirmId> {
        match self {
            Tenant::Operator(_) => None,
            Tenant::Firm(firm) => Some(firm),
        }
    }

    /// Its id, whichever it is.
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
