//! A PostgreSQL primary and a standby that follows it synchronously [PostgreSQL 18 documentation,
//! chapter 26.2]: real servers, set up and killed by the test.

use crate::eventually::eventually;
use crate::process::program::Program;
use anyhow::{Context, Result, ensure};
use rustix::process::geteuid;
use sqlx::{Connection, Executor, PgConnection};
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::os::unix::fs::{PermissionsExt, chown};
use std::path::Path;
use std::time::Duration;
use tempfile::TempDir;
use tokio::process::Command;

/// Time for a server to start, follow or take over, on a machine that may be busy.
const TIMEOUT: Duration = Duration::from_mins(1);
const USER: &str = "binnacle";
/// The database that a new cluster has.
const DATABASE: &str = "postgres";

/// A primary and its standby.
#[derive(Debug)]
pub struct PostgresPair {
    owner: Owner,
    folder: TempDir,
    primary: Option<Program>,
    /// Address of the primary.
    pub primary_address: SocketAddr,
    standby: Program,
    /// Address of the standby.
    pub standby_address: SocketAddr,
}

impl PostgresPair {
    /// Starts a primary on an empty database, and a standby. A commit returns once both have it.
    ///
    /// # Errors
    /// Fails when PostgreSQL's programs are not in the PATH, or do not start.
    pub async fn start() -> Result<PostgresPair> {
        let folder = tempfile::tempdir()?;
        let owner = Owner::find().await?;
        owner.give(folder.path())?;
        let (primary, standby) = (folder.path().join("primary"), folder.path().join("standby"));
        let mut initdb = owner.command("initdb", folder.path());
        initdb
            .arg("--pgdata")
            .arg(&primary)
            .args(["--username", USER, "--auth=trust", "--encoding=UTF8"])
            .args(["--locale=C", "--no-sync"]);
        run(initdb).await?;
        let (primary_process, primary_address) = owner.serve("primary", &primary).await?;
        let mut copy = owner.command("pg_basebackup", folder.path());
        copy.args(["--write-recovery-conf", "--no-sync", "--checkpoint=fast"])
            .args(["--pgdata"])
            .arg(&standby)
            .args(["--dbname", &url(primary_address)]);
        run(copy).await?;
        let (standby_process, standby_address) = owner.serve("standby", &standby).await?;
        let pair = PostgresPair {
            owner,
            folder,
            primary: Some(primary_process),
            primary_address,
            standby: standby_process,
            standby_address,
        };
        pair.follow_synchronously().await?;
        Ok(pair)
    }

    async fn follow_synchronously(&self) -> Result<()> {
        let mut primary = PgConnection::connect(&url(self.primary_address)).await?;
        primary
            .execute("ALTER SYSTEM SET synchronous_standby_names = '*'")
            .await?;
        primary.execute("SELECT pg_reload_conf()").await?;
        eventually("the standby follows", TIMEOUT, async || {
            let states: Vec<String> =
                sqlx::query_scalar("SELECT sync_state FROM pg_stat_replication")
                    .fetch_all(&mut primary)
                    .await?;
            Ok(if states == ["sync"] {
                Ok(())
            } else {
                Err(format!("{states:?}"))
            })
        })
        .await
    }

    /// Kills the primary with signal 9.
    ///
    /// # Errors
    /// Fails when it had ended before.
    pub async fn kill_primary(&mut self) -> Result<()> {
        let primary = self
            .primary
            .take()
            .context("the primary was killed before")?;
        primary.kill().await
    }

    /// Makes the standby a primary.
    ///
    /// # Errors
    /// Fails when it does not become one.
    pub async fn promote_standby(&self) -> Result<()> {
        let mut promote = self.owner.command("pg_ctl", self.folder.path());
        promote
            .args(["promote", "--wait", "--pgdata"])
            .arg(self.folder.path().join("standby"));
        run(promote).await
    }

    /// Stops both.
    ///
    /// # Errors
    /// Fails when one had ended by itself.
    pub async fn finish(mut self) -> Result<()> {
        if let Some(primary) = self.primary.take() {
            primary.kill().await?;
        }
        self.standby.kill().await
    }
}

/// Returns the URL of the database at an address.
pub fn url(address: SocketAddr) -> String {
    format!("postgres://{USER}@{address}/{DATABASE}")
}

/// The system's user who owns the clusters: PostgreSQL refuses to run as root.
#[derive(Clone, Copy, Debug)]
struct Owner(Option<(u32, u32)>);

impl Owner {
    async fn find() -> Result<Owner> {
        if !geteuid().is_root() {
            return Ok(Owner(None));
        }
        for name in ["postgres", "nobody"] {
            let found = Command::new("getent")
                .args(["passwd", name])
                .output()
                .await?;
            let line = String::from_utf8(found.stdout)?;
            let mut ids = line.split(':').skip(2);
            if let (Some(user), Some(group)) = (ids.next(), ids.next()) {
                return Ok(Owner(Some((user.parse()?, group.parse()?))));
            }
        }
        anyhow::bail!("the system has neither a user postgres nor nobody")
    }

    fn give(self, folder: &Path) -> Result<()> {
        if let Some((user, group)) = self.0 {
            chown(folder, Some(user), Some(group))?;
            std::fs::set_permissions(folder, PermissionsExt::from_mode(0o700))?;
        }
        Ok(())
    }

    fn command(self, program: &str, folder: &Path) -> Command {
        let mut command = match self.0 {
            None => Command::new(program),
            Some((user, group)) => {
                let mut command = Command::new("setpriv");
                command
                    .arg(format!("--reuid={user}"))
                    .arg(format!("--regid={group}"))
                    .args(["--clear-groups", program]);
                command
            }
        };
        command.current_dir(folder).kill_on_drop(true);
        command
    }

    /// Starts a server on a cluster and waits until it accepts connections.
    async fn serve(self, name: &str, cluster: &Path) -> Result<(Program, SocketAddr)> {
        let address = free_address()?;
        let mut command = self.command("postgres", cluster);
        command
            .arg("-D")
            .arg(cluster)
            .args(["-h", "127.0.0.1", "-p", &address.port().to_string()])
            .args(["-k", "", "-c", "fsync=off", "-c", "max_connections=100"]);
        let process = Program::start(name, command, &cluster.with_extension("log"))?;
        let started = eventually(format!("the {name} starts"), TIMEOUT, async || {
            Ok(match PgConnection::connect(&url(address)).await {
                Ok(_) => Ok(()),
                Err(error) => Err(format!("{error}\n{}", process.log())),
            })
        });
        started.await?;
        Ok((process, address))
    }
}

fn free_address() -> Result<SocketAddr> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
    Ok(listener.local_addr()?)
}

async fn run(mut command: Command) -> Result<()> {
    let output = command.output().await.with_context(|| {
        format!(
            "{:?}: run `make test`, which has PostgreSQL's programs, or `scripts/with-postgres \
             cargo test`",
            command.as_std()
        )
    })?;
    let errors = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{:?}: {errors}", command.as_std());
    Ok(())
}
