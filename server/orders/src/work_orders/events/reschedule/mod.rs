//! Events by which an agreed order gets another time.

mod time_accepted;
mod time_declined;
mod time_lapsed;
mod time_proposed;

pub(crate) use time_accepted::RetimeAccepted;
pub(crate) use time_declined::RetimeDeclined;
pub(crate) use time_lapsed::RetimeLapsed;
pub(crate) use time_proposed::RetimeProposed;
