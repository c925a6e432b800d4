//! Report of the correctors as found, which comes before every plan.

use crate::berth_session::berth_api::BERTH_STATES;
use crate::completion::complete::{write_binnacle, write_logbook};
use crate::work_orders::events::OrderEvent;
use crate::work_orders::order::Order;
use crate::work_orders::order_update::Change;
use crate::work_orders::payload::as_found::{AsFound, Difference, differences};
use crate::work_orders::store::StoredOrder;
use crate::work_orders::{load_order, prepare_update};
use axum::extract::State as Shared;
use binnacle_adjustment::binnacle::Binnacle;
use binnacle_compass::logbook::LogbookKind;
use binnacle_fleet::binnacles::{self, invalid_binnacle};
use binnacle_platform::access::PartyWriter;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid, degrees};
use binnacle_platform::idempotency::Key;
use binnacle_platform::ids::{EntryId, OrderId};

/// Report the correctors as found
///
/// Comes before the first plan, and before anything is moved: the setting of every corrector, and
/// the checks alongside. Where a setting differs from the recorded one, `difference` says why; the
/// binnacle's next revision has the setting as found.
#[utoipa::path(post, path = "/work-orders/{id}/as-found", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = AsFound,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Also after correctors were moved", body = Problem),
              (status = 422, description = "Also when it differs from the record without a reason", body = Problem)))]
pub(super) async fn report_as_found(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(found): Valid<AsFound>,
) -> Result<Json<Order>> {
    let update = prepare_update(&app, request, writer, id, key, "as found", &found)?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.tenant, id).await;
    }
    stored.require_state(
        &BERTH_STATES,
        "correctors are reported as found between going on board and the first step",
    )?;
    check_photos(&stored, &found)?;
    if let Some(mut change) = update.begin(&stored).await? {
        let recorded = lock_recorded(&mut change).await?;
        let corrected = compare(&recorded, &found)?;
        if let Some(binnacle) = &corrected {
            write_binnacle(&mut change, binnacle, "found").await?;
        }
        if corrected.is_some() && found.difference == Some(Difference::MovedSince) {
            let (kind, now) = (LogbookKind::CorrectorChange, change.now);
            write_logbook(&mut change, kind, EntryId::new(), now).await?;
        }
        change.append(OrderEvent::AsFound(Box::new(found))).await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

/// Returns the recorded binnacle, which nobody else changes before the end of the change.
async fn lock_recorded(change: &mut Change<'_>) -> Result<Binnacle> {
    let (vessel, compass) = {
        let summary = &change.stored.summary;
        (summary.vessel_id, summary.compass_id)
    };
    binnacles::lock(&mut change.tx, vessel, compass).await?;
    let recorded = binnacles::current_in(&mut change.tx, vessel, compass).await?;
    let recorded = recorded.ok_or(Error::WrongState(
        "the compass has no binnacle yet: enter it first".to_owned(),
    ))?;
    Ok(recorded.binnacle.0)
}

/// Refuses a report after correctors were moved, and photographs of another order.
fn check_photos(stored: &StoredOrder, found: &AsFound) -> Result<()> {
    let state = stored.state();
    if state.has_moved_correctors() {
        return Err(Error::WrongState(
            "correctors were moved since the reading: report them under corrector-settings"
                .to_owned(),
        ));
    }
    let is_known = |id| state.photos.iter().any(|photo| photo.id == id);
    match found.photos.iter().find(|id| !is_known(**id)) {
        Some(id) => Err(Error::Invalid {
            field: "photos",
            detail: format!("the order has no photograph {id}"),
        }),
        None => Ok(()),
    }
}

/// Field of the spheres' residual magnetism.
const TURNED: &str = "dockside.spheres_turned_deg";

/// Compares the setting with the record; returns the corrected binnacle where they differ.
fn compare(recorded: &Binnacle, found: &AsFound) -> Result<Option<Binnacle>> {
    let corrected = recorded
        .with_setting(found.setting.clone())
        .map_err(invalid_binnacle)?;
    match found.dockside.spheres_turned_deg {
        Some(turned_deg) => {
            degrees(TURNED, turned_deg, 0.0, 180.0)?;
        }
        None if found.setting.quadrantal.is_some() => {
            return Err(Error::Invalid {
                field: TURNED,
                detail: "is required: turn each sphere in its place and watch the compass"
                    .to_owned(),
            });
        }
        None => {}
    }
    if corrected.setting == recorded.setting {
        return Ok(None);
    }
    let differing = differences(&recorded.setting, &found.setting).join("; ");
    if found.difference.is_none() {
        return Err(Error::Invalid {
            field: "difference",
            detail: format!(
                "is required, because this is not the recorded setting ({differing}): look once \
                    more at each red end, and say whether the record was wrong or correctors were \
                    moved since the last headings"
            ),
        });
    }
    Ok(Some(corrected))
}
