//! Live status by a socket in the data directory: for `status`, with or without a page.
//!
//! Whoever may read the data directory may connect. The agent sends the status as JSON, with its
//! age, and closes.

use super::Status;
use anyhow::Context;
use std::fs::File;
use std::os::fd::AsRawFd;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{UnixListener, UnixStream};
use tokio::sync::watch;
use tokio::time::{Instant, sleep, timeout};
use tokio_util::sync::CancellationToken;

const NAME: &str = "status.sock";
/// Time limit of one transfer.
const TIMEOUT: Duration = Duration::from_secs(5);
/// Pause after the system could not accept a connection.
const PAUSE: Duration = Duration::from_secs(1);

/// Serves the status until `shutdown`. A directory that cannot have a socket costs `status` alone.
pub(crate) fn serve(
    directory: &Path,
    status: watch::Receiver<Arc<Status>>,
    shutdown: &CancellationToken,
) {
    let path = directory.join(NAME);
    // That of an agent that was killed.
    std::fs::remove_file(&path).ok();
    let listener = match on_socket(directory, |path| UnixListener::bind(path)) {
        Ok(listener) => listener,
        Err(error) => {
            let error = format!("{error:#}");
            tracing::warn!(error, "the command `status` will have no live values");
            return;
        }
    };
    let shutdown = shutdown.clone();
    tokio::spawn(async move {
        tokio::select! {
            () = shutdown.cancelled() => {}
            () = send_to_all(listener, status) => {}
        }
        std::fs::remove_file(&path).ok();
    });
}

async fn send_to_all(listener: UnixListener, mut status: watch::Receiver<Arc<Status>>) {
    // Who connects before the agent knows anything waits.
    if status
        .wait_for(|status| status.built_at.is_some())
        .await
        .is_err()
    {
        return;
    }
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            sleep(PAUSE).await;
            continue;
        };
        let aged = status.borrow().aged(Instant::now());
        // One after the other: whoever reads nothing delays the next one by the time limit.
        if let Ok(Err(error)) = timeout(TIMEOUT, send(stream, &aged)).await {
            tracing::debug!(%error, "the status cannot be sent");
        }
    }
}

async fn send(mut stream: UnixStream, status: &Status) -> anyhow::Result<()> {
    stream.write_all(&serde_json::to_vec(status)?).await?;
    Ok(stream.shutdown().await?)
}

/// Fetches the status of the agent that runs on a data directory.
///
/// # Errors
/// Fails when no agent responds there.
pub(crate) async fn fetch(directory: &Path) -> anyhow::Result<Status> {
    let received = timeout(TIMEOUT, async {
        let stream = on_socket(directory, |path| {
            std::os::unix::net::UnixStream::connect(path)
        })?;
        stream.set_nonblocking(true)?;
        let mut received = Vec::new();
        let mut stream = UnixStream::from_std(stream)?;
        stream.read_to_end(&mut received).await?;
        anyhow::Ok(received)
    });
    let received = received.await.context("no response in time")??;
    serde_json::from_slice(&received).context("the response is no status")
}

/// Opens the socket by the directory's descriptor: the path of a socket has room for some hundred
/// bytes only (unix(7)).
fn on_socket<T>(
    directory: &Path,
    open: impl FnOnce(PathBuf) -> std::io::Result<T>,
) -> anyhow::Result<T> {
    let name = || directory.join(NAME).display().to_string();
    let directory = File::open(directory).with_context(name)?;
    let short = format!("/proc/self/fd/{}/{NAME}", directory.as_raw_fd());
    open(short.into()).with_context(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    #[tokio::test]
    async fn the_status_comes_with_its_age_also_from_a_long_path() {
        let directory = TempDir::new().unwrap();
        let long = directory.path().join("l".repeat(200));
        std::fs::create_dir(&long).unwrap();
        let now = Instant::now();
        let status = Status {
            running: true,
            vessel_name: Some("Txori".to_owned()),
            built_at: now.checked_sub(Duration::from_mins(2)),
            ..Status::default()
        };
        let (_sender, receiver) = watch::channel(Arc::new(status));
        let shutdown = CancellationToken::new();
        serve(&long, receiver, &shutdown);
        let fetched = fetch(&long).await.unwrap();
        assert_eq!(fetched.vessel_name.as_deref(), Some("Txori"));
        assert!(fetched.age_s >= Some(120.0), "{:?}", fetched.age_s);
        let text = fetched.text();
        assert!(
            text.contains("120 s old") || text.contains("121 s old"),
            "{text}"
        );
    }

    #[tokio::test]
    async fn the_socket_of_an_agent_that_was_killed_is_in_nobodys_way() {
        let directory = TempDir::new().unwrap();
        let killed = on_socket(directory.path(), |path| UnixListener::bind(path));
        drop(killed.unwrap());
        assert!(fetch(directory.path()).await.is_err());
        let status = Status {
            built_at: Some(Instant::now()),
            ..Status::default()
        };
        let (_sender, receiver) = watch::channel(Arc::new(status));
        serve(directory.path(), receiver, &CancellationToken::new());
        fetch(directory.path()).await.unwrap();
    }
}
