//! Settings of the server: flags, or `BINNACLE_*` variables.

use crate::tls::Certificate;
use crate::webhooks::Reach;
use clap::Args;
use sha2::{Digest, Sha256};
use std::net::SocketAddr;
use std::path::PathBuf;

/// Which database.
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
}

/// `serve`.
#[derive(Clone, Debug, Args)]
pub struct Serve {
    /// Which database.
    #[command(flatten)]
    pub database: Database,
    /// Address and port to listen on; port 0 for any free one
    #[arg(long, env = "BINNACLE_LISTEN", default_value = "127.0.0.1:8080")]
    pub listen: SocketAddr,
    /// Speak https, with this certificate chain (PEM); SIGHUP reads it anew
    #[arg(long, env = "BINNACLE_TLS_CERT", requires = "tls_key")]
    pub tls_cert: Option<PathBuf>,
    /// The certificate's private key (PEM)
    #[arg(long, env = "BINNACLE_TLS_KEY", requires = "tls_cert")]
    pub tls_key: Option<PathBuf>,
    /// Give cookies only to https, as behind a TLS proxy; so it is with --tls-cert
    #[arg(long, env = "BINNACLE_SECURE_COOKIES", default_value_t = false,
          num_args = 0..=1, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub secure_cookies: bool,
    /// Hours that a sign-in lasts
    #[arg(long, env = "BINNACLE_SESSION_HOURS", default_value_t = 72,
          value_parser = clap::value_parser!(u32).range(1..=8760))]
    pub session_hours: u32,
    /// Hours without a request after which a sign-in ends
    #[arg(long, env = "BINNACLE_SESSION_IDLE_HOURS", default_value_t = 24,
          value_parser = clap::value_parser!(u32).range(1..=8760))]
    pub session_idle_hours: u32,
    /// Proxies of one's own in front: who asks is read from the X-Forwarded-For that the
    /// outermost of them wrote
    #[arg(long, env = "BINNACLE_PROXIES", default_value_t = 0,
          value_parser = clap::value_parser!(u8).range(0..=8))]
    pub proxies: u8,
    /// What a scraper of /metrics sends as its bearer token; without one only this machine
    /// may read them
    #[arg(
        long,
        env = "BINNACLE_METRICS_TOKEN",
        hide_env_values = true,
        value_parser = metrics_token
    )]
    pub metrics_token: Option<MetricsToken>,
    /// Days that the audit log is kept
    #[arg(long, env = "BINNACLE_AUDIT_DAYS", default_value_t = 1095,
          value_parser = clap::value_parser!(u32).range(1..=36_500))]
    pub audit_days: u32,
    /// Seconds to wait for more batches before a vessel is analysed
    #[arg(long, env = "BINNACLE_ANALYSIS_DELAY_S", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(0..=86_400))]
    pub analysis_delay_s: u32,
    /// Analyses to run at once in this process; 0 leaves them to others
    #[arg(long, env = "BINNACLE_ANALYSIS_WORKERS", default_value_t = 1,
          value_parser = clap::value_parser!(u16).range(0..=64))]
    pub analysis_workers: u16,
    /// How webhooks are sent.
    #[command(flatten)]
    pub webhooks: Webhooks,
    /// How mail is sent.
    #[command(flatten)]
    pub mail: Mail,
    /// By whose word people may sign in.
    #[command(flatten)]
    pub oidc: Oidc,
    /// Log as JSON lines
    #[arg(long, env = "BINNACLE_LOG_JSON", default_value_t = false,
          num_args = 0..=1, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub log_json: bool,
}

/// The secret of whoever may read the metrics.
#[derive(Clone)]
pub struct MetricsToken(String);

/// Fewer characters may be guessed.
const SHORTEST_TOKEN: usize = 20;

fn metrics_token(text: &str) -> Result<MetricsToken, String> {
    let is_sent_whole = text.bytes().all(|byte| byte.is_ascii_graphic());
    if is_sent_whole && text.len() >= SHORTEST_TOKEN {
        return Ok(MetricsToken(text.to_owned()));
    }
    Err(format!(
        "has {SHORTEST_TOKEN} letters, digits and signs of ASCII at least, and no blanks"
    ))
}

impl MetricsToken {
    /// Whether that is it, found out in the same time whatever it is.
    pub fn is(&self, given: &str) -> bool {
        let [own, given] = [self.0.as_str(), given].map(|text| Sha256::digest(text.as_bytes()));
        own == given
    }
}

impl std::fmt::Debug for MetricsToken {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("MetricsToken(…)")
    }
}

impl Serve {
    /// Whether cookies are for https alone.
    pub fn has_secure_cookies(&self) -> bool {
        self.secure_cookies || self.tls_cert.is_some()
    }

    /// Whether people reach the dashboard by https, as far as is known.
    pub fn is_on_https(&self) -> bool {
        let public = self.mail.public_url.as_deref().unwrap_or_default();
        self.has_secure_cookies() || public.starts_with("https://")
    }

    /// Where the certificate is kept, if https is spoken.
    pub fn certificate(&self, one_request: &'static [u8]) -> Option<Certificate> {
        let (chain, key) = (self.tls_cert.clone()?, self.tls_key.clone()?);
        Some(Certificate {
            chain,
            key,
            one_request,
        })
    }
}

/// How webhooks are sent.
#[derive(Clone, Copy, Debug, Args)]
pub struct Webhooks {
    /// Let webhooks reach private and loopback addresses, and go over plain http
    #[arg(long, env = "BINNACLE_WEBHOOKS_TO_PRIVATE", default_value_t = false,
          num_args = 0..=1, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub webhooks_to_private: bool,
}

impl Webhooks {
    /// Where messages may go.
    pub fn reach(self) -> Reach {
        if self.webhooks_to_private {
            Reach::Anywhere
        } else {
            Reach::Public
        }
    }
}

/// How mail is sent.
#[derive(Clone, Debug, Default, Args)]
pub struct Mail {
    /// Send alerts by mail through smtps://USER:PASSWORD@HOST, smtp://… (STARTTLS) or
    /// smtp://HOST?tls=none (a relay in one's own network)
    #[arg(long, env = "BINNACLE_SMTP_URL", hide_env_values = true,
          requires_all = ["mail_from", "public_url"])]
    pub smtp_url: Option<String>,
    /// One more authority (PEM) that the relay's certificate may be of
    #[arg(long, env = "BINNACLE_SMTP_CA", requires = "smtp_url")]
    pub smtp_ca: Option<PathBuf>,
    /// Whom mail comes from, like "Binnacle <alerts@example.com>"
    #[arg(long, env = "BINNACLE_MAIL_FROM")]
    pub mail_from: Option<String>,
    /// Where people reach the dashboard, like `https://binnacle.example.com`; mail links
    /// to it
    #[arg(long, env = "BINNACLE_PUBLIC_URL")]
    pub public_url: Option<String>,
}

impl Mail {
    /// Whether mail is sent.
    pub fn is_set_up(&self) -> bool {
        self.smtp_url.is_some()
    }
}

/// By whose word people may sign in.
#[derive(Clone, Debug, Default, Args)]
pub struct Oidc {
    /// Let people who are users here sign in by this OpenID Connect provider as well, like
    /// `https://login.example.com`
    #[arg(long, env = "BINNACLE_OIDC_ISSUER", value_parser = issuer,
          requires_all = ["oidc_client_id", "public_url"])]
    pub oidc_issuer: Option<String>,
    /// What the provider knows this server by
    #[arg(long, env = "BINNACLE_OIDC_CLIENT_ID", requires = "oidc_issuer")]
    pub oidc_client_id: Option<String>,
    /// The secret that goes with it, unless the provider gave none
    #[arg(
        long,
        env = "BINNACLE_OIDC_CLIENT_SECRET",
        hide_env_values = true,
        requires = "oidc_issuer"
    )]
    pub oidc_client_secret: Option<String>,
    /// What people call the provider: "Sign in with …"
    #[arg(long, env = "BINNACLE_OIDC_NAME", default_value = "OpenID Connect")]
    pub oidc_name: String,
}

impl Oidc {
    /// Whether there is a provider.
    pub fn is_set_up(&self) -> bool {
        self.oidc_issuer.is_some()
    }
}

/// A provider's address: what it says must not be changed on the way.
fn issuer(text: &str) -> Result<String, String> {
    let url = reqwest::Url::parse(text).map_err(|error| error.to_string())?;
    let host = url.host_str().unwrap_or_default();
    let is_here = ["localhost", "127.0.0.1", "[::1]"].contains(&host);
    match url.scheme() {
        "https" => Ok(text.to_owned()),
        "http" if is_here => Ok(text.to_owned()),
        _ => Err("must be https, unless it is this machine".to_owned()),
    }
}
