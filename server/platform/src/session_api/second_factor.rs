//! API to set up, confirm and remove a second factor, and to renew recovery codes.

use crate::access::Caller;
use crate::app::App;
use crate::audit::RequestContext;
use crate::db::Tx;
use crate::error::{Error, Problem, Result};
use crate::http::{Json, Valid};
use crate::ids::UserId;
use crate::second_factor::{self, totp};
use crate::secret;
use crate::session;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use percent_encoding::{NON_ALPHANUMERIC, utf8_percent_encode};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

const RECOVERY_CODES: usize = 10;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(begin_second_factor))
        .routes(routes!(confirm_second_factor))
        .routes(routes!(remove_second_factor))
        .routes(routes!(renew_recovery_codes))
}

/// Confirmation by password.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = PasswordAgain, example = json!({ "password": "seven gulls over the quay" }))]
struct PasswordConfirmation {
    /// Password that you sign in with.
    #[schema(format = Password)]
    password: String,
}

/// Secret from which an authenticator app computes codes.
#[derive(Serialize, ToSchema)]
#[schema(as = SecondFactorSecret, example = json!({
    "secret": "GEZDGNBVGY3TQOJQGEZDGNBVGY3TQOJQ",
    "uri": "otpauth://totp/Binnacle:ada%40example%2Ecom?secret=GEZDGNBVGY3TQOJQGEZDGNBVGY3TQOJQ&issuer=Binnacle"
}))]
struct NewSecret {
    /// Secret to be typed into the app, base 32. Never shown again.
    secret: String,
    /// The secret as a URI, to be shown as a QR code or opened on the phone.
    uri: String,
}

/// Code from the app.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = SecondFactorCode, example = json!({ "code": "287082" }))]
struct Code {
    /// Six digits.
    code: String,
}

/// Recovery codes for a lost phone.
#[derive(Serialize, ToSchema)]
#[schema(example = json!({ "recovery_codes": ["7QWM-0V3N-KX2D-9RTA"] }))]
struct RecoveryCodes {
    /// Codes that each work once in place of a code from the app. Never shown again.
    recovery_codes: Vec<String>,
}

/// Begin to set up a second factor
///
/// It becomes active when it is confirmed with a first code.
#[utoipa::path(post, path = "/me/second-factor", tag = "session", request_body = PasswordConfirmation,
    responses((status = 201, body = NewSecret), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem),
              (status = 409, description = "A second factor exists already", body = Problem),
              (status = 429, body = Problem)))]
async fn begin_second_factor(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    Valid(confirmation): Valid<PasswordConfirmation>,
) -> Result<(StatusCode, Json<NewSecret>)> {
    let session = caller.must_be_signed_in()?;
    session::confirm_password(&app, &request, &caller.user, session, confirmation.password).await?;
    let user = &caller.user;
    let secret: [u8; totp::SECRET_BYTES] = secret::random();
    let now = app.clock.now().into();
    if !second_factor::begin(&request, user.user_id, &secret, now).await? {
        let there = "there is a second factor; remove it before you set up another";
        return Err(Error::WrongState(there.to_owned()));
    }
    let secret = totp::base32(&secret);
    let account = utf8_percent_encode(&user.email, NON_ALPHANUMERIC);
    let uri = format!("otpauth://totp/Binnacle:{account}?secret={secret}&issuer=Binnacle");
    Ok((StatusCode::CREATED, Json(NewSecret { secret, uri })))
}

/// Confirm a second factor with its first code
///
/// All your other sessions end.
#[utoipa::path(post, path = "/me/second-factor/confirm", tag = "session", request_body = Code,
    responses((status = 200, body = RecoveryCodes), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem),
              (status = 409, description = "None is being set up, or it is already confirmed", body = Problem)))]
async fn confirm_second_factor(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    Valid(first): Valid<Code>,
) -> Result<Json<RecoveryCodes>> {
    let session = caller.must_be_signed_in()?;
    if caller.user.second_factor {
        return Err(Error::WrongState(
            "the second factor is already confirmed".to_owned(),
        ));
    }
    let user = caller.user.user_id;
    let mut tx = request.begin().await?;
    if !second_factor::confirm(&mut tx, user, &first.code, app.clock.now()).await? {
        return Err(Error::Invalid {
            field: "code",
            detail: "is not the app's current code; check the clock of the phone".to_owned(),
        });
    }
    let codes = new_recovery_codes(&mut tx, user).await?;
    session::end_all(&mut tx, user, Some(session)).await?;
    tx.commit().await?;
    Ok(Json(codes))
}

/// Remove your second factor
#[utoipa::path(post, path = "/me/second-factor/remove", tag = "session", request_body = PasswordConfirmation,
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem),
              (status = 429, body = Problem)))]
async fn remove_second_factor(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    Valid(confirmation): Valid<PasswordConfirmation>,
) -> Result<StatusCode> {
    let session = caller.must_be_signed_in()?;
    session::confirm_password(&app, &request, &caller.user, session, confirmation.password).await?;
    let mut tx = request.begin().await?;
    if !second_factor::remove(&mut tx, caller.user.user_id).await? {
        return Err(Error::NotFound("second factor"));
    }
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Make new recovery codes
///
/// The previous codes stop working.
#[utoipa::path(post, path = "/me/second-factor/recovery-codes", tag = "session",
    request_body = PasswordConfirmation,
    responses((status = 200, body = RecoveryCodes), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem), (status = 429, body = Problem)))]
async fn renew_recovery_codes(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    Valid(confirmation): Valid<PasswordConfirmation>,
) -> Result<Json<RecoveryCodes>> {
    let session = caller.must_be_signed_in()?;
    session::confirm_password(&app, &request, &caller.user, session, confirmation.password).await?;
    if !caller.user.second_factor {
        return Err(Error::NotFound("second factor"));
    }
    let mut tx = request.begin().await?;
    let codes = new_recovery_codes(&mut tx, caller.user.user_id).await?;
    tx.commit().await?;
    Ok(Json(codes))
}

async fn new_recovery_codes(tx: &mut Tx, user: UserId) -> Result<RecoveryCodes> {
    let recovery_codes: Vec<String> = (0..RECOVERY_CODES).map(|_| secret::new_code()).collect();
    second_factor::set_recovery_codes(tx, user, &recovery_codes).await?;
    Ok(RecoveryCodes { recovery_codes })
}
