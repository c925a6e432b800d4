//! Reasons for which an alert clears itself.

/// The cause is over.
pub(super) const OVER: &str = "it is over";
/// No model is left to evaluate it.
pub(super) const NOT_KNOWN: &str =
    "no model is left that could tell whether it still holds: it is not known to be over";
/// The detector has withdrawn the change.
pub(super) const WITHDRAWN: &str =
    "it is withdrawn: later samples do not confirm that anything changed";
/// The model includes the change by now.
pub(super) const LEARNED: &str =
    "the model includes it now: the deviation stays as it is, and no earlier card holds";
/// Another cause is the likeliest by now.
pub(super) const RENAMED: &str = "another cause is more likely now, and has an alert of its own";
/// The vessel went out of service.
pub(super) const OUT_OF_SERVICE: &str = "the vessel is out of service";
/// A second event of the same cause has an alert of its own.
pub(super) const FOLLOWED: &str = "another event of the same cause followed";
/// An adjustment made the alert void.
pub(super) const ADJUSTED: &str = "the compass has been adjusted since: the predicted card holds \
                                   until headings at sea verify or contradict it";
/// The agent can no longer evaluate it.
pub(super) const NOT_JUDGED: &str =
    "the card by which it was judged is no longer in force: it is not known to be over";
