//! Reasons that an alert gives for clearing itself.

/// The cause is over.
pub(super) const OVER: &str = "it is over";
/// No model is left that could tell.
pub(super) const NOT_KNOWN: &str =
    "there is no model any more that could tell whether it still is so: it is not known to be over";
/// The detector has taken the change back.
pub(super) const WITHDRAWN: &str =
    "it is withdrawn: the samples since do not bear out that anything changed";
/// The model includes the change by now.
pub(super) const LEARNED: &str = "the model has learnt it: the deviation stays as it is now, and \
                                  no card from before it holds";
/// The detector holds another cause to be the likeliest.
pub(super) const RENAMED: &str =
    "something else is held to be its cause now, and has an alert of its own";
/// The vessel went out of service.
pub(super) const OUT_OF_SERVICE: &str = "the vessel is out of service";
/// A second event of the same cause has an alert of its own.
pub(super) const FOLLOWED: &str = "another of its cause followed";
/// An adjustment made the alert void.
pub(super) const ADJUSTED: &str = "the compass has been adjusted since: the card that was foretold \
                                   then holds until headings at sea verify it, or speak against it";
/// The agent can no longer judge.
pub(super) const NOT_JUDGED: &str = "the card by which it was judged is not in force any more: it \
                                     is not known to be over";
