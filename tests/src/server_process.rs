//! The server process, and its API as used by an operator's admin.

use crate::link::satellite::Certificates;
use crate::process::database::{Database, Engine};
use crate::process::program::{self, Program};
use anyhow::{Context, Result, bail, ensure};
use reqwest::{Client, Method, RequestBuilder, Response, StatusCode};
use serde_json::{Value, json};
use std::net::{IpAddr, Ipv4Addr};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Once;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::time::timeout;

const EMAIL: &str = "captain@test.example";
const PASSWORD: &str = "correct-horse-battery";
/// The server may listen beyond loopback, where its metrics need a token.
const METRICS_TOKEN: &str = "scraper-of-these-tests";
/// A start migrates the database, on a machine that may be busy.
const START: Duration = Duration::from_mins(1);

/// A running server with one operator, and an admin signed in.
#[derive(Debug)]
pub struct ServerProcess {
    /// URL such as `http://127.0.0.1:PORT`, the same after a restart.
    pub url: String,
    database: Database,
    folder: PathBuf,
    process: Option<Program>,
    http: Client,
    tls: Option<Certificates>,
    cookie: String,
}

impl ServerProcess {
    /// Starts a server on a new database.
    ///
    /// # Errors
    /// Fails when it does not start.
    pub async fn start(engine: Engine, folder: &Path) -> Result<ServerProcess> {
        ServerProcess::open(engine, folder, Ipv4Addr::LOCALHOST.into(), None).await
    }

    /// Starts a server on SQLite at an address, with https.
    ///
    /// # Errors
    /// Fails when it does not start.
    pub async fn start_with_tls(
        folder: &Path,
        address: IpAddr,
        tls: &Certificates,
    ) -> Result<ServerProcess> {
        ServerProcess::open(Engine::Sqlite, folder, address, Some(tls)).await
    }

    async fn open(
        engine: Engine,
        folder: &Path,
        address: IpAddr,
        tls: Option<&Certificates>,
    ) -> Result<ServerProcess> {
        let database = Database::create(engine, folder).await?;
        ServerProcess::open_on(database, folder, address, tls).await
    }

    /// Starts a server on a database without tables.
    ///
    /// # Errors
    /// Fails when it does not start.
    pub async fn start_on(database: Database, folder: &Path) -> Result<ServerProcess> {
        ServerProcess::open_on(database, folder, Ipv4Addr::LOCALHOST.into(), None).await
    }

    /// Starts a further server on the same database, which both use from now on.
    ///
    /// # Errors
    /// Fails when it does not start.
    pub async fn start_beside(&self, folder: &Path) -> Result<ServerProcess> {
        let mut beside = ServerProcess {
            url: String::new(),
            database: Database::at(self.database.url().to_owned()),
            folder: folder.to_owned(),
            process: None,
            http: http_client(None)?,
            tls: None,
            cookie: self.cookie.clone(),
        };
        beside.serve("127.0.0.1:0").await?;
        Ok(beside)
    }

    async fn open_on(
        database: Database,
        folder: &Path,
        address: IpAddr,
        tls: Option<&Certificates>,
    ) -> Result<ServerProcess> {
        let mut server = ServerProcess {
            url: String::new(),
            database,
            folder: folder.to_owned(),
            process: None,
            http: http_client(tls)?,
            tls: tls.cloned(),
            cookie: String::new(),
        };
        server.admin(&["migrate"], "").await?;
        server.create_admin(EMAIL).await?;
        server.serve(&format!("{address}:0")).await?;
        server.cookie = server.sign_in(EMAIL).await?;
        Ok(server)
    }

    /// The server's database.
    pub fn database(&self) -> &Database {
        &self.database
    }

    /// Creates an admin of another operator, and returns the session cookie.
    ///
    /// # Errors
    /// Fails when the server refuses.
    pub async fn sign_in_other_operator(&self) -> Result<String> {
        let email = "stranger@elsewhere.example";
        self.create_admin(email).await?;
        self.sign_in(email).await
    }

    async fn create_admin(&self, email: &str) -> Result<()> {
        let name = ["admin", "create", "operator", "--name", email];
        let operator: Value = serde_json::from_str(&self.admin(&name, "").await?)?;
        let operator = operator["operator_id"].as_str().context("operator_id")?;
        let user = [
            "admin",
            "create",
            "user",
            "--operator",
            operator,
            "--email",
            email,
        ];
        let rest = [
            "--name",
            "Test Admin",
            "--role",
            "admin",
            "--password-stdin",
        ];
        self.admin(&[&user[..], &rest].concat(), PASSWORD).await?;
        Ok(())
    }

    /// Runs a command of the server's program on its database.
    ///
    /// # Errors
    /// Fails when it fails.
    pub async fn admin(&self, arguments: &[&str], input: &str) -> Result<String> {
        let mut command = program::command("binnacle-server")?;
        command
            .args(arguments)
            .env("BINNACLE_DATABASE_URL", self.database.url());
        program::run_with_input(command, &format!("{input}\n")).await
    }

    async fn serve(&mut self, listen: &str) -> Result<()> {
        let mut command = program::command("binnacle-server")?;
        command
            .args(["serve", "--listen", listen])
            .env("BINNACLE_DATABASE_URL", self.database.url())
            .env("BINNACLE_ANALYSIS_DELAY_S", "0")
            .env("BINNACLE_METRICS_TOKEN", METRICS_TOKEN)
            .stdout(Stdio::piped());
        if let Some(tls) = &self.tls {
            command.arg("--tls-cert").arg(&tls.chain);
            command.arg("--tls-key").arg(&tls.key);
        }
        let log = self.folder.join("server.log");
        let mut process = Program::start("binnacle-server", command, &log)?;
        let stdout = process
            .child()
            .stdout
            .take()
            .context("standard output was asked for")?;
        let mut lines = BufReader::new(stdout).lines();
        let line = timeout(START, lines.next_line())
            .await
            .context("the server's first line")??;
        // Keeps the pipe open: the server may write more.
        tokio::spawn(async move { while let Ok(Some(_)) = lines.next_line().await {} });
        let line = line.with_context(|| format!("the server ended:\n{}", process.log()))?;
        let url = line
            .strip_prefix("listening on ")
            .with_context(|| line.clone())?;
        url.clone_into(&mut self.url);
        self.process = Some(process);
        Ok(())
    }

    /// Kills the server with signal 9 and starts it again on the same port.
    ///
    /// # Errors
    /// Fails when it had ended by itself, or does not start again.
    pub async fn kill_and_restart(&mut self) -> Result<()> {
        self.restart_after(|| Ok(())).await
    }

    /// Stops the server with signal 9, calls `meanwhile`, and starts it on the
    /// same port.
    ///
    /// # Errors
    /// Fails when it had ended by itself, does not start again, or `meanwhile` fails.
    pub async fn restart_after(&mut self, meanwhile: impl FnOnce() -> Result<()>) -> Result<()> {
        let process = self.process.take().context("the server runs")?;
        process.kill().await?;
        meanwhile()?;
        let (_, listen) = self.url.split_once("://").context("a URL")?;
        let listen = listen.to_owned();
        self.serve(&listen).await
    }

    /// Returns the number of analyses waiting or under way.
    ///
    /// # Errors
    /// Fails when the server does not tell.
    pub async fn jobs(&self) -> Result<u64> {
        let metrics = self.http.get(format!("{}/metrics", self.url));
        let metrics = metrics
            .bearer_auth(METRICS_TOKEN)
            .send()
            .await?
            .error_for_status()?
            .text()
            .await?;
        let waiting = metrics
            .lines()
            .filter(|line| line.starts_with("binnacle_jobs{"))
            .filter(|line| !line.contains("state=\"dead\""))
            .filter_map(|line| line.rsplit_once(' ')?.1.parse::<u64>().ok());
        Ok(waiting.sum())
    }

    /// Fails unless the server runs and is healthy.
    ///
    /// # Errors
    /// Fails when it is not.
    pub async fn assert_healthy(&mut self) -> Result<()> {
        let process = self.process.as_mut().context("the server runs")?;
        ensure!(
            process.is_running()?,
            "the server has ended:\n{}",
            process.log()
        );
        let answer = self
            .http
            .get(format!("{}/healthz", self.url))
            .send()
            .await?;
        ensure!(answer.status().is_success(), "healthz: {}", answer.status());
        Ok(())
    }

    /// Stops the server and removes its database.
    ///
    /// # Errors
    /// Fails when the server had ended by itself.
    pub async fn finish(mut self) -> Result<()> {
        let process = self.process.take().context("the server runs")?;
        ensure!(
            !process.log().contains("panicked"),
            "the server panicked:\n{}",
            process.log()
        );
        process.kill().await?;
        self.database.remove().await
    }

    async fn sign_in(&self, email: &str) -> Result<String> {
        let answer = self
            .http
            .post(format!("{}/api/v1/session", self.url))
            .json(&json!({ "email": email, "password": PASSWORD }))
            .send()
            .await?;
        ensure!(
            answer.status().is_success(),
            "signing in: {}",
            answer.text().await?
        );
        let cookie = answer
            .headers()
            .get("set-cookie")
            .context("a session cookie")?;
        let pair = cookie.to_str()?.split(';').next().unwrap_or_default();
        Ok(pair.to_owned())
    }

    /// A request below `/api/v1` without credentials.
    pub fn anonymous(&self, method: Method, path: &str) -> RequestBuilder {
        self.http
            .request(method, format!("{}/api/v1{path}", self.url))
    }

    /// A request with an agent's token.
    pub fn as_agent(&self, method: Method, path: &str, token: &str) -> RequestBuilder {
        self.anonymous(method, path).bearer_auth(token)
    }

    /// A request with a session's cookie.
    pub fn with_cookie(&self, method: Method, path: &str, cookie: &str) -> RequestBuilder {
        self.anonymous(method, path)
            .header("cookie", cookie)
            .header("x-binnacle-request", "1")
    }

    /// Returns the resource at a path as the admin, or `None` for a missing
    /// one.
    ///
    /// # Errors
    /// Fails when the response is neither.
    pub async fn find(&self, path: &str) -> Result<Option<Value>> {
        let answer = self
            .with_cookie(Method::GET, path, &self.cookie)
            .send()
            .await?;
        if answer.status() == StatusCode::NOT_FOUND {
            return Ok(None);
        }
        json_of(answer).await.map(Some)
    }

    /// Returns the resource at a path as the admin.
    ///
    /// # Errors
    /// Fails when it is missing.
    pub async fn get(&self, path: &str) -> Result<Value> {
        self.find(path)
            .await?
            .with_context(|| format!("nothing at {path}"))
    }

    /// Posts as the admin.
    ///
    /// # Errors
    /// Fails when the server refuses.
    pub async fn post(&self, path: &str, body: &Value) -> Result<Value> {
        let request = self
            .with_cookie(Method::POST, path, &self.cookie)
            .json(body);
        json_of(request.send().await?).await
    }

    /// Returns a list with all its pages.
    ///
    /// # Errors
    /// Fails when a page is refused.
    pub async fn list(&self, path: &str) -> Result<Vec<Value>> {
        let mut items = Vec::new();
        let mut after = String::new();
        loop {
            let mark = if path.contains('?') { '&' } else { '?' };
            let mut page = self.get(&format!("{path}{mark}limit=1000{after}")).await?;
            let Value::Array(found) = page["items"].take() else {
                bail!("no items at {path}");
            };
            items.extend(found);
            let Some(next) = page["next"].as_str() else {
                return Ok(items);
            };
            after = format!("&after={next}");
        }
    }

    /// Creates a vessel with its standard compass; returns its id and an
    /// enrolment code.
    ///
    /// # Errors
    /// Fails when the server refuses.
    pub async fn create_vessel(&self, name: &str) -> Result<(String, String)> {
        let vessel = self.post("/vessels", &json!({ "name": name })).await?;
        let id = vessel["id"].as_str().context("a vessel's id")?.to_owned();
        let code = self.enrolment_code(&id).await?;
        Ok((id, code))
    }

    /// Creates an enrolment code for an agent of a vessel.
    ///
    /// # Errors
    /// Fails when the server refuses.
    pub async fn enrolment_code(&self, vessel: &str) -> Result<String> {
        let answer = self
            .post(&format!("/vessels/{vessel}/agents"), &json!({}))
            .await?;
        Ok(answer["code"]
            .as_str()
            .context("an enrolment code")?
            .to_owned())
    }
}

async fn json_of(answer: Response) -> Result<Value> {
    let (status, path) = (answer.status(), answer.url().path().to_owned());
    let text = answer.text().await?;
    ensure!(status.is_success(), "{path}: {status}: {text}");
    if text.is_empty() {
        return Ok(Value::Null);
    }
    serde_json::from_str(&text).with_context(|| format!("{path}: {text}"))
}

fn http_client(tls: Option<&Certificates>) -> Result<Client> {
    static PROVIDER: Once = Once::new();
    // A second installation fails, which does not matter.
    PROVIDER.call_once(|| drop(rustls::crypto::ring::default_provider().install_default()));
    let mut builder = Client::builder().timeout(Duration::from_mins(1)).no_proxy();
    if let Some(tls) = tls {
        let authority = reqwest::Certificate::from_pem(&std::fs::read(&tls.authority)?)?;
        builder = builder.tls_certs_only([authority]);
    }
    Ok(builder.build()?)
}
