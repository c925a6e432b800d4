//! Documents of a compass: its deviation card and its deviation book.

#![allow(
    clippy::missing_errors_doc,
    reason = "a function that asks the database errs when that does; others say more"
)]
#![allow(
    clippy::cast_possible_wrap,
    reason = "counts go into BIGINT and are far from its end"
)]

pub mod card;
pub mod deviation_book;
