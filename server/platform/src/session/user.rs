//! Users and their roles.

use crate::audit::Actor;
use crate::ids::{FirmId, OperatorId, UserId};
use crate::tenants::Tenant;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// User, as `/me` shows it.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = Me)]
pub struct User {
    /// The user's id.
    pub user_id: UserId,
    /// E-mail address used to sign in.
    pub email: String,
    /// The user's name.
    pub name: String,
    /// Role of the user.
    pub role: Role,
    /// Operator whose fleet the user sees, if any.
    #[schema(required)]
    pub operator_id: Option<OperatorId>,
    /// Name of the operator.
    #[schema(required)]
    pub operator_name: Option<String>,
    /// Firm for which the user adjusts compasses, if any.
    #[schema(required)]
    pub firm_id: Option<FirmId>,
    /// Name of the firm.
    #[schema(required)]
    pub firm_name: Option<String>,
    /// True if the user has a second factor.
    pub second_factor: bool,
    /// True if the operator requires a second factor: without one, access is refused.
    pub second_factor_required: bool,
}

impl User {
    /// Returns the user's tenant; none for a platform admin.
    pub fn tenant(&self) -> Option<Tenant> {
        let operator = self.operator_id.map(Tenant::Operator);
        operator.or(self.firm_id.map(Tenant::Firm))
    }

    /// Checks whether the user must set up a second factor before anything else.
    pub fn lacks_second_factor(&self) -> bool {
        self.second_factor_required && !self.second_factor
    }
}

impl From<&User> for Actor {
    fn from(user: &User) -> Actor {
        Actor::person(user.user_id, &user.name, user.tenant())
    }
}

/// SQL that selects the columns of a [`User`], and `more` columns.
macro_rules! user_sql {
    ($more:literal) => {
        concat!(
            "SELECT u.id AS user_id, u.email, u.name, u.role, u.operator_id,
                    o.name AS operator_name, u.firm_id, f.name AS firm_name,
                    y.confirmed_at IS NOT NULL AS second_factor,
                    COALESCE(o.second_factor_required, FALSE) AS second_factor_required",
            $more,
            " FROM users u
              LEFT JOIN operators o ON o.id = u.operator_id
              LEFT JOIN firms f ON f.id = u.firm_id
              LEFT JOIN second_factors y ON y.user_id = u.id "
        )
    };
}
pub(crate) use user_sql;

/// Role of a user.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub enum Role {
    /// Sees and changes the operator's fleet.
    Admin,
    /// Sees the operator's fleet.
    Viewer,
    /// Adjusts compasses for a firm.
    Adjuster,
    /// Manages operators and firms.
    PlatformAdmin,
}

impl Role {
    /// Checks whether the role allows changes to a fleet.
    pub fn may_change_fleet(self) -> bool {
        self == Role::Admin
    }

    /// Checks whether the role allows changes to what operators and firms share.
    pub fn may_change_shared(self) -> bool {
        matches!(self, Role::Admin | Role::Adjuster)
    }
}

/// Returns an e-mail address as it is stored and compared.
pub fn normal_email(email: &str) -> String {
    email.trim().to_lowercase()
}
