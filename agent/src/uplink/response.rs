//! Handling of responses and of failed requests.
//!
//! Invariants: a response for a stream that the agent has left changes nothing. A refused batch is
//! kept with the reason, and blocks nothing else; so is one whose response acknowledges batches
//! that were never sent.

use super::request_error::RequestError;
use super::{LinkState, LinkStatus, NextStep, Uplink};
use crate::spool::{Identity, SealedBatch};
use binnacle_wire::messages::{CardWithdrawn, Downlink};

impl Uplink {
    pub(super) async fn handle_success(
        &mut self,
        identity: &Identity,
        batch: Option<&SealedBatch>,
        downlink: Downlink,
    ) -> sqlx::Result<NextStep> {
        if self.has_changed_stream(identity).await? {
            return Ok(NextStep::Continue);
        }
        self.refused_token = None;
        let downlink = self.drop_unreadable_model(downlink);
        match batch {
            Some(batch) => {
                let acknowledged = self.spool.acknowledge(identity.stream, batch, &downlink);
                if let Err(refused) = acknowledged.await? {
                    let refused = RequestError::Refused(refused.to_string());
                    return self.handle_failure(identity, Some(batch), refused).await;
                }
                tracing::info!(
                    seq = batch.seq,
                    bytes = batch.bytes.len(),
                    "a batch was delivered"
                );
            }
            None => self.spool.save_downlink(&downlink).await?,
        }
        self.backoff.reset();
        let contiguous = downlink.contiguous_seq;
        self.publish_downlink(downlink);
        // Only the response to a batch is sure to come from where batches are stored.
        if batch.is_some() && self.spool.has_unfillable_gap(contiguous).await? {
            tracing::warn!(
                contiguous,
                "the server lacks batches that are no longer stored here"
            );
            return self.open_stream(identity).await;
        }
        Ok(NextStep::Continue)
    }

    pub(super) async fn handle_failure(
        &mut self,
        identity: &Identity,
        batch: Option<&SealedBatch>,
        error: RequestError,
    ) -> sqlx::Result<NextStep> {
        if self.has_changed_stream(identity).await? {
            return Ok(NextStep::Continue);
        }
        let mut problem = error.to_string();
        let (state, pause) = match (error, batch) {
            (RequestError::Forked, _) => {
                tracing::warn!("the stream has forked, opening another");
                return self.open_stream(identity).await;
            }
            (RequestError::Refused(_), Some(batch)) => {
                tracing::error!(seq = batch.seq, problem, "a batch is parked");
                self.spool.park(batch.seq, &problem).await?;
                (LinkState::Up, self.backoff.next(&mut self.rng))
            }
            (RequestError::Unauthorized(_), _) if self.has_untried_token(identity).await? => {
                tracing::warn!(problem, "trying the agent's other token");
                (LinkState::Refused, self.backoff.next(&mut self.rng))
            }
            (RequestError::NotFound(_), _) => {
                tracing::warn!(
                    problem,
                    "the server lost the stream, all retained batches are sent again"
                );
                self.spool.requeue_all().await?;
                if let NextStep::Pause(pause) = self.open_stream(identity).await? {
                    return Ok(NextStep::Pause(pause));
                }
                (LinkState::Down, self.backoff.next(&mut self.rng))
            }
            (RequestError::Unauthorized(_), _) => {
                problem = format!(
                    "the server does not know this agent any more ({problem}): enrol it again \
                     with a new code; its samples are kept"
                );
                (LinkState::Refused, self.backoff.most())
            }
            (RequestError::Refused(_), None) => (LinkState::Refused, self.backoff.most()),
            (RequestError::Busy { retry_after, .. }, _) => {
                let pause = self.backoff.next(&mut self.rng);
                (
                    LinkState::Down,
                    retry_after.map_or(pause, |requested| requested.max(pause)),
                )
            }
            (RequestError::Link(_) | RequestError::NoConnection(_), _) => {
                (LinkState::Down, self.backoff.next(&mut self.rng))
            }
        };
        tracing::warn!(problem, pause_s = pause.as_secs_f64(), "the request failed");
        self.publisher.link.send_modify(|link| {
            link.state = state;
            link.problem = Some(problem);
        });
        Ok(NextStep::Pause(pause))
    }

    /// Switches to the agent's other token, if there is one. Returns whether the server has not
    /// refused it since it last knew either.
    async fn has_untried_token(&mut self, identity: &Identity) -> sqlx::Result<bool> {
        let before = self.refused_token.replace(identity.token.clone());
        let is_second = before.is_some_and(|before| before != identity.token);
        Ok(self.spool.swap_tokens(&identity.token).await? && !is_second)
    }

    async fn open_stream(&mut self, identity: &Identity) -> sqlx::Result<NextStep> {
        match self.client.open_stream(identity).await {
            Ok(stream) => {
                self.spool.move_to_stream(stream).await?;
                Ok(NextStep::Continue)
            }
            Err(error) => {
                let pause = self.backoff.next(&mut self.rng);
                tracing::warn!(trouble = %error, pause_s = pause.as_secs_f64(), "a new stream cannot be opened");
                self.publisher.link.send_modify(|link| {
                    link.state = LinkState::Down;
                    link.problem = Some(error.to_string());
                });
                Ok(NextStep::Pause(pause))
            }
        }
    }

    /// Drops a model that this version cannot read. The current one stays valid, unless the
    /// unreadable one belongs to a vessel altered since.
    fn drop_unreadable_model(&self, mut downlink: Downlink) -> Downlink {
        let Some(unread) = downlink.unread.take() else {
            return downlink;
        };
        tracing::error!(
            version = unread.version,
            "the server sent a model that this agent cannot read: update the agent"
        );
        let model = self.publisher.model.borrow();
        let known = model.as_ref().and_then(|model| model.replaces.as_ref());
        if unread.replaces.as_ref() != known {
            downlink.card_withdrawn = downlink.card_withdrawn.or(unread.replaces);
        }
        downlink
    }

    fn publish_downlink(&self, downlink: Downlink) {
        if let Some(model) = downlink.model {
            tracing::info!(version = model.version, "a new model is in effect");
            let mut before = self.publisher.model.borrow().clone();
            let before = before.take().and_then(|model| model.replaces);
            if let Some(replaces) = model.replaces.as_ref().filter(|_| before != model.replaces) {
                tracing::warn!("{}", replaces.of_older_cards());
            }
            self.publisher.model.send_replace(Some(model));
        }
        // After the model: the previous one must not be valid again for a moment.
        let withdrawn = downlink.card_withdrawn;
        if let Some(withdrawn) = withdrawn
            .as_ref()
            .filter(|_| *self.publisher.withdrawn.borrow() != withdrawn)
        {
            tracing::warn!("{}: {}", withdrawn, CardWithdrawn::ADVICE);
        }
        self.publisher.withdrawn.send_replace(withdrawn);
        if let Some(settings) = downlink.settings {
            tracing::info!(version = settings.version, "new settings are in effect");
            self.publisher.settings.send_replace(settings);
        }
        self.publisher.link.send_replace(LinkStatus {
            state: LinkState::Up,
            problem: None,
            last_contact: Some(downlink.server_time),
        });
    }
}
