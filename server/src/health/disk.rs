//! The database's disk: what is done when it is full.
//!
//! Invariant: a full disk is reported once, to the platform's admins and in the log, and then
//! tried until something can be written again.

use binnacle_platform::app::App;
use binnacle_platform::db::{self, execute};
use binnacle_platform::mail::Mailer;
use metrics::gauge;
use std::time::Duration;
use tracing::{error, info, warn};
use uuid::Uuid;

/// Interval between attempts to write.
const PROBE_EVERY: Duration = Duration::from_secs(10);
/// Size of a probe, bytes: a batch has less.
const PROBE_BYTES: usize = 64 * 1024;

const SUBJECT: &str = "Binnacle: the database's disk is full";
const TEXT: &str = "The disk of Binnacle's database is full. Uploads from ships and changes by \
    people are refused until there is space; ships keep their samples and send them again. Free \
    space on the disk, or enlarge it.";

/// Watches for a full disk until the server stops.
pub async fn watch(app: App, mailer: Option<Mailer>) {
    let full = gauge!("binnacle_disk_full");
    loop {
        full.set(0.0);
        tokio::select! {
            () = app.stopping.cancelled() => return,
            () = app.disk.wait_until_full() => {}
        }
        full.set(1.0);
        error!("the database's disk is full: free some space");
        if let Some(mailer) = &mailer
            && let Err(problem) = alert_admins(&app, mailer).await
        {
            warn!(error = ?problem, "the platform's admins could not be alerted");
        }
        while app.disk.is_full() {
            tokio::select! {
                () = app.stopping.cancelled() => return,
                () = tokio::time::sleep(PROBE_EVERY) => {}
            }
            if probe(&app).await.is_ok() {
                info!("the database's disk has space again");
            }
        }
    }
}

/// Writes to the platform's admins that the disk is full. Returns their number.
///
/// # Errors
/// Fails when the relay does not accept a letter.
pub async fn alert_admins(app: &App, mailer: &Mailer) -> anyhow::Result<usize> {
    let now = app.clock.now().into();
    mailer
        .write_to_platform_admins(&app.db, SUBJECT, TEXT, now)
        .await
}

/// Records that the disk has space, if something can be written.
///
/// # Errors
/// Fails when nothing can be written.
pub async fn probe(app: &App) -> db::Result<()> {
    // Random, so that a database cannot compress them to nothing.
    let random = |_| Uuid::new_v4().into_bytes();
    let bytes: Vec<u8> = (0..PROBE_BYTES / 16).flat_map(random).collect();
    let mut tx = app.db.begin().await?;
    execute!(
        &mut tx,
        "INSERT INTO disk_probes (bytes) VALUES ($1)",
        bytes
    )?;
    tx.commit().await?;
    app.disk.report_space();
    let mut tx = app.db.begin().await?;
    execute!(&mut tx, "DELETE FROM disk_probes")?;
    tx.commit().await
}
