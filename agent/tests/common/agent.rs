//! The real program in a folder of its own.

use rustix::process::{Pid, Signal, kill_process};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use tempfile::TempDir;
use tokio::io::{AsyncBufReadExt, BufReader, Lines};
use tokio::process::{Child, ChildStderr, Command};

pub(crate) struct Agent {
    folder: TempDir,
}

/// A running agent, killed when dropped.
pub(crate) struct Running {
    pub(crate) process: Child,
    log: Lines<BufReader<ChildStderr>>,
    /// Address of the corrected heading's output.
    pub(crate) output: SocketAddr,
    /// Address of the local page.
    pub(crate) page: SocketAddr,
}

pub(crate) fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_binnacle-agent"));
    command
        .stdin(Stdio::null())
        .kill_on_drop(true)
        .env_remove("NOTIFY_SOCKET")
        .env_remove("BINNACLE_LOG");
    command
}

impl Agent {
    /// Writes the configuration of an agent that listens to `bridge`.
    pub(crate) fn new(bridge: SocketAddr) -> Agent {
        let folder = TempDir::new().unwrap();
        let config = format!(
            r#"data_dir = "state"
[inputs.bridge]
tcp = "{bridge}"
[roles]
compass = [{{ input = "bridge", talker = "HC", sentence = "HDG" }}]
gyro = [{{ input = "bridge", talker = "HE", sentence = "THS" }}]
position = [{{ input = "bridge", talker = "GP", sentence = "RMC" }}]
rate_of_turn = [{{ input = "bridge", sentence = "ROT" }}]
roll = [{{ input = "bridge", sentence = "XDR" }}]
temperature = [{{ input = "bridge", sentence = "XDR" }}]
[output]
tcp_server = "127.0.0.1:0"
interval_s = 0.05
[page]
listen = "127.0.0.1:0"
[uplink]
poll_s = 1
retry_min_s = 0.02
retry_max_s = 0.1
[silence]
stale_s = 3
"#
        );
        std::fs::write(folder.path().join("agent.toml"), config).unwrap();
        Agent { folder }
    }

    pub(crate) fn config(&self) -> PathBuf {
        self.folder.path().join("agent.toml")
    }

    /// Adds a line under a heading of the configuration.
    pub(crate) fn configure(&self, heading: &str, line: &str) {
        let config = std::fs::read_to_string(self.config()).unwrap();
        assert!(config.contains(heading), "{heading}");
        let config = config.replace(heading, &format!("{heading}\n{line}"));
        std::fs::write(self.config(), config).unwrap();
    }

    pub(crate) fn spool(&self) -> PathBuf {
        self.folder.path().join("state").join("spool.db")
    }

    /// Runs one command to its end.
    pub(crate) async fn call(&self, arguments: &[&str]) -> Output {
        let mut command = command();
        command.arg(arguments[0]).arg("--config").arg(self.config());
        command.args(&arguments[1..]).output().await.unwrap()
    }

    pub(crate) async fn enrol(&self, server: &str) {
        let done = self
            .call(&["enrol", "--server", server, "--code", super::server::CODE])
            .await;
        assert!(done.status.success(), "{done:?}");
    }

    /// Starts the agent and waits until it is ready.
    pub(crate) async fn run(&self) -> Running {
        self.start(command()).await
    }

    /// Like [`Agent::run`], with a variable in its environment.
    pub(crate) async fn run_with(&self, variable: &str, value: &Path) -> Running {
        let mut command = command();
        command.env(variable, value);
        self.start(command).await
    }

    async fn start(&self, mut command: Command) -> Running {
        command.arg("run").arg("--config").arg(self.config());
        let mut process = command.stderr(Stdio::piped()).spawn().unwrap();
        let mut log = BufReader::new(process.stderr.take().unwrap()).lines();
        loop {
            let line = log.next_line().await.unwrap().expect("the agent ended");
            if !line.contains(" ready ") {
                continue;
            }
            let address = |name: &str| -> SocketAddr {
                let (_, rest) = line.split_once(&format!("{name}=\"")).unwrap();
                rest.split('"').next().unwrap().parse().unwrap()
            };
            return Running {
                output: address("output"),
                page: address("page"),
                process,
                log,
            };
        }
    }
}

impl Running {
    /// Signal 9.
    pub(crate) async fn kill(mut self) {
        self.process.kill().await.unwrap();
    }

    /// Sends signal 15. Returns the exit code and the rest of the log.
    pub(crate) async fn terminate(mut self) -> (Option<i32>, String) {
        let id = i32::try_from(self.process.id().unwrap()).unwrap();
        kill_process(Pid::from_raw(id).unwrap(), Signal::TERM).unwrap();
        let mut rest = String::new();
        while let Some(line) = self.log.next_line().await.unwrap() {
            rest += &line;
            rest += "\n";
        }
        (self.process.wait().await.unwrap().code(), rest)
    }
}
