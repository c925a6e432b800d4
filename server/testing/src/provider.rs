//! An OpenID Connect provider with real keys and tokens, whose claims the test sets.
//!
//! A code is redeemed once, with the client's secret and the verifier of the challenge that
//! the code was requested with (RFC 7636).

use crate::server::START;
use axum::extract::{Form, Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Redirect, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use binnacle_compass::time::Timestamp;
use ring::rand::SystemRandom;
use ring::rsa::PublicKeyComponents;
use ring::signature::{
    ECDSA_P256_SHA256_FIXED_SIGNING, EcdsaKeyPair, KeyPair, RSA_PKCS1_SHA256, RsaKeyPair,
};
use ring::{digest, hmac};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::process::Command;
use std::sync::{Arc, Mutex};
use tokio::net::TcpListener;
use uuid::Uuid;

const CLIENT_ID: &str = "binnacle";
/// Secret of the client at the provider.
pub const CLIENT_SECRET: &str = "the-clients-secret";

/// Signer of an ID token.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Signer {
    /// The provider's own key.
    #[default]
    Provider,
    /// Another key under the same key id.
    OtherKey,
    /// The client's secret, as an HMAC key: the client knows it too.
    ClientSecret,
    /// No signature.
    Unsigned,
}

/// A running provider.
#[derive(Clone)]
pub struct Provider {
    /// Issuer URL, which is its address.
    pub issuer: String,
    state: Arc<Mutex<ProviderState>>,
}

/// Signing key.
#[derive(Clone)]
enum Key {
    /// RS256, which every provider has (OpenID Connect Core 1.0, section 15.1).
    Rsa(Arc<RsaKeyPair>),
    /// ES256.
    Ecdsa(Arc<EcdsaKeyPair>),
}

struct ProviderState {
    key: Key,
    key_id: String,
    claims: Value,
    signer: Signer,
    user_info: Value,
    codes: HashMap<String, HashMap<String, String>>,
    secrets: Vec<String>,
}

/// Server settings for sign-in by the provider at an address.
pub fn provider_settings(issuer: &str) -> [&str; 8] {
    [
        "--oidc-issuer",
        issuer,
        "--oidc-client-id",
        CLIENT_ID,
        "--oidc-client-secret",
        CLIENT_SECRET,
        "--oidc-name",
        "Example Lines",
    ]
}

impl Key {
    fn ecdsa() -> Key {
        let random = SystemRandom::new();
        let algorithm = &ECDSA_P256_SHA256_FIXED_SIGNING;
        let key = EcdsaKeyPair::generate_pkcs8(algorithm, &random).unwrap();
        let key = EcdsaKeyPair::from_pkcs8(algorithm, key.as_ref(), &random).unwrap();
        Key::Ecdsa(Arc::new(key))
    }

    /// Generates an RSA key with openssl, because ring cannot.
    fn rsa() -> Key {
        let made = Command::new("openssl")
            .args(["genpkey", "-algorithm", "RSA", "-outform", "DER"])
            .args(["-pkeyopt", "rsa_keygen_bits:2048"])
            .output()
            .unwrap();
        assert!(made.status.success(), "{made:?}");
        // openssl writes PKCS #8 or PKCS #1, depending on its version.
        let key = RsaKeyPair::from_pkcs8(&made.stdout);
        let key = key.or_else(|_| RsaKeyPair::from_der(&made.stdout));
        Key::Rsa(Arc::new(key.unwrap()))
    }

    /// Returns another key of the same kind.
    fn another_of_same_kind(&self) -> Key {
        match self {
            Key::Rsa(_) => Key::rsa(),
            Key::Ecdsa(_) => Key::ecdsa(),
        }
    }

    fn algorithm(&self) -> &'static str {
        match self {
            Key::Rsa(_) => "RS256",
            Key::Ecdsa(_) => "ES256",
        }
    }

    fn sign(&self, message: &[u8]) -> Vec<u8> {
        let random = SystemRandom::new();
        match self {
            Key::Rsa(key) => {
                let mut signature = vec![0; key.public().modulus_len()];
                key.sign(&RSA_PKCS1_SHA256, &random, message, &mut signature)
                    .unwrap();
                signature
            }
            Key::Ecdsa(key) => key.sign(&random, message).unwrap().as_ref().to_vec(),
        }
    }

    /// Returns the public key as a JWK (RFC 7517).
    fn to_jwk(&self, key_id: &str) -> Value {
        match self {
            Key::Rsa(key) => {
                let parts = PublicKeyComponents::<Vec<u8>>::from(key.public());
                json!({
                    "kty": "RSA", "use": "sig", "alg": "RS256", "kid": key_id,
                    "n": base64url(&parts.n), "e": base64url(&parts.e),
                })
            }
            Key::Ecdsa(key) => {
                let point = key.public_key().as_ref();
                json!({
                    "kty": "EC", "crv": "P-256", "use": "sig", "alg": "ES256", "kid": key_id,
                    "x": base64url(&point[1..33]), "y": base64url(&point[33..]),
                })
            }
        }
    }
}

fn start_s() -> i64 {
    Timestamp::parse(START).unwrap().micros() / 1_000_000
}

impl Provider {
    /// Starts a provider on a free port.
    pub async fn start() -> Provider {
        Provider::start_at(0).await
    }

    /// Starts a provider on a port.
    pub async fn start_at(port: u16) -> Provider {
        let listener = TcpListener::bind(("127.0.0.1", port)).await.unwrap();
        let provider = Provider {
            issuer: format!("http://{}", listener.local_addr().unwrap()),
            state: Arc::new(Mutex::new(ProviderState {
                key: Key::ecdsa(),
                key_id: "first".to_owned(),
                claims: json!({}),
                signer: Signer::Provider,
                user_info: json!({}),
                codes: HashMap::new(),
                secrets: Vec::new(),
            })),
        };
        let routes = Router::new()
            .route("/.well-known/openid-configuration", get(configuration))
            .route("/keys", get(keys))
            .route("/authorize", get(authorize))
            .route("/token", post(token))
            .route("/userinfo", get(user_info))
            .with_state(provider.clone());
        tokio::spawn(async move { axum::serve(listener, routes).await });
        provider
    }

    /// Server settings for sign-in by this provider.
    pub fn settings(&self) -> [&str; 8] {
        provider_settings(&self.issuer)
    }

    /// Sets claims of the next tokens over the default ones; null removes a claim.
    pub fn set_claims(&self, claims: Value) {
        let mut state = self.state.lock().unwrap();
        state.claims = claims;
        state.signer = Signer::Provider;
    }

    /// Sets the signer of the next tokens.
    pub fn sign_with(&self, signer: Signer) {
        self.state.lock().unwrap().signer = signer;
    }

    /// Sets the response of the user info endpoint.
    pub fn set_user_info(&self, user_info: Value) {
        self.state.lock().unwrap().user_info = user_info;
    }

    /// Replaces the key by another one with another key id.
    pub fn rotate_key(&self) {
        let mut state = self.state.lock().unwrap();
        (state.key, state.key_id) = (state.key.another_of_same_kind(), "second".to_owned());
    }

    /// Signs with a new RSA key from now on.
    pub fn use_rsa_key(&self) {
        let mut state = self.state.lock().unwrap();
        (state.key, state.key_id) = (Key::rsa(), "rsa".to_owned());
    }

    /// Returns every code and token it issued.
    pub fn secrets(&self) -> Vec<String> {
        self.state.lock().unwrap().secrets.clone()
    }
}

async fn configuration(State(provider): State<Provider>) -> Json<Value> {
    let at = |path: &str| format!("{}{path}", provider.issuer);
    Json(json!({
        "issuer": provider.issuer,
        "authorization_endpoint": at("/authorize"),
        "token_endpoint": at("/token"),
        "userinfo_endpoint": at("/userinfo"),
        "jwks_uri": at("/keys"),
        "response_types_supported": ["code"],
        "subject_types_supported": ["public"],
        "id_token_signing_alg_values_supported": ["RS256", "ES256", "HS256", "none"],
    }))
}

async fn keys(State(provider): State<Provider>) -> Json<Value> {
    let state = provider.state.lock().unwrap();
    Json(json!({ "keys": [state.key.to_jwk(&state.key_id)] }))
}

/// Redirects back with a code at once, without a sign-in page.
async fn authorize(
    State(provider): State<Provider>,
    Query(query): Query<HashMap<String, String>>,
) -> Redirect {
    assert_eq!(query["response_type"], "code");
    assert_eq!(query["client_id"], CLIENT_ID);
    assert_eq!(query["code_challenge_method"], "S256");
    assert!(query["scope"].split(' ').any(|scope| scope == "openid"));
    let code = Uuid::new_v4().to_string();
    let back = format!(
        "{}?code={code}&state={}&session_state=1&iss=provider",
        query["redirect_uri"], query["state"]
    );
    let mut state = provider.state.lock().unwrap();
    state.secrets.push(code.clone());
    state.codes.insert(code, query);
    Redirect::to(&back)
}

async fn token(
    State(provider): State<Provider>,
    headers: HeaderMap,
    Form(sent): Form<HashMap<String, String>>,
) -> Response {
    let mut state = provider.state.lock().unwrap();
    let pair = base64url(format!("{CLIENT_ID}:{CLIENT_SECRET}").as_bytes());
    let basic = format!("Basic {}", pair.replace('-', "+").replace('_', "/"));
    let verifier = digest::digest(&digest::SHA256, sent["code_verifier"].as_bytes());
    let query = state.codes.remove(&sent["code"]);
    let query = query.filter(|query| {
        headers[header::AUTHORIZATION] == basic
            && sent["grant_type"] == "authorization_code"
            && sent["redirect_uri"] == query["redirect_uri"]
            && query["code_challenge"] == base64url(verifier.as_ref())
    });
    let Some(query) = query else {
        let refused = Json(json!({ "error": "invalid_grant" }));
        return (StatusCode::BAD_REQUEST, refused).into_response();
    };
    let mut claims = json!({
        "iss": provider.issuer, "aud": CLIENT_ID, "sub": "person-1", "nonce": query["nonce"],
        "iat": start_s(), "exp": start_s() + 3600,
        "email": "ada@example.com", "email_verified": true,
    });
    for (name, value) in state.claims.as_object().unwrap() {
        claims[name] = value.clone();
    }
    let claims = claims.as_object_mut().unwrap();
    claims.retain(|_, value| !value.is_null());
    let id_token = state.sign(&json!(claims).to_string());
    let access_token = Uuid::new_v4().to_string();
    state.secrets.push(id_token.clone());
    state.secrets.push(access_token.clone());
    Json(json!({ "access_token": access_token, "token_type": "Bearer", "id_token": id_token }))
        .into_response()
}

async fn user_info(State(provider): State<Provider>, headers: HeaderMap) -> Response {
    let state = provider.state.lock().unwrap();
    let bearer = headers[header::AUTHORIZATION].to_str().unwrap();
    let bearer = bearer.strip_prefix("Bearer ").unwrap();
    if !state.secrets.iter().any(|known| known == bearer) {
        return StatusCode::UNAUTHORIZED.into_response();
    }
    Json(state.user_info.clone()).into_response()
}

impl ProviderState {
    fn sign(&self, claims: &str) -> String {
        let algorithm = match self.signer {
            Signer::Provider | Signer::OtherKey => self.key.algorithm(),
            Signer::ClientSecret => "HS256",
            Signer::Unsigned => "none",
        };
        let head = json!({ "alg": algorithm, "kid": self.key_id, "typ": "JWT" }).to_string();
        let signed = format!(
            "{}.{}",
            base64url(head.as_bytes()),
            base64url(claims.as_bytes())
        );
        let signature = match self.signer {
            Signer::Provider => self.key.sign(signed.as_bytes()),
            Signer::OtherKey => self.key.another_of_same_kind().sign(signed.as_bytes()),
            Signer::ClientSecret => {
                let key = hmac::Key::new(hmac::HMAC_SHA256, CLIENT_SECRET.as_bytes());
                hmac::sign(&key, signed.as_bytes()).as_ref().to_vec()
            }
            Signer::Unsigned => Vec::new(),
        };
        format!("{signed}.{}", base64url(&signature))
    }
}

/// Encodes in the URL-safe alphabet without padding (RFC 4648 section 5).
fn base64url(bytes: &[u8]) -> String {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    let bits: Vec<u8> = bytes
        .iter()
        .flat_map(|byte| (0..8).rev().map(move |bit| byte >> bit & 1))
        .collect();
    bits.chunks(6)
        .map(|six| {
            let value = six.iter().fold(0, |all, bit| all << 1 | bit);
            char::from(DIGITS[usize::from(value << (6 - six.len()))])
        })
        .collect()
}
