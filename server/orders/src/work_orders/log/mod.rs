//! Log of an order: hash-chained entries in canonical JSON.

pub(crate) mod canonical_json;
pub(crate) mod entry;
pub(crate) mod entry_list;
pub(crate) mod firm_view;
pub(crate) mod seal;
