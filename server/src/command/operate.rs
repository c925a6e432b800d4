//! `serve`, `migrate` and `openapi`.

use crate::state::ServerState;
use crate::subscriptions::subscribers;
use crate::{health, routes, worker};
use anyhow::{Context, Result};
use binnacle_fleet::{alerts, analysis_queue};
use binnacle_listener::{Limits, plain, raise_open_file_limit, serve as serve_connections};
use binnacle_orders::dispatch;
use binnacle_planning::{notifications, reports, schedule};
use binnacle_platform::app::App;
use binnacle_platform::clock::Clock;
use binnacle_platform::config::{Database, Serve};
use binnacle_platform::event_stream::{EventListener, announce as announce_events};
use binnacle_platform::mail::Mailer;
use binnacle_platform::tls::TlsAcceptor;
use binnacle_platform::{audit, outbox, seal_rotation, sign_in_watch, webhooks};
use sd_notify::NotifyState;
use std::future::Future;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::task::JoinSet;
use tracing::{error, info, warn};
use tracing_subscriber::EnvFilter;

/// Time for an analysis in progress to finish when the server stops.
const GRACE: Duration = Duration::from_secs(20);

/// Number of webhooks sent concurrently, so that a slow receiver delays only its own.
const WEBHOOK_SENDERS: usize = 4;
/// Number of letters sent concurrently: all go through one relay.
const MAIL_SENDERS: usize = 2;

/// Serves until the process is stopped.
///
/// # Errors
/// Fails when the database cannot be opened or the address is not available.
pub fn serve(config: Serve) -> Result<ExitCode> {
    start_log(config.log_json);
    config.check()?;
    block_on(async {
        let db = config.database.open(subscribers()).await?;
        let claim = db.claim_to_serve().await?;
        db.check_file().await?;
        db.migrate_claimed(&claim).await?;
        seal_rotation::check(&db).await?;
        let listener = TcpListener::bind(config.listen)
            .await
            .with_context(|| format!("cannot listen on {}", config.listen))?;
        let certificate = config.certificate(binnacle_wire::downlink::ONCE);
        let tls = certificate.map(TlsAcceptor::new).transpose()?;
        announce(if tls.is_some() { "https" } else { "http" }, &listener)?;
        let app = App::new(db, Clock::System, config, health::install_metrics()?);
        run(app, listener, tls).await?;
        drop(claim);
        Ok(ExitCode::SUCCESS)
    })
}

/// Serves an application on a listener, with TLS or without, until a signal or its own `stopping`
/// stops it.
///
/// # Errors
/// Fails when the mail settings cannot be used, or the database fails.
pub async fn run(app: App, listener: TcpListener, tls: Option<TlsAcceptor>) -> Result<()> {
    let state = ServerState::new(app.clone());
    let mailer = Mailer::new(&app.config.mail, alerts::TOPIC_LIST)?;
    let mailer = mailer.map(|mailer| mailer.with_list(reports::MAILING_LIST));
    let mut parts = JoinSet::new();
    let events = EventListener::open(&app.db).await?;
    parts.spawn(events.listen(app.clone()));
    parts.spawn(announce_events(app.clone()));
    parts.spawn(health::disk::watch(app.clone(), mailer.clone()));
    if app.config.role.works() {
        let outdated = analysis_queue::enqueue_outdated(&app.db, app.clock.now().into()).await?;
        if outdated > 0 {
            info!(
                vessels = outdated,
                "the estimator has changed; analysing again"
            );
        }
    }
    if app.config.role.works() && app.config.analysis_workers > 0 {
        for _ in 0..app.config.analysis_workers {
            parts.spawn(worker::run(app.clone()));
        }
        parts.spawn(alerts::watch(app.clone()));
        parts.spawn(audit::watch(app.clone()));
        parts.spawn(sign_in_watch::watch(app.clone()));
        parts.spawn(schedule::run(app.clone(), state.plan_slots.clone()));
        parts.spawn(dispatch::watch(app.clone()));
        parts.spawn(notifications::watch(app.clone()));
        parts.spawn(reports::watch(app.clone()));
        match webhooks::Sender::new(app.config.webhooks.reach()) {
            Ok(sender) => {
                for _ in 0..WEBHOOK_SENDERS {
                    parts.spawn(outbox::run(app.clone(), sender.clone()));
                }
            }
            // A machine without root certificates can still receive batches.
            Err(error) => error!(error = format!("{error:#}"), "webhooks cannot be sent"),
        }
        if let Some(mailer) = mailer {
            for _ in 0..MAIL_SENDERS {
                parts.spawn(outbox::run(app.clone(), mailer.clone()));
            }
        }
    }
    // Before the server says that it is ready: it may be stopped at once.
    let terminate = signal(SignalKind::terminate()).context("cannot listen for signals")?;
    parts.spawn(stop_on_signal(app.clone(), terminate));
    notify_service_manager(NotifyState::Ready);
    let limits = limits_of_connections(&app);
    let (router, stopping) = (routes::router(&state), app.stopping.clone());
    let cut_off = match tls {
        Some(tls) => {
            let handshake = |stream| tls.accept(stream);
            serve_connections(listener, limits, handshake, router, stopping).await
        }
        None => serve_connections(listener, limits, plain, router, stopping).await,
    };
    if cut_off > 0 {
        warn!(connections = cut_off, "running requests were cut off");
    }
    let finished = async { while parts.join_next().await.is_some() {} };
    if tokio::time::timeout(GRACE, finished).await.is_err() {
        warn!("a running analysis was cut off; its lease will expire");
    }
    app.db.close().await;
    info!("stopped");
    Ok(())
}

/// Returns the limits on connections, after raising the limit of open files.
fn limits_of_connections(app: &App) -> Limits {
    let limits = app.config.limits();
    let limits = match raise_open_file_limit() {
        Ok(open_files) => {
            info!(open_files, "the limit of open files is raised");
            limits.within_open_files(open_files)
        }
        Err(error) => {
            warn!(%error, "the limit of open files cannot be raised");
            limits
        }
    };
    info!(
        connections = limits.connections,
        per_address = limits.connections_per_network,
        "accepting connections"
    );
    limits
}

async fn stop_on_signal(app: App, mut terminate: Signal) {
    tokio::select! {
        () = app.stopping.cancelled() => {}
        _ = terminate.recv() => {}
        _ = tokio::signal::ctrl_c() => {}
    }
    notify_service_manager(NotifyState::Stopping);
    app.stopping.cancel();
}

/// Sends a state to the service manager, if one has started the server.
fn notify_service_manager(state: NotifyState<'_>) {
    if let Err(error) = sd_notify::notify(&[state]) {
        warn!(%error, "the service manager cannot be reached");
    }
}

/// Prints the address for whoever started the server.
fn announce(scheme: &str, listener: &TcpListener) -> Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "listening on {scheme}://{}", listener.local_addr()?)?;
    out.flush()?;
    Ok(())
}

/// Brings the schema up to date.
///
/// # Errors
/// Fails when the database cannot be reached or a migration fails.
pub fn migrate(database: &Database) -> Result<ExitCode> {
    block_on(async {
        let db = database.open(subscribers()).await?;
        db.migrate().await?;
        db.close().await;
        Ok(ExitCode::SUCCESS)
    })
}

/// Prints the OpenAPI document.
///
/// # Errors
/// Fails when standard output cannot be written.
pub fn openapi() -> Result<ExitCode> {
    let document = routes::openapi().to_pretty_json()?;
    super::print(&document)?;
    Ok(ExitCode::SUCCESS)
}

/// Runs a future to completion.
pub(super) fn block_on<T>(work: impl Future<Output = Result<T>>) -> Result<T> {
    tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()?
        .block_on(work)
}

fn start_log(json: bool) {
    let filter = EnvFilter::try_from_env("BINNACLE_LOG")
        .unwrap_or_else(|_| EnvFilter::new("info,sqlx=warn,tower_http=warn"));
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        // Colours are for a terminal: files and collectors of logs get none.
        .with_ansi(std::io::stderr().is_terminal())
        .with_writer(std::io::stderr);
    if json {
        log.json().init();
    } else {
        log.init();
    }
}
