//! The programs under test, as processes.

use anyhow::{Context, Result, ensure};
use std::ffi::OsStr;
use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use tokio::io::AsyncWriteExt;
use tokio::process::{Child, Command};

/// Returns the path of a program built with these tests.
///
/// # Errors
/// Fails when it is missing: cargo builds a package's own programs only.
pub fn path(name: &str) -> Result<PathBuf> {
    let tests = std::env::current_exe().context("the path of this test")?;
    let folder = tests
        .ancestors()
        .nth(2)
        .context("the test lies in target/PROFILE/deps")?;
    let program = folder.join(name);
    ensure!(
        program.is_file(),
        "{} is missing: run `make test`, or `cargo build --workspace` first",
        program.display()
    );
    Ok(program)
}

/// Returns a command for one of the programs, without the caller's settings.
///
/// # Errors
/// Fails when the program is missing.
pub fn command(name: &str) -> Result<Command> {
    let mut command = Command::new(path(name)?);
    without_settings(&mut command);
    command.stdin(Stdio::null()).kill_on_drop(true);
    Ok(command)
}

/// Removes the caller's settings from a command.
pub(crate) fn without_settings(command: &mut Command) {
    for (variable, _) in std::env::vars_os() {
        if variable.to_string_lossy().starts_with("BINNACLE_") {
            command.env_remove(variable);
        }
    }
}

/// Runs a program to its end.
///
/// # Errors
/// Fails when it cannot be started.
pub async fn output_of(
    name: &str,
    arguments: impl IntoIterator<Item = impl AsRef<OsStr>>,
) -> Result<Output> {
    let mut command = command(name)?;
    command.args(arguments);
    command
        .output()
        .await
        .with_context(|| format!("running {name}"))
}

/// Runs a program to its end with something on its standard input.
///
/// # Errors
/// Fails when it cannot be started, or fails.
pub async fn run_with_input(mut command: Command, input: &str) -> Result<String> {
    command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command.spawn()?;
    let mut stdin = child.stdin.take().context("standard input was asked for")?;
    match stdin.write_all(input.as_bytes()).await {
        // A program that reads nothing may have ended by now.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {}
        written => written?,
    }
    drop(stdin);
    let output = child.wait_with_output().await?;
    let errors = String::from_utf8_lossy(&output.stderr);
    ensure!(
        output.status.success(),
        "{:?} failed: {errors}",
        command.as_std()
    );
    Ok(String::from_utf8(output.stdout)?)
}

/// A program that runs until it is killed. If a test fails before that, the end
/// of its log is shown.
#[derive(Debug)]
pub struct Program {
    name: String,
    child: Child,
    log: PathBuf,
    /// Bytes of the log from earlier runs.
    before: usize,
    /// True after an intended end.
    done: bool,
}

impl Program {
    /// Starts a command; standard error goes to the end of `log`.
    ///
    /// # Errors
    /// Fails when it cannot be started.
    pub fn start(name: &str, mut command: Command, log: &Path) -> Result<Program> {
        let errors = File::options()
            .create(true)
            .append(true)
            .open(log)
            .with_context(|| log.display().to_string())?;
        let before = errors.metadata()?.len() as usize;
        let child = command
            .stderr(errors)
            .spawn()
            .with_context(|| format!("starting {name}"))?;
        Ok(Program {
            name: name.to_owned(),
            child,
            log: log.to_owned(),
            before,
            done: false,
        })
    }

    /// The process itself.
    pub fn child(&mut self) -> &mut Child {
        &mut self.child
    }

    /// Returns its standard error since the start.
    pub fn log(&self) -> String {
        let bytes = std::fs::read(&self.log).unwrap_or_default();
        String::from_utf8_lossy(bytes.get(self.before..).unwrap_or_default()).into_owned()
    }

    /// True while the process runs.
    ///
    /// # Errors
    /// Fails when the system does not tell.
    pub fn is_running(&mut self) -> Result<bool> {
        Ok(self.child.try_wait()?.is_none())
    }

    /// Marks an intended end.
    pub fn done(&mut self) {
        self.done = true;
    }

    /// Kills the process with signal 9, so that it cannot clean up.
    ///
    /// # Errors
    /// Fails when it had ended before.
    pub async fn kill(mut self) -> Result<()> {
        ensure!(self.is_running()?, "{} had ended by itself", self.name);
        self.child.kill().await?;
        self.done = true;
        Ok(())
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        if self.done {
            return;
        }
        let log = self.log();
        let lines: Vec<&str> = log.lines().collect();
        let tail = lines[lines.len().saturating_sub(40)..].join("\n");
        // Shown with the failing test's output.
        println!("-- the end of {}'s log:\n{tail}", self.name);
    }
}
