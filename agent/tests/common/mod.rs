//! A made-up ship that talks over TCP, a made-up shore, and the real agent.

#![allow(dead_code, reason = "each test program uses its part")]

pub(crate) mod agent;
pub(crate) mod bridge;
pub(crate) mod shore;

/// Fetches a page as text.
pub(crate) async fn fetch(address: std::net::SocketAddr, path: &str) -> String {
    rustls::crypto::ring::default_provider()
        .install_default()
        .ok();
    let answer = reqwest::get(format!("http://{address}{path}")).await;
    answer.unwrap().text().await.unwrap()
}
