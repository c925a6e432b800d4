//! Mailing lists of other capabilities: their words, and the addresses and files of one that keeps
//! its own.

use crate::db::{Db, Result};
use crate::ids::OperatorId;
use futures_util::future::BoxFuture;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// Function that finds the address of a recipient.
pub type FindAddress = for<'a> fn(&'a Db, Uuid) -> BoxFuture<'a, Result<Option<String>>>;

/// Function that loads the files of a letter; `None` if there are none.
pub type LoadFiles = for<'a> fn(&'a Db, &'a FileReference) -> BoxFuture<'a, Result<Option<Files>>>;

/// Words of the letters to the recipients of topics with a minimum severity, from the capability
/// that announces such topics.
#[derive(Clone, Copy, Debug)]
pub struct TopicList {
    /// Subject of the list: "your company's list for … from warning on".
    pub subject: &'static str,
    /// Content of a test letter: "This is a test: …."
    pub promise: &'static str,
}

/// Mailing list, connected when the server is put together.
#[derive(Clone, Copy, Debug)]
pub struct MailingList {
    /// Subject of the list: "your company's list for …".
    pub subject: &'static str,
    /// Dashboard page on which an administrator keeps the list.
    pub page: &'static str,
    /// Lookup of a recipient's address.
    pub find_address: FindAddress,
    /// Loader of the files that go with a letter.
    pub load_files: LoadFiles,
}

/// Reference from a letter to the files that go with it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileReference {
    /// Operator who owns the files.
    pub operator: OperatorId,
    /// Name of the files among the operator's.
    #[serde(rename = "month")]
    pub name: String,
}

/// Files of a letter, in order.
pub type Files = Vec<File>;

/// File that goes with a letter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// File name.
    pub name: String,
    /// Media type.
    pub media_type: &'static str,
    /// Content.
    pub content: Content,
}

/// Content of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Content {
    /// Text, UTF-8.
    Text(String),
    /// Bytes of any other format.
    Binary(Vec<u8>),
}
