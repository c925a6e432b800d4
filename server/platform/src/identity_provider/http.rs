//! HTTP requests to the provider.
//!
//! Invariants: each request ends within ten seconds, and redirects are not followed. The size
//! of a response is limited. A provider on https is never asked without TLS. The server's admin
//! configured the provider, so it may be inside the local network. A provider on the public
//! internet cannot direct requests into that network.

use crate::outbound::{self, Reach, is_public};
use anyhow::{Context, bail, ensure};
use axum::http::header::AUTHORIZATION;
use openidconnect::{AsyncHttpClient, HttpRequest, HttpResponse};
use reqwest::{Client, Url};
use std::pin::Pin;

/// Longest accepted response, bytes: a hundred keys take a tenth of it.
const MAX_BYTES: usize = 1 << 20;

/// HTTP client for requests to the provider.
#[derive(Clone)]
pub(crate) struct Http {
    client: Client,
    reach: Reach,
    https_only: bool,
}

/// Reason for a missing response.
#[derive(Debug, thiserror::Error)]
#[error("{0:#}")]
pub(crate) struct NoResponse(anyhow::Error);

impl Http {
    /// Creates the client for the provider with this address.
    pub(super) async fn for_issuer(issuer: &str) -> anyhow::Result<Http> {
        let url = Url::parse(issuer).context("the issuer is not a URL")?;
        let host = url.host_str().context("the issuer has no host")?;
        let host = host.trim_start_matches('[').trim_end_matches(']');
        let mut found = tokio::net::lookup_host((host, 0)).await?;
        let reach = if found.all(|address| is_public(address.ip())) {
            Reach::Public
        } else {
            Reach::Anywhere
        };
        Ok(Http {
            client: outbound::client(reach)?,
            reach,
            https_only: url.scheme() == "https",
        })
    }

    async fn send(&self, mut request: HttpRequest) -> anyhow::Result<HttpResponse> {
        let url = outbound::check_url(&request.uri().to_string(), self.reach)?;
        ensure!(
            !self.https_only || url.scheme() == "https",
            "the provider names an address without https"
        );
        if let Some(secret) = request.headers_mut().get_mut(AUTHORIZATION) {
            secret.set_sensitive(true);
        }
        let request = reqwest::Request::try_from(request)?;
        let sent = self.client.execute(request).await;
        let mut received = sent.map_err(reqwest::Error::without_url)?;
        let mut response = axum::http::Response::builder().status(received.status());
        if let Some(headers) = response.headers_mut() {
            headers.clone_from(received.headers());
        }
        let mut body = Vec::new();
        while let Some(chunk) = received.chunk().await? {
            if body.len() + chunk.len() > MAX_BYTES {
                bail!("the response is longer than {MAX_BYTES} bytes");
            }
            body.extend_from_slice(&chunk);
        }
        Ok(response.body(body)?)
    }
}

impl<'c> AsyncHttpClient<'c> for Http {
    type Error = NoResponse;
    type Future = Pin<Box<dyn Future<Output = Result<HttpResponse, NoResponse>> + Send + 'c>>;

    fn call(&'c self, request: HttpRequest) -> Self::Future {
        Box::pin(async move { self.send(request).await.map_err(NoResponse) })
    }
}
