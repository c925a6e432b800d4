//! The agent under a service manager, which listens on a real socket.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use common::agent::Agent;
use common::bridge::Bridge;
use std::time::Duration;
use tempfile::TempDir;
use tokio::net::UnixDatagram;
use tokio::time::timeout;

/// A service manager's end of the notifications.
struct Manager {
    socket: UnixDatagram,
    _folder: TempDir,
}

impl Manager {
    /// Returns the lines of the next message.
    async fn next_message(&self) -> Vec<String> {
        let mut buffer = [0; 4096];
        let received = timeout(Duration::from_secs(30), self.socket.recv(&mut buffer));
        let length = received.await.expect("the agent says nothing").unwrap();
        let text = String::from_utf8(buffer[..length].to_vec()).unwrap();
        text.lines().map(str::to_owned).collect()
    }
}

#[tokio::test]
async fn a_service_manager_learns_that_the_agent_is_up_works_and_stops() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("notify");
    let manager = Manager {
        socket: UnixDatagram::bind(&path).unwrap(),
        _folder: folder,
    };
    let bridge = Bridge::new(0).await;
    let agent = Agent::new(bridge.address);
    let running = agent.run_with("NOTIFY_SOCKET", &path).await;
    assert_eq!(manager.next_message().await, ["READY=1"]);
    let first = manager.next_message().await;
    assert_eq!(first[0], "WATCHDOG=1");
    assert!(
        first[1].starts_with("STATUS=the heading is not corrected:")
            && first[1].contains("link not enrolled, 0 batches to send"),
        "{first:?}"
    );
    let next = manager.next_message().await;
    assert_eq!(next[0], "WATCHDOG=1", "{next:?}");
    running.terminate().await;
    let mut last = manager.next_message().await;
    while last[0] == "WATCHDOG=1" {
        last = manager.next_message().await;
    }
    assert_eq!(last, ["STOPPING=1"]);
}
