//! What follows from an answer, or from there being none.
//!
//! What always holds: an answer for a stream that the agent has left since changes
//! nothing; what the shore refuses is kept, with its reason, and keeps nothing else
//! back.

use super::shore::Trouble;
use super::{LinkState, LinkStatus, Next, Uplink};
use crate::spool::{Identity, SealedBatch};
use binnacle_wire::messages::{CardWithdrawn, Downlink};

impl Uplink {
    pub(super) async fn succeed(
        &mut self,
        identity: &Identity,
        batch: Option<&SealedBatch>,
        downlink: Downlink,
    ) -> sqlx::Result<Next> {
        if self.has_left(identity).await? {
            return Ok(Next::GoOn);
        }
        self.refused = None;
        let downlink = self.without_unread(downlink);
        match batch {
            Some(batch) => {
                self.spool
                    .acknowledge(identity.stream, batch, &downlink)
                    .await?;
                tracing::info!(
                    seq = batch.seq,
                    bytes = batch.bytes.len(),
                    "a batch is ashore"
                );
            }
            None => self.spool.keep_downlink(&downlink).await?,
        }
        self.backoff.reset();
        let contiguous = downlink.contiguous_seq;
        self.take_effect(downlink);
        // Only the answer to a batch is sure to come from where batches are kept.
        if batch.is_some() && self.spool.has_unfillable_gap(contiguous).await? {
            tracing::warn!(
                contiguous,
                "the shore lacks batches that are no longer here"
            );
            return self.open_stream(identity).await;
        }
        Ok(Next::GoOn)
    }

    pub(super) async fn fail(
        &mut self,
        identity: &Identity,
        batch: Option<&SealedBatch>,
        trouble: Trouble,
    ) -> sqlx::Result<Next> {
        if self.has_left(identity).await? {
            return Ok(Next::GoOn);
        }
        let mut problem = trouble.to_string();
        let (state, pause) = match (trouble, batch) {
            (Trouble::Forked, _) => {
                tracing::warn!("the stream has forked: opening another");
                return self.open_stream(identity).await;
            }
            (Trouble::Refused(_), Some(batch)) => {
                tracing::error!(
                    seq = batch.seq,
                    problem,
                    "the shore refuses a batch: kept aside"
                );
                self.spool.park(batch.seq, &problem).await?;
                (LinkState::Up, self.backoff.next(&mut self.rng))
            }
            (Trouble::Unknown(_), _) if self.has_untried_token(identity).await? => {
                tracing::warn!(problem, "trying the agent's other token");
                (LinkState::Refused, self.backoff.next(&mut self.rng))
            }
            (Trouble::NotFound(_), _) => {
                tracing::warn!(
                    problem,
                    "the shore lost the stream: all that is kept goes again"
                );
                self.spool.send_all_again().await?;
                if let Next::Pause(pause) = self.open_stream(identity).await? {
                    return Ok(Next::Pause(pause));
                }
                (LinkState::Down, self.backoff.next(&mut self.rng))
            }
            (Trouble::Unknown(_), _) => {
                problem = format!(
                    "the shore does not know this agent any more ({problem}): enrol it again \
                     with a new code; its samples are kept"
                );
                (LinkState::Refused, self.backoff.most())
            }
            (Trouble::Refused(_), None) => (LinkState::Refused, self.backoff.most()),
            (Trouble::Busy { retry_after, .. }, _) => {
                let pause = self.backoff.next(&mut self.rng);
                (
                    LinkState::Down,
                    retry_after.map_or(pause, |asked| asked.max(pause)),
                )
            }
            (Trouble::Link(_) | Trouble::NoConnection(_), _) => {
                (LinkState::Down, self.backoff.next(&mut self.rng))
            }
        };
        tracing::warn!(problem, pause_s = pause.as_secs_f64(), "not sent");
        self.tell.link.send_modify(|link| {
            link.state = state;
            link.problem = Some(problem);
        });
        Ok(Next::Pause(pause))
    }

    /// Goes on with the agent's other token, if there is one; whether it was not refused
    /// since the shore last knew either.
    async fn has_untried_token(&mut self, identity: &Identity) -> sqlx::Result<bool> {
        let before = self.refused.replace(identity.token.clone());
        let is_second = before.is_some_and(|before| before != identity.token);
        Ok(self.spool.swap_tokens(&identity.token).await? && !is_second)
    }

    async fn open_stream(&mut self, identity: &Identity) -> sqlx::Result<Next> {
        match self.shore.open_stream(identity).await {
            Ok(stream) => {
                self.spool.move_to_stream(stream).await?;
                Ok(Next::GoOn)
            }
            Err(trouble) => {
                let pause = self.backoff.next(&mut self.rng);
                tracing::warn!(%trouble, pause_s = pause.as_secs_f64(), "no new stream");
                self.tell.link.send_modify(|link| {
                    link.state = LinkState::Down;
                    link.problem = Some(trouble.to_string());
                });
                Ok(Next::Pause(pause))
            }
        }
    }

    /// Makes the best of a model that this version cannot read: the one on board goes
    /// on, unless that other one is of a ship altered since.
    fn without_unread(&self, mut downlink: Downlink) -> Downlink {
        let Some(unread) = downlink.unread.take() else {
            return downlink;
        };
        tracing::error!(
            version = unread.version,
            "the shore sent a model that this agent cannot read: update it"
        );
        let model = self.tell.model.borrow();
        let known = model.as_ref().and_then(|model| model.replaces.as_ref());
        if unread.replaces.as_ref() != known {
            downlink.card_withdrawn = downlink.card_withdrawn.or(unread.replaces);
        }
        downlink
    }

    fn take_effect(&self, downlink: Downlink) {
        if let Some(model) = downlink.model {
            tracing::info!(version = model.version, "a new model is in effect");
            let mut before = self.tell.model.borrow().clone();
            let before = before.take().and_then(|model| model.replaces);
            if let Some(replaces) = model.replaces.as_ref().filter(|_| before != model.replaces) {
                tracing::warn!("{}", replaces.of_older_cards());
            }
            self.tell.model.send_replace(Some(model));
        }
        // Only now: the model before must not hold again for a moment.
        let withdrawn = downlink.card_withdrawn;
        if let Some(withdrawn) = withdrawn
            .as_ref()
            .filter(|_| *self.tell.withdrawn.borrow() != withdrawn)
        {
            tracing::warn!("{withdrawn}: {}", CardWithdrawn::ADVICE);
        }
        self.tell.withdrawn.send_replace(withdrawn);
        if let Some(settings) = downlink.settings {
            tracing::info!(version = settings.version, "new settings are in effect");
            self.tell.settings.send_replace(settings);
        }
        self.tell.link.send_replace(LinkStatus {
            state: LinkState::Up,
            problem: None,
            last_contact: Some(downlink.server_time),
        });
    }
}
