//! Batches that must not be stored, and the server's response to each.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use anyhow::{Context, Result, ensure};
use binnacle_tests::uploader::{frame, samples};
use binnacle_tests::{Engine, ServerProcess, Uploader, eventually};
use binnacle_wire::batch::StreamId;
use reqwest::{Method, StatusCode};
use serde_json::Value;
use std::time::Duration;
use uuid::Uuid;

/// Time for an analysis of a dozen samples on a busy machine.
const TIMEOUT: Duration = Duration::from_mins(1);

/// Sends a frame and returns the status and the problem.
async fn put(
    server: &ServerProcess,
    token: Option<&str>,
    stream: StreamId,
    seq: u64,
    body: Vec<u8>,
) -> Result<(StatusCode, Value)> {
    let path = format!("/streams/{stream}/batches/{seq}");
    let request = match token {
        Some(token) => server.as_agent(Method::PUT, &path, token),
        None => server.anonymous(Method::PUT, &path),
    };
    let request = request
        .header("content-type", "application/octet-stream")
        .body(body);
    let answer = request.send().await?;
    let status = answer.status();
    let kind = answer.headers().get("content-type").cloned();
    let text = answer.text().await?;
    let body: Value = serde_json::from_str(&text).with_context(|| text.clone())?;
    if !status.is_success() {
        ensure!(
            kind.is_some_and(|k| k == "application/problem+json"),
            "{status}: {text}"
        );
        ensure!(body["status"] == status.as_u16(), "{text}");
        ensure!(
            body["title"].is_string() && body["detail"].is_string(),
            "{text}"
        );
    }
    Ok((status, body))
}

async fn assert_nothing_stored(server: &mut ServerProcess, agent: &Uploader) -> Result<()> {
    server.assert_healthy().await?;
    let path = format!("/streams/{}/downlink", agent.stream);
    let downlink = server
        .as_agent(Method::GET, &path, &agent.token)
        .send()
        .await?;
    let downlink: Value = downlink.error_for_status()?.json().await?;
    ensure!(downlink["contiguous_seq"] == 0, "{downlink}");
    let stored = server
        .list(&format!("/vessels/{}/samples", agent.vessel))
        .await?;
    ensure!(stored.is_empty(), "{stored:?}");
    Ok(())
}

/// A request with its credentials, and the statuses allowed in response.
struct Attempt<'a> {
    name: &'static str,
    token: Option<&'a str>,
    stream: StreamId,
    seq: u64,
    body: Vec<u8>,
    expected: &'static [u16],
}

fn attempts<'a>(ours: &'a Uploader, other: &'a Uploader) -> Vec<Attempt<'a>> {
    let good = || frame(ours.stream, 1, samples(0, 12).unwrap()).unwrap();
    let mut flipped = good();
    flipped[40] ^= 0x10;
    let attempt = |name: &'static str, body| Attempt {
        name,
        token: Some(&ours.token),
        stream: ours.stream,
        seq: 1,
        body,
        expected: &[400, 422],
    };
    let unknown = StreamId(Uuid::now_v7());
    let by = |name, token, expected: &'static [u16]| Attempt {
        token,
        expected,
        ..attempt(name, good())
    };
    vec![
        attempt("a flipped bit", flipped),
        attempt("half a batch", good()[..30].to_vec()),
        attempt("nothing", Vec::new()),
        attempt("something else", b"{\"samples\":[]}".to_vec()),
        attempt(
            "another stream's batch",
            frame(other.stream, 1, samples(0, 3).unwrap()).unwrap(),
        ),
        Attempt {
            seq: 2,
            ..attempt("another number", good())
        },
        Attempt {
            stream: unknown,
            expected: &[404],
            ..attempt(
                "an unknown stream",
                frame(unknown, 1, samples(0, 3).unwrap()).unwrap(),
            )
        },
        Attempt {
            expected: &[413],
            ..attempt("too much", vec![0x42; 300_000])
        },
        by("another vessel's token", Some(&other.token), &[404]),
        by("no token", None, &[401]),
        by("a made-up token", Some("made-up"), &[401]),
    ]
}

/// The real batch, sent once, again, and changed.
async fn assert_stored_once(server: &ServerProcess, ours: &Uploader) -> Result<()> {
    let send = async |samples| {
        let body = frame(ours.stream, 1, samples).unwrap();
        put(server, Some(&ours.token), ours.stream, 1, body).await
    };
    for _ in 0..2 {
        let (status, answer) = send(samples(0, 12).unwrap()).await?;
        ensure!(
            status == StatusCode::OK && answer["contiguous_seq"] == 1,
            "{status} {answer}"
        );
    }
    let (status, problem) = send(samples(0, 13).unwrap()).await?;
    let kind = problem["type"].as_str().unwrap_or_default();
    ensure!(
        status == StatusCode::CONFLICT && kind.ends_with("/stream-forked"),
        "{problem}"
    );
    // The API lists analysed samples, which takes a moment.
    let path = format!("/vessels/{}/samples", ours.vessel);
    let stored = eventually("the samples are analysed", TIMEOUT, async || {
        let stored = server.list(&path).await?;
        Ok(match stored.len() {
            0 => Err("none yet".to_owned()),
            some => Ok(some),
        })
    })
    .await?;
    ensure!(stored == 12, "{stored} samples");
    Ok(())
}

async fn assert_strangers_see_nothing(server: &ServerProcess, vessel: &str) -> Result<()> {
    let other_cookie = server.sign_in_other_operator().await?;
    for path in [
        "",
        "/samples",
        "/model",
        "/deviation",
        "/agents",
        "/coverage",
    ] {
        let path = format!("/vessels/{vessel}{path}");
        let answer = server
            .with_cookie(Method::GET, &path, &other_cookie)
            .send()
            .await?;
        ensure!(
            answer.status() == StatusCode::NOT_FOUND,
            "{path}: {}",
            answer.status()
        );
    }
    Ok(())
}

async fn bad_uploads(engine: Engine) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let mut server = ServerProcess::start(engine, folder.path()).await?;
    let ours = Uploader::enrol(&server, "Ours").await?;
    let other = Uploader::enrol(&server, "Other").await?;
    for attempt in attempts(&ours, &other) {
        let Attempt {
            name,
            token,
            stream,
            seq,
            body,
            expected,
        } = attempt;
        let (status, problem) = put(&server, token, stream, seq, body).await.context(name)?;
        ensure!(
            expected.contains(&status.as_u16()),
            "{name}: {status} {problem}"
        );
        assert_nothing_stored(&mut server, &ours)
            .await
            .context(name)?;
    }
    assert_stored_once(&server, &ours).await?;
    assert_strangers_see_nothing(&server, &ours.vessel).await?;
    server.assert_healthy().await?;
    server.finish().await
}

#[tokio::test]
async fn a_bad_upload_is_refused_and_leaves_nothing_on_sqlite() {
    bad_uploads(Engine::Sqlite).await.unwrap();
}

#[tokio::test]
async fn a_bad_upload_is_refused_and_leaves_nothing_on_postgres() {
    bad_uploads(Engine::Postgres).await.unwrap();
}
