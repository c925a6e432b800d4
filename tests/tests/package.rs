//! The agent's Debian package: installed, upgraded, removed and purged by dpkg
//! in a copy of this system.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use anyhow::{Context, Result, ensure};
use binnacle_tests::process::namespace::in_own_mounts;
use std::path::{Path, PathBuf};
use std::process::Command;

const CONFIG: &str = "etc/binnacle/agent.toml";

#[test]
fn the_package_can_be_reinstalled_and_keeps_the_agents_data() {
    in_own_mounts(
        "the_package_can_be_reinstalled_and_keeps_the_agents_data",
        async { installed() },
    );
}

fn installed() -> Result<()> {
    let has = |program: &str| Path::new("/usr/bin").join(program).exists();
    let has_debian = has("dpkg-deb") && has("systemd-sysusers");
    if !rustix::process::geteuid().is_root() || !has_debian {
        println!("not shown here: it takes root, dpkg and systemd-sysusers");
        return Ok(());
    }
    let folder = tempfile::tempdir()?;
    let copy = Copy::of_this_system(folder.path())?;
    let package = copy.package()?;
    copy.dpkg("-i", &package)?;
    let calls = copy.calls()?;
    ensure!(calls == ["--system daemon-reload"], "{calls:?}");
    let data = "/var/lib/binnacle-agent";
    copy.run(&format!(
        "[ \"$(stat -c '%U %a' {data})\" = 'binnacle-agent 700' ]
         runuser -u binnacle-agent -- touch {data}/spool.db
         zcat /usr/share/man/man1/binnacle-agent-enrol.1.gz | grep -q 'URL of the server'"
    ))?;
    copy.run(
        "if command -v systemd-analyze; then
         systemd-analyze verify /usr/lib/systemd/system/binnacle-agent.service; fi",
    )?;
    let config = copy.root.join(CONFIG);
    let edited = std::fs::read_to_string(&config)? + "# the owner's\n";
    std::fs::write(&config, &edited)?;
    let kept = copy.root.join("var/lib/binnacle-agent/spool.db");
    std::fs::write(&kept, "samples")?;

    copy.dpkg("-i", &package)?;
    let calls = copy.calls()?;
    let restarts = "try-restart binnacle-agent.service";
    ensure!(
        calls.last().is_some_and(|call| call == restarts),
        "{calls:?}"
    );
    ensure!(std::fs::read_to_string(&config)? == edited);

    copy.dpkg("-r", "binnacle-agent")?;
    let calls = copy.calls()?;
    ensure!(calls[0] == "stop binnacle-agent.service", "{calls:?}");
    ensure!(!copy.root.join("usr/bin/binnacle-agent").exists());
    ensure!(std::fs::read_to_string(&config)? == edited);
    copy.dpkg("-P", "binnacle-agent")?;
    ensure!(!config.exists());
    ensure!(std::fs::read(&kept)? == b"samples");
    Ok(())
}

/// A copy of this system as an overlay that takes all changes, with a service
/// manager that only records its calls.
struct Copy {
    root: PathBuf,
}

impl Copy {
    fn of_this_system(folder: &Path) -> Result<Copy> {
        mount(&["-t", "tmpfs", "tmpfs"], folder)?;
        let [upper, work, root] = ["upper", "work", "root"].map(|name| folder.join(name));
        for path in [&upper, &work, &root] {
            std::fs::create_dir(path)?;
        }
        let (upper, work) = (upper.display(), work.display());
        let layers = format!("lowerdir=/,upperdir={upper},workdir={work}");
        mount(&["-t", "overlay", "-o", &layers, "overlay"], &root)?;
        mount(&["--bind", "/proc"], &root.join("proc"))?;
        std::fs::create_dir_all(root.join("run/systemd/system"))?;
        let copy = Copy { root };
        copy.run(
            // A container's policy may be that nothing is started.
            "rm -f /usr/sbin/policy-rc.d
             printf '#!/bin/sh\\necho \"$*\" >>/asked\\n' >/usr/local/bin/systemctl
             chmod 755 /usr/local/bin/systemctl",
        )?;
        Ok(copy)
    }

    /// Builds the package around a program that does nothing, which lintian checks if it is
    /// installed; returns its path in the copy.
    fn package(&self) -> Result<String> {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scripts/deb");
        let into = self.root.join("packages");
        let made = Command::new(script)
            .args(["--of", "/bin/true"])
            .arg(&into)
            .output()?;
        ensure!(made.status.success(), "{made:?}");
        let path = PathBuf::from(String::from_utf8(made.stdout)?.trim());
        let name = path.file_name().context("a package")?;
        Ok(Path::new("/packages").join(name).display().to_string())
    }

    fn dpkg(&self, action: &str, what: &str) -> Result<()> {
        std::fs::write(self.root.join("asked"), "")?;
        self.run(&format!("dpkg {action} {what}"))
    }

    /// The calls of the service manager by the last action.
    fn calls(&self) -> Result<Vec<String>> {
        let asked = std::fs::read_to_string(self.root.join("asked"))?;
        Ok(asked.lines().map(str::to_owned).collect())
    }

    fn run(&self, script: &str) -> Result<()> {
        let done = Command::new("chroot")
            .arg(&self.root)
            .args(["/bin/sh", "-e", "-c", script])
            .env("PATH", "/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin")
            .output()?;
        ensure!(done.status.success(), "{script}: {done:?}");
        Ok(())
    }
}

fn mount(arguments: &[&str], place: &Path) -> Result<()> {
    let status = Command::new("mount").args(arguments).arg(place).status()?;
    ensure!(status.success(), "mount {arguments:?}: {status}");
    Ok(())
}
