//! Shutdown on signals.

#[cfg(unix)]
use anyhow::Context;
use tokio_util::sync::CancellationToken;

#[cfg(unix)]
pub(super) fn stop_on_signals(shutdown: &CancellationToken) -> anyhow::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    for kind in [SignalKind::terminate(), SignalKind::interrupt()] {
        let mut signals = signal(kind).context("cannot listen for signals")?;
        let shutdown = shutdown.clone();
        tokio::spawn(async move {
            signals.recv().await;
            shutdown.cancel();
        });
    }
    Ok(())
}

#[cfg(not(unix))]
pub(super) fn stop_on_signals(shutdown: &CancellationToken) -> anyhow::Result<()> {
    let shutdown = shutdown.clone();
    tokio::spawn(async move {
        tokio::signal::ctrl_c().await.ok();
        shutdown.cancel();
    });
    Ok(())
}
