//! Registry of the kinds of notices.

use binnacle_platform::http::unknown_name;
use binnacle_platform::notices::DeclaredKind;
use std::sync::Arc;

/// All kinds of notices of the server, in the order in which the API lists them.
#[derive(Clone, Debug)]
pub struct NoticeKinds(Arc<[DeclaredKind]>);

impl FromIterator<DeclaredKind> for NoticeKinds {
    fn from_iter<I: IntoIterator<Item = DeclaredKind>>(declared: I) -> NoticeKinds {
        NoticeKinds(declared.into_iter().collect())
    }
}

impl NoticeKinds {
    /// Returns all kinds.
    pub(super) fn all(&self) -> impl Iterator<Item = DeclaredKind> {
        self.0.iter().copied()
    }

    /// Returns the names of all kinds.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.all().map(DeclaredKind::name)
    }

    /// Returns the kind with a name.
    ///
    /// # Errors
    /// Fails when there is none, with the reason.
    pub(super) fn find(&self, name: &str) -> Result<DeclaredKind, String> {
        let found = self.all().find(|declared| declared.name() == name);
        found.ok_or_else(|| unknown_name(name, self.names()))
    }
}
