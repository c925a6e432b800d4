//! Names of the values in the table `state`.

pub(super) const IDENTITY: &str = "identity";
pub(super) const NEXT_SEQ: &str = "next_seq";
pub(super) const CONTIGUOUS_SEQ: &str = "contiguous_seq";
pub(super) const MODEL: &str = "model";
pub(super) const WITHDRAWN: &str = "card_withdrawn";
pub(super) const SETTINGS: &str = "settings";
pub(super) const EXCLUSION: &str = "hold";
pub(super) const LAST_CONTACT: &str = "last_contact";
pub(super) const ALERT: &str = "alert";
pub(super) const HEADING_DIFFERENCE: &str = "heading_difference";
pub(super) const THINNED: &str = "thinned";
pub(super) const ACCOUNT: &str = "account";
pub(super) const CLOCK_CHECKPOINT: &str = "clocks";
pub(super) const PLACE_CHECKPOINT: &str = "place";
