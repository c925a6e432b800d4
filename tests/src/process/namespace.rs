//! Runs tests that need a network or mounts of their own.

use anyhow::Result;
use std::future::Future;

/// Set in a test that already has its namespace.
const OWN: &str = "BINNACLE_TEST_OWN_NAMESPACE";

/// Runs `body` in a new, isolated network, by starting this test again in one.
/// `test` is its name.
///
/// # Panics
/// Panics when the system gives no network (it takes root, or unprivileged user
/// namespaces), or `body` fails.
pub fn in_own_network(test: &str, body: impl Future<Output = Result<()>>) {
    in_own("--net", test, body);
}

/// Runs `body` with mounts of its own, in the same way.
///
/// # Panics
/// As [`in_own_network`].
pub fn in_own_mounts(test: &str, body: impl Future<Output = Result<()>>) {
    in_own("--mount", test, body);
}

fn in_own(namespace: &str, test: &str, body: impl Future<Output = Result<()>>) {
    if std::env::var_os(OWN).is_some() {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .enable_all()
            .build()
            .expect("a runtime");
        runtime.block_on(body).expect("the test holds");
        return;
    }
    let this = std::env::current_exe().expect("the path of this test");
    let is_root = rustix::process::geteuid().is_root();
    let as_root: &[&str] = if is_root {
        &[]
    } else {
        &["--user", "--map-root-user"]
    };
    let status = std::process::Command::new("unshare")
        .args(as_root)
        .arg(namespace)
        .arg(this)
        .args(["--exact", test, "--nocapture"])
        .env(OWN, "1")
        .status()
        .expect("unshare, of util-linux");
    assert!(
        status.success(),
        "{test} in a namespace of its own: {status}. If that could not be made: be root, or \
         allow user namespaces"
    );
}
