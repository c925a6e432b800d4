//! The server under a service manager, which listens on a real socket.

use binnacle_server_testing::program::command;
use rustix::process::{Pid, Signal, kill_process};
use std::os::unix::net::UnixDatagram;
use std::path::Path;
use std::time::Duration;

#[test]
fn a_service_manager_learns_that_the_server_is_up_and_stops() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("notify");
    let manager = UnixDatagram::bind(&path).unwrap();
    let patience = Some(Duration::from_mins(1));
    manager.set_read_timeout(patience).unwrap();
    let mut server = serve(folder.path(), &path);
    assert_eq!(next_message(&manager), "READY=1\n");
    let id = i32::try_from(server.id()).unwrap();
    kill_process(Pid::from_raw(id).unwrap(), Signal::TERM).unwrap();
    assert_eq!(next_message(&manager), "STOPPING=1\n");
    assert!(server.wait().unwrap().success());
}

fn serve(folder: &Path, notify: &Path) -> std::process::Child {
    let arguments = ["serve", "--listen", "127.0.0.1:0"];
    command(env!("CARGO_BIN_EXE_binnacle-server"), folder, &arguments)
        .env("NOTIFY_SOCKET", notify)
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap()
}

fn next_message(manager: &UnixDatagram) -> String {
    let mut buffer = [0; 4096];
    let length = manager.recv(&mut buffer).expect("the server says nothing");
    String::from_utf8(buffer[..length].to_vec()).unwrap()
}
