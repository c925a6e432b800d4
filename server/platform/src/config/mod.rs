//! Server settings: flags, or `BINNACLE_*` variables.

use crate::db::{Db, Subscribers};
use crate::outbound::Reach;
use crate::sealing::Seals;
use crate::tls::Certificate;
use anyhow::{Context, bail};
use binnacle_listener::Limits;
use clap::{Args, ValueEnum};
use sha2::{Digest, Sha256};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

/// Database settings.
#[derive(Clone, Debug, Args)]
pub struct Database {
    /// sqlite://FILE or postgres://USER:PASSWORD@HOST/NAME
    #[arg(
        long,
        global = true,
        env = "BINNACLE_DATABASE_URL",
        default_value = "sqlite://binnacle.db",
        hide_env_values = true
    )]
    pub database_url: String,
    /// Key that seals secrets in the database, 64 hexadecimal digits; earlier keys, which only open,
    /// follow after commas
    #[arg(
        long,
        global = true,
        env = "BINNACLE_SECRETS_KEY",
        hide_env_values = true
    )]
    pub secrets_key: Option<Secret>,
    /// File with these keys
    #[arg(
        long,
        global = true,
        env = "BINNACLE_SECRETS_KEY_FILE",
        conflicts_with = "secrets_key"
    )]
    pub secrets_key_file: Option<PathBuf>,
}

/// Setting that no error message may repeat: clap shows a value that its parser refuses.
#[derive(Clone)]
pub struct Secret(String);

impl From<&str> for Secret {
    fn from(text: &str) -> Secret {
        Secret(text.to_owned())
    }
}

impl std::fmt::Debug for Secret {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Secret(…)")
    }
}

impl Database {
    fn seals(&self) -> anyhow::Result<Seals> {
        if let Some(Secret(keys)) = &self.secrets_key {
            let parsed = Seals::parse(keys).map_err(anyhow::Error::msg);
            return parsed.context("BINNACLE_SECRETS_KEY, or --secrets-key");
        }
        let read = self.secrets_key_file.as_deref().map(Seals::read);
        let read = read.transpose().map_err(anyhow::Error::msg);
        let read = read.context("BINNACLE_SECRETS_KEY_FILE, or --secrets-key-file")?;
        Ok(read.unwrap_or_default())
    }

    /// Opens the database with its keys.
    ///
    /// # Errors
    /// Fails when the database cannot be reached.
    pub async fn open(&self, subscribers: Subscribers) -> anyhow::Result<Db> {
        let seals = self.seals()?;
        let db = Db::connect(&self.database_url, subscribers).await?;
        Ok(db.with_seals(seals))
    }
}

/// Part of the service that a process runs. Processes with different parts share one database.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Role {
    /// Everything
    #[default]
    All,
    /// Dashboard and API, for people and their programs
    Api,
    /// Uploads and enrolment of the agents
    Ingest,
    /// Analyses, schedules, and what is sent: mail, notifications, webhooks
    Worker,
}

impl Role {
    /// Returns true if the process serves people and their programs.
    pub fn serves_people(self) -> bool {
        matches!(self, Self::All | Self::Api)
    }

    /// Returns true if the process serves agents.
    pub fn serves_agents(self) -> bool {
        matches!(self, Self::All | Self::Ingest)
    }

    /// Returns true if the process works in the background.
    pub fn works(self) -> bool {
        matches!(self, Self::All | Self::Worker)
    }
}

/// Settings of `serve`.
#[derive(Clone, Debug, Args)]
pub struct Serve {
    /// Database settings.
    #[command(flatten)]
    pub database: Database,
    /// Part of the service that this process runs
    #[arg(long, env = "BINNACLE_ROLE", value_enum, default_value_t)]
    pub role: Role,
    /// Address and port to listen on; port 0 for any free one
    #[arg(long, env = "BINNACLE_LISTEN", default_value = "127.0.0.1:8080")]
    pub listen: SocketAddr,
    /// Serve https with this certificate chain (PEM); SIGHUP reloads it
    #[arg(long, env = "BINNACLE_TLS_CERT", requires = "tls_key")]
    pub tls_cert: Option<PathBuf>,
    /// The certificate's private key (PEM)
    #[arg(long, env = "BINNACLE_TLS_KEY", requires = "tls_cert")]
    pub tls_key: Option<PathBuf>,
    /// Set the Secure flag on cookies, for use behind a TLS proxy; implied by --tls-cert
    #[arg(long, env = "BINNACLE_SECURE_COOKIES", default_value_t = false,
          num_args = 0..=1, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub secure_cookies: bool,
    /// Lifetime of a session in hours
    #[arg(long, env = "BINNACLE_SESSION_HOURS", default_value_t = 72,
          value_parser = clap::value_parser!(u32).range(1..=8760))]
    pub session_hours: u32,
    /// Hours without a request after which a session ends
    #[arg(long, env = "BINNACLE_SESSION_IDLE_HOURS", default_value_t = 24,
          value_parser = clap::value_parser!(u32).range(1..=8760))]
    pub session_idle_hours: u32,
    /// Days that an API token lives at most; a year by default
    #[arg(long, env = "BINNACLE_TOKEN_DAYS", default_value_t = 366,
          value_parser = clap::value_parser!(u32).range(1..=36_500))]
    pub token_days: u32,
    /// Number of your own proxies in front of the server; the client address is taken from
    /// the X-Forwarded-For entry of the outermost one
    #[arg(long, env = "BINNACLE_PROXIES", default_value_t = 0,
          value_parser = clap::value_parser!(u8).range(0..=8))]
    pub proxies: u8,
    /// Bearer token required to read /metrics; without one only this machine may read it
    #[arg(long, env = "BINNACLE_METRICS_TOKEN", hide_env_values = true)]
    pub metrics_token: Option<Secret>,
    /// Requests that a person, program or client address may make in a minute, in this process
    #[arg(long, env = "BINNACLE_REQUESTS_PER_MINUTE", default_value_t = 6000,
          value_parser = clap::value_parser!(u32).range(1..))]
    pub requests_per_minute: u32,
    /// Batches that a vessel may upload in a day (UTC), to this process
    #[arg(long, env = "BINNACLE_UPLOADS_PER_DAY", default_value_t = 10_000,
          value_parser = clap::value_parser!(u32).range(1..))]
    pub uploads_per_day: u32,
    /// Retention of the audit log in days
    #[arg(long, env = "BINNACLE_AUDIT_DAYS", default_value_t = 1095,
          value_parser = clap::value_parser!(u32).range(1..=36_500))]
    pub audit_days: u32,
    /// Seconds to wait for more batches before a vessel is analysed
    #[arg(long, env = "BINNACLE_ANALYSIS_DELAY_S", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(0..=86_400))]
    pub analysis_delay_s: u32,
    /// Analyses to run at once in this process; with 0 it neither analyses nor sends anything
    #[arg(long, env = "BINNACLE_ANALYSIS_WORKERS", default_value_t = 1,
          value_parser = clap::value_parser!(u16).range(0..=64))]
    pub analysis_workers: u16,
    /// Limits on connections.
    #[command(flatten)]
    pub connections: Connections,
    /// Webhook settings.
    #[command(flatten)]
    pub webhooks: Webhooks,
    /// Mail settings.
    #[command(flatten)]
    pub mail: Mail,
    /// OpenID Connect settings.
    #[command(flatten)]
    pub oidc: Oidc,
    /// Log as JSON lines
    #[arg(long, env = "BINNACLE_LOG_JSON", default_value_t = false,
          num_args = 0..=1, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub log_json: bool,
}

/// Minimum length of the metrics' token: a shorter one could be guessed.
const SHORTEST_TOKEN: usize = 20;

impl Serve {
    /// Checks what cannot be checked while the settings are parsed.
    ///
    /// # Errors
    /// Fails when the metrics' token is short, or cannot be sent in a header.
    pub fn check(&self) -> anyhow::Result<()> {
        let Some(Secret(token)) = &self.metrics_token else {
            return Ok(());
        };
        let is_sent_whole = token.bytes().all(|byte| byte.is_ascii_graphic());
        if is_sent_whole && token.len() >= SHORTEST_TOKEN {
            return Ok(());
        }
        bail!(
            "BINNACLE_METRICS_TOKEN, or --metrics-token: must have at least {SHORTEST_TOKEN} \
             printable ASCII characters and no blanks"
        )
    }

    /// Compares a token with that for the metrics, in constant time; none is right without one.
    pub fn is_metrics_token(&self, given: &str) -> bool {
        self.metrics_token.as_ref().is_some_and(|Secret(own)| {
            let [own, given] = [own, given].map(|text| Sha256::digest(text.as_bytes()));
            own == given
        })
    }

    /// Returns true if cookies are limited to https.
    pub fn has_secure_cookies(&self) -> bool {
        self.secure_cookies || self.tls_cert.is_some()
    }

    /// Returns true if the dashboard is known to be reached by https.
    pub fn is_on_https(&self) -> bool {
        let public = self.mail.public_url.as_deref().unwrap_or_default();
        self.has_secure_cookies() || public.starts_with("https://")
    }

    /// Returns the limits on connections. The proxies in front of the server limit their own
    /// clients.
    pub fn limits(&self) -> Limits {
        let of_each = self.connections.max_connections_per_address as usize;
        Limits {
            connections: self.connections.max_connections as usize,
            connections_per_network: (self.proxies == 0).then_some(of_each),
            handshake: HANDSHAKE,
            head: HEAD,
            idle: IDLE,
            stall: STALL,
            drain: DRAIN,
        }
    }

    /// Returns the certificate's location, if https is served.
    pub fn certificate(&self, one_request: &'static [u8]) -> Option<Certificate> {
        let (chain, key) = (self.tls_cert.clone()?, self.tls_key.clone()?);
        Some(Certificate {
            chain,
            key,
            one_request,
        })
    }
}

/// Time limits of connections. A handshake over a satellite link that loses packets takes up to
/// half a minute, and a telephone on it carries some 300 bytes a second.
const HANDSHAKE: Duration = Duration::from_secs(30);
const HEAD: Duration = Duration::from_secs(13);
const IDLE: Duration = Duration::from_secs(75);
const STALL: Duration = Duration::from_mins(1);
/// Time for requests in progress to finish when the server stops.
const DRAIN: Duration = Duration::from_secs(20);

/// Limits on connections.
#[derive(Clone, Copy, Debug, Args)]
pub struct Connections {
    /// Maximum number of connections; fewer where the system allows fewer open files
    #[arg(long, env = "BINNACLE_MAX_CONNECTIONS", default_value_t = 4096,
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub max_connections: u32,
    /// Maximum number of connections from one IPv4 address or IPv6 /56; not applied behind
    /// --proxies
    #[arg(long, env = "BINNACLE_MAX_CONNECTIONS_PER_ADDRESS", default_value_t = 256,
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub max_connections_per_address: u32,
}

/// Webhook settings.
#[derive(Clone, Copy, Debug, Args)]
pub struct Webhooks {
    /// Let webhooks reach private and loopback addresses, and use plain http
    #[arg(long, env = "BINNACLE_WEBHOOKS_TO_PRIVATE", default_value_t = false,
          num_args = 0..=1, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub webhooks_to_private: bool,
}

impl Webhooks {
    /// Returns the addresses that webhooks may reach.
    pub fn reach(self) -> Reach {
        if self.webhooks_to_private {
            Reach::Anywhere
        } else {
            Reach::Public
        }
    }
}

/// Mail settings.
#[derive(Clone, Debug, Default, Args)]
pub struct Mail {
    /// Send mail through smtps://USER:PASSWORD@HOST, smtp://… (STARTTLS) or
    /// smtp://HOST?tls=none (a relay in your own network)
    #[arg(long, env = "BINNACLE_SMTP_URL", hide_env_values = true,
          requires_all = ["mail_from", "public_url"])]
    pub smtp_url: Option<String>,
    /// Additional certificate authority (PEM) to trust for the relay
    #[arg(long, env = "BINNACLE_SMTP_CA", requires = "smtp_url")]
    pub smtp_ca: Option<PathBuf>,
    /// Sender of mail, like "Binnacle <alerts@example.com>"
    #[arg(long, env = "BINNACLE_MAIL_FROM")]
    pub mail_from: Option<String>,
    /// Public address of the dashboard, like `https://binnacle.example.com`; mail links to
    /// it
    #[arg(long, env = "BINNACLE_PUBLIC_URL")]
    pub public_url: Option<String>,
}

impl Mail {
    /// Returns true if mail is sent.
    pub fn is_set_up(&self) -> bool {
        self.smtp_url.is_some()
    }
}

/// OpenID Connect settings.
#[derive(Clone, Debug, Default, Args)]
pub struct Oidc {
    /// Let existing users also sign in through this OpenID Connect provider, like
    /// `https://login.example.com`
    #[arg(long, env = "BINNACLE_OIDC_ISSUER", value_parser = issuer,
          requires_all = ["oidc_client_id", "public_url"])]
    pub oidc_issuer: Option<String>,
    /// Client id of this server at the provider
    #[arg(long, env = "BINNACLE_OIDC_CLIENT_ID", requires = "oidc_issuer")]
    pub oidc_client_id: Option<String>,
    /// Client secret, unless the provider issued none
    #[arg(
        long,
        env = "BINNACLE_OIDC_CLIENT_SECRET",
        hide_env_values = true,
        requires = "oidc_issuer"
    )]
    pub oidc_client_secret: Option<String>,
    /// Name of the provider on the sign-in page: "Sign in with …"
    #[arg(long, env = "BINNACLE_OIDC_NAME", default_value = "OpenID Connect")]
    pub oidc_name: String,
}

impl Oidc {
    /// Returns true if a provider is configured.
    pub fn is_set_up(&self) -> bool {
        self.oidc_issuer.is_some()
    }
}

/// Parses the provider's address. It must be https, so that responses cannot be altered in
/// transit.
fn issuer(text: &str) -> Result<String, String> {
    let url = reqwest::Url::parse(text).map_err(|error| error.to_string())?;
    let host = url.host_str().unwrap_or_default();
    let is_here = ["localhost", "127.0.0.1", "[::1]"].contains(&host);
    match url.scheme() {
        "https" => Ok(text.to_owned()),
        "http" if is_here => Ok(text.to_owned()),
        _ => Err("must be https, unless it is on this machine".to_owned()),
    }
}
