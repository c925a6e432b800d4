//! Notices: messages to the users of an operator or a firm, independent of their delivery.
//!
//! The capabilities that send notices declare their kinds.

use crate::db::DomainEvent;
use crate::ids::{UserId, VesselId};
use crate::session::Role;
use crate::tenants::Tenant;
use crate::time::Time;
use serde::Serialize;
use utoipa::ToSchema;
use uuid::Uuid;

/// Subject of a notification.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(transparent)]
#[schema(as = NotificationKind)]
pub struct Kind(&'static str);

/// Users who receive notices of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Readers {
    /// Users of operators.
    Operators,
    /// Users of firms.
    Firms,
    /// Users of operators and firms.
    OperatorsAndFirms,
    /// Admins of operators.
    Admins,
}

/// Mail about notices of a kind, unless a user chooses another way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefaultMail {
    /// Each notice by itself.
    Letter,
    /// All notices since the last digest.
    Digest,
    /// None: the operator's mail recipients get letters about the same, and a user who is one of
    /// them gets no other.
    Recipients,
}

/// Kind of notice with its readers and their mail, declared by the capability that sends it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeclaredKind {
    /// Kind of notice.
    pub kind: Kind,
    /// Users who receive it.
    pub readers: Readers,
    /// Mail about it by default.
    pub mail: DefaultMail,
}

/// Message to the users whom its kind concerns.
#[derive(Clone, Debug)]
pub struct Notice {
    /// Subject of the notice.
    pub kind: DeclaredKind,
    /// True if the notice must go out at once.
    pub urgent: bool,
    /// Subject line.
    pub subject: String,
    /// Text of a letter: one fact per line, then sentences.
    pub text: String,
    /// Page of the dashboard to link to.
    pub path: String,
    /// Vessel concerned, if it is one.
    pub vessel: Option<VesselId>,
    /// Id of what the notice is about, if that is a single thing of the vessel.
    pub about: Option<Uuid>,
}

/// Notices for a tenant's users, delivered to each as the user has chosen.
pub struct NoticesPublished {
    /// Tenant whose users are notified.
    pub tenant: Tenant,
    /// Notices to deliver.
    pub notices: Vec<Notice>,
    /// User who caused the notices and receives none.
    pub by: Option<UserId>,
    /// Time of the notices.
    pub at: Time,
}

impl DomainEvent for NoticesPublished {}

impl Kind {
    /// Returns the kind with a name, which the API shows and the database stores.
    pub const fn new(name: &'static str) -> Kind {
        Kind(name)
    }

    /// Returns the name of the kind.
    pub fn name(self) -> &'static str {
        self.0
    }
}

impl Readers {
    /// Checks whether users with this role are among them.
    pub fn include(self, role: Role) -> bool {
        match role {
            Role::Admin => self != Readers::Firms,
            Role::Viewer => matches!(self, Readers::Operators | Readers::OperatorsAndFirms),
            Role::Adjuster => matches!(self, Readers::Firms | Readers::OperatorsAndFirms),
            Role::PlatformAdmin => false,
        }
    }
}

impl DeclaredKind {
    /// Declares a kind of notice.
    pub const fn new(name: &'static str, readers: Readers, mail: DefaultMail) -> DeclaredKind {
        DeclaredKind {
            kind: Kind::new(name),
            readers,
            mail,
        }
    }

    /// Returns the name of the kind.
    pub fn name(self) -> &'static str {
        self.kind.name()
    }
}
