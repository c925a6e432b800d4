//! Claims of the provider about a person: redeems the code from the browser and verifies the
//! identity token.
//!
//! Invariants: the token is signed by one of the provider's keys. A missing signature, or one
//! by a shared secret, is rejected. The token is issued to this server, for this sign-in, and
//! has not expired (OpenID Connect Core 1.0, section 3.1.3.7).

use super::attempt::Attempt;
use super::refusal::Refusal;
use crate::app::App;
use crate::config::{Oidc, Serve};
use crate::identity_provider::Discovery;
use chrono::{DateTime, Utc};
use openidconnect::core::{
    CoreAuthenticationFlow, CoreClient, CoreClientAuthMethod, CoreIdToken, CoreIdTokenClaims,
    CoreIdTokenVerifier, CoreJwsSigningAlgorithm, CoreTokenResponse, CoreUserInfoClaims,
};
use openidconnect::{
    AccessToken, AuthType, AuthorizationCode, ClaimsVerificationError, ClientId, ClientSecret,
    CsrfToken, EndpointMaybeSet, EndpointNotSet, EndpointSet, Nonce, OAuth2TokenResponse,
    PkceCodeChallenge, PkceCodeVerifier, RedirectUrl, RequestTokenError, Scope,
    SignatureVerificationError, TokenResponse,
};
use reqwest::Url;
use std::sync::Arc;
use tracing::{info, warn};

/// Path to which the provider redirects people.
const CALLBACK: &str = "/api/v1/session/provider/callback";

/// Accepted signature algorithms: those with a private key of the provider.
const SIGNATURES: [CoreJwsSigningAlgorithm; 9] = [
    CoreJwsSigningAlgorithm::RsaSsaPkcs1V15Sha256,
    CoreJwsSigningAlgorithm::RsaSsaPkcs1V15Sha384,
    CoreJwsSigningAlgorithm::RsaSsaPkcs1V15Sha512,
    CoreJwsSigningAlgorithm::RsaSsaPssSha256,
    CoreJwsSigningAlgorithm::RsaSsaPssSha384,
    CoreJwsSigningAlgorithm::RsaSsaPssSha512,
    CoreJwsSigningAlgorithm::EcdsaP256Sha256,
    CoreJwsSigningAlgorithm::EcdsaP384Sha384,
    CoreJwsSigningAlgorithm::EdDsa,
];

type Client = CoreClient<
    EndpointSet,
    EndpointNotSet,
    EndpointNotSet,
    EndpointNotSet,
    EndpointMaybeSet,
    EndpointMaybeSet,
>;

/// Person named by the provider, with the claimed e-mail address.
pub(super) struct Identity {
    pub(super) subject: String,
    email: Option<String>,
    access: AccessToken,
}

/// Returns the configured issuer; empty if no provider is set up.
pub(super) fn issuer(app: &App) -> &str {
    app.config.oidc.oidc_issuer.as_deref().unwrap_or_default()
}

/// Returns the provider's metadata.
pub(super) async fn current(app: &App) -> Result<Arc<Discovery>, Refusal> {
    Ok(app.provider.current(issuer(app), &app.clock).await?)
}

/// Returns the public address of [`CALLBACK`].
fn redirect_url(config: &Serve) -> Option<RedirectUrl> {
    let public = config.mail.public_url.as_deref()?.trim_end_matches('/');
    RedirectUrl::new(format!("{public}{CALLBACK}")).ok()
}

fn client(app: &App, found: &Discovery) -> Result<Client, Refusal> {
    let config: &Oidc = &app.config.oidc;
    let id = config.oidc_client_id.clone().unwrap_or_default();
    let secret = config.oidc_client_secret.clone().map(ClientSecret::new);
    let redirect = redirect_url(&app.config).ok_or(Refusal::Failed)?;
    let client =
        CoreClient::from_provider_metadata(found.metadata.clone(), ClientId::new(id), secret);
    let methods = found.metadata.token_endpoint_auth_methods_supported();
    let takes = |method| methods.is_none_or(|methods| methods.contains(&method));
    let auth = if takes(CoreClientAuthMethod::ClientSecretBasic) {
        AuthType::BasicAuth
    } else {
        AuthType::RequestBody
    };
    Ok(client.set_auth_type(auth).set_redirect_uri(redirect))
}

/// Returns the provider's address at which a person signs in.
pub(super) fn address(app: &App, found: &Discovery, attempt: &Attempt) -> Result<Url, Refusal> {
    let client = client(app, found)?;
    let (state, nonce) = (attempt.state(), attempt.nonce());
    let verifier = PkceCodeVerifier::new(attempt.verifier());
    let (address, _, _) = client
        .authorize_url(
            CoreAuthenticationFlow::AuthorizationCode,
            || CsrfToken::new(state),
            || Nonce::new(nonce),
        )
        .add_scope(Scope::new("email".to_owned()))
        .set_pkce_challenge(PkceCodeChallenge::from_code_verifier_sha256(&verifier))
        .url();
    Ok(address)
}

/// Redeems a code for the identity of the person.
pub(super) async fn redeem(
    app: &App,
    attempt: &Attempt,
    code: String,
) -> Result<Identity, Refusal> {
    let found = current(app).await?;
    let client = client(app, &found)?;
    let request = client
        .exchange_code(AuthorizationCode::new(code))
        .map_err(|_| Refusal::Untrusted)?
        .set_pkce_verifier(PkceCodeVerifier::new(attempt.verifier()));
    let response: Result<CoreTokenResponse, _> = request.request_async(&found.http).await;
    let tokens = response.map_err(|error| match error {
        RequestTokenError::Request(cause) => {
            let error = cause.to_string();
            warn!(
                error,
                "the sign-in provider cannot be reached to redeem a code"
            );
            Refusal::Unreachable
        }
        RequestTokenError::ServerResponse(error_response) => {
            // Only the kind of the provider's error is logged: its text may contain the request.
            info!(error = %error_response.error().as_ref(), "the sign-in provider refused a code");
            Refusal::Untrusted
        }
        RequestTokenError::Parse(..) | RequestTokenError::Other(_) => {
            warn!("the sign-in provider's response to a code cannot be read");
            Refusal::Untrusted
        }
    })?;
    let token = tokens.id_token().ok_or(Refusal::Untrusted)?;
    let access = tokens.access_token().clone();
    let nonce = Nonce::new(attempt.nonce());
    let mut read = read(app, &client, token, &nonce);
    if let Err(error) = &read
        && may_be_by_a_new_key(error)
    {
        let found = app.provider.with_new_keys(issuer(app), &app.clock).await?;
        let client = self::client(app, &found)?;
        read = self::read(app, &client, token, &nonce);
    }
    let claims = read.map_err(|error| {
        info!(reason = reason(&error), "an identity token was refused");
        Refusal::Untrusted
    })?;
    Ok(Identity {
        subject: claims.subject().to_string(),
        email: verified(&claims),
        access,
    })
}

/// Returns the e-mail address that the provider has verified.
pub(super) async fn verified_email(app: &App, identity: &Identity) -> Result<String, Refusal> {
    if let Some(email) = &identity.email {
        return Ok(email.clone());
    }
    // Some providers give the address only in a separate request (section 5.4).
    let found = current(app).await?;
    let client = client(app, &found)?;
    let subject = openidconnect::SubjectIdentifier::new(identity.subject.clone());
    let Ok(request) = client.user_info(identity.access.clone(), Some(subject)) else {
        return Err(Refusal::Unverified);
    };
    let response: Result<CoreUserInfoClaims, _> = request.request_async(&found.http).await;
    let claims = response.map_err(|_| Refusal::Unverified)?;
    let is_verified = claims.email_verified() == Some(true);
    let email = claims.email().filter(|_| is_verified);
    email
        .map(|email| email.to_string())
        .ok_or(Refusal::Unverified)
}

fn read(
    app: &App,
    client: &Client,
    token: &CoreIdToken,
    nonce: &Nonce,
) -> Result<CoreIdTokenClaims, ClaimsVerificationError> {
    let now = utc(app);
    let verifier: CoreIdTokenVerifier<'_> = client
        .id_token_verifier()
        .set_allowed_algs(SIGNATURES)
        .set_time_fn(move || now);
    token.claims(&verifier, nonce).cloned()
}

fn verified(claims: &CoreIdTokenClaims) -> Option<String> {
    let is_verified = claims.email_verified() == Some(true);
    let email = claims.email().filter(|_| is_verified)?;
    Some(email.to_string())
}

fn utc(app: &App) -> DateTime<Utc> {
    DateTime::from_timestamp_micros(app.clock.now().micros()).unwrap_or_default()
}

fn may_be_by_a_new_key(error: &ClaimsVerificationError) -> bool {
    use SignatureVerificationError::{CryptoError, NoMatchingKey};
    matches!(
        error,
        ClaimsVerificationError::SignatureVerification(NoMatchingKey | CryptoError(_))
    )
}

/// Returns the reason of a refusal, without any content of the token.
fn reason(error: &ClaimsVerificationError) -> &'static str {
    match error {
        ClaimsVerificationError::Expired(_) => "it has expired",
        ClaimsVerificationError::InvalidAudience(_) => "it is for another client",
        ClaimsVerificationError::InvalidIssuer(_) => "it is by another issuer",
        ClaimsVerificationError::InvalidNonce(_) => "it belongs to another sign-in",
        ClaimsVerificationError::SignatureVerification(_) => "its signature is not valid",
        _ => "it cannot be read",
    }
}
