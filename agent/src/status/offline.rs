//! Status without a running agent.

use super::{ModelStatus, Status};
use crate::alert::AlertRecord;
use crate::spool::Spool;
use crate::uplink::{LinkState, LinkStatus};
use crate::{card_invalidation, clock};

/// Returns the status that the spool alone contains.
pub(crate) async fn offline_status(spool: &Spool) -> sqlx::Result<Status> {
    let identity = spool.identity().await?;
    let last_contact = spool.last_contact().await?;
    let state = if identity.is_some() {
        LinkState::Down
    } else {
        LinkState::NotEnrolled
    };
    let model = spool.model().await?;
    let withdrawn = match (spool.card_withdrawn().await?, &model) {
        (None, Some(model)) => {
            card_invalidation::find_invalidation(model, &spool.reports().await?, clock::now())
        }
        (withdrawn, _) => withdrawn,
    };
    Ok(Status {
        agent_version: env!("CARGO_PKG_VERSION").to_owned(),
        vessel_name: identity
            .as_ref()
            .map(|identity| identity.vessel_name.clone()),
        compass_name: identity.map(|identity| identity.compass_name),
        model: model.map(|model| ModelStatus {
            version: model.version,
            data_until: model.data_until,
            age_days: None,
            withdrawn,
            replaces: model.replaces,
            reference_grade: model.model.reference_grade,
        }),
        exclusion: spool.exclusion().await?,
        link: LinkStatus {
            state,
            problem: None,
            last_contact,
        },
        spool: spool.status().await?,
        budget: spool.account().await?,
        alert: spool.alert().await?.as_ref().map(AlertRecord::status),
        ..Status::default()
    })
}
