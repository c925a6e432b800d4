//! API that reads the audit log.

mod csv;

use crate::access::Auditor;
use crate::app::App;
use crate::audit::{self, Filter, Line, Selection};
use crate::error::{Error, Problem, Result};
use crate::http::{FileContent, FileName, Json, Page, Params, file, time};
use crate::time::Time;
use axum::body::{Body, Bytes};
use axum::extract::{FromRef, State};
use axum::response::Response;
use futures_util::{StreamExt, stream};
use serde::Serialize;
use tracing::error;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

/// Lines fetched at a time for a file.
const AT_A_TIME: i64 = 1000;

/// Routes of the audit log.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_audit))
        .routes(routes!(audit_csv))
}

/// Page of the audit log.
#[derive(Serialize, ToSchema)]
struct AuditList {
    /// Lines, newest first.
    items: Vec<Line>,
    /// Value of `after` for the next page.
    #[schema(required)]
    next: Option<String>,
}

/// Read the audit log
///
/// Returns every change made or tried, the work-order data read by firms, and refused sign-ins. An
/// operator's admins see the actions of their people and agents, those of firms on their vessels'
/// orders, and what was tried with their people's accounts. A firm's people see the actions in the firm's name. Platform admins see all.
#[utoipa::path(get, path = "/audit", tag = "people", params(Filter, Page),
    responses((status = 200, body = AuditList), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem)))]
async fn list_audit(
    State(app): State<App>,
    auditor: Auditor,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<AuditList>> {
    let selection = read_selection(auditor, filter)?;
    let before = page.after_id()?;
    let found = audit::list(&app.db, &selection, before, page.fetch()).await?;
    let listed = page.cut(found, |line| line.id.to_string());
    Ok(Json(AuditList {
        items: listed.items,
        next: listed.next,
    }))
}

/// Download the audit log as CSV
#[utoipa::path(get, path = "/audit.csv", tag = "people", params(Filter),
    responses((status = 200, content_type = "text/csv", body = inline(FileContent)),
              (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 422, body = Problem)))]
async fn audit_csv(
    State(app): State<App>,
    auditor: Auditor,
    Params(filter): Params<Filter>,
) -> Result<Response> {
    let selection = read_selection(auditor, filter)?;
    let head = stream::iter([Ok(Bytes::from(csv::head()))]);
    let all = Rest {
        app,
        selection,
        before: Some(Uuid::max()),
    };
    let rest = stream::try_unfold(all, next_lines);
    let body = Body::from_stream(head.chain(rest));
    Ok(file(
        "text/csv; charset=utf-8",
        &FileName::new(&["audit"], "csv"),
        body,
    ))
}

fn read_selection(auditor: Auditor, filter: Filter) -> Result<Selection> {
    // PostgreSQL accepts no NUL in a text, and no route has one.
    if filter.route.iter().any(|route| route.contains('\0')) {
        return Err(Error::Invalid {
            field: "route",
            detail: "has a control character".to_owned(),
        });
    }
    let from = time("from", filter.from.as_deref())?.map(Time);
    let to = time("to", filter.to.as_deref())?.map(Time);
    Ok(Selection {
        operator: auditor.operator(),
        firm: auditor.firm(),
        filter,
        from,
        to,
    })
}

/// Rest of a download.
struct Rest {
    app: App,
    selection: Selection,
    /// Last line so far; none after the last of all.
    before: Option<Uuid>,
}

async fn next_lines(rest: Rest) -> Result<Option<(Bytes, Rest)>> {
    let Rest {
        app,
        selection,
        before,
    } = rest;
    let Some(before) = before else {
        return Ok(None);
    };
    let lines = async {
        let found = audit::list(&app.db, &selection, Some(before), AT_A_TIME).await?;
        let next = found.last().map(|line| line.id);
        Ok((Bytes::from(csv::lines(&found)?), next))
    };
    match lines.await {
        Ok((lines, next)) => {
            let rest = Rest {
                app,
                selection,
                before: next,
            };
            Ok(Some((lines, rest)))
        }
        Err(cause) => {
            error!(
                error = format!("{cause:?}"),
                "a download of the audit log was cut off"
            );
            Err(cause)
        }
    }
}
