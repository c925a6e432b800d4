"""Batches as the real agent seals and sends them on a simulated voyage."""

import http.server
import json
import socket
import subprocess
import tempfile
import threading
import time
from pathlib import Path

STREAM = "01934f2a-7c00-7000-8000-00000000002a"
NOW = "2026-11-21T07:00:00Z"
# Seconds without a request after which the voyage is over and every batch was sent.
QUIET_S = 5.0
# Sentences go to the agent no faster than this: it seals by the ship's clock when it has
# read what has come, and must not read an hour at once.
BYTES_A_SECOND = 2_000_000
PIECE = 2_048


class Server(http.server.ThreadingHTTPServer):
    """Accepts every batch, and acknowledges it."""

    daemon_threads = True

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Handler)
        self.batches, self.last_request = {}, time.monotonic()
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def contiguous(self):
        seq = 0
        while seq + 1 in self.batches:
            seq += 1
        return seq


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def reply(self, content):
        body = json.dumps(content).encode()
        self.send_response(200)
        self.send_header("content-length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def body(self):
        return self.rfile.read(int(self.headers.get("content-length", 0)))

    def do_POST(self):
        self.body()
        self.reply({"token": "t", "stream": STREAM, "vessel_name": "Bench",
                    "compass_name": "Standard compass", "server_time": NOW})

    def do_PUT(self):
        seq = int(self.path.split("?")[0].rsplit("/", 1)[1])
        self.server.batches[seq] = self.body()
        self.server.last_request = time.monotonic()
        self.do_GET()

    def do_GET(self):
        self.reply({"contiguous_seq": self.server.contiguous(), "server_time": NOW})

    def log_message(self, *_):
        pass


def config(profile, feed):
    return f"""data_dir = "state"
[inputs.bridge]
tcp = "{feed}"
[roles]
compass = [{{ input = "bridge", talker = "HC", sentence = "HDG" }}]
gyro = [{{ input = "bridge", talker = "HE", sentence = "THS" }}]
satellite = [{{ input = "bridge", talker = "GP", sentence = "THS" }}]
position = [{{ input = "bridge", talker = "GP", sentence = "RMC" }}]
rate_of_turn = [{{ input = "bridge", sentence = "ROT" }}]
[page]
listen = "127.0.0.1:0"
[uplink]
profile = "{profile}"
retry_min_s = 0.1
retry_max_s = 0.5
"""


def play(bridge, line):
    """The ship's sentences onto a connection, evenly."""
    began, sent = time.monotonic(), 0
    while piece := bridge.read(PIECE):
        line.sendall(piece)
        sent += len(piece)
        ahead = began + sent / BYTES_A_SECOND - time.monotonic()
        if ahead > 0:
            time.sleep(ahead)


def sail(programs, scenario, profile, days):
    """The frames of a voyage, in order: simulator, TCP, agent, HTTP, all real."""
    server, feed = Server(), socket.create_server(("127.0.0.1", 0))
    with tempfile.TemporaryDirectory() as folder:
        settings, log = Path(folder) / "agent.toml", Path(folder) / "log"
        settings.write_text(config(profile, f"127.0.0.1:{feed.getsockname()[1]}"))
        agent = [programs / "binnacle-agent"]
        url = f"http://127.0.0.1:{server.server_port}"
        with open(log, "w", encoding="utf-8") as words:
            enrol = ["enrol", "--config", settings, "--server", url, "--code", "C"]
            subprocess.run([*agent, *enrol], check=True, stdout=words, stderr=words)
            running = subprocess.Popen([*agent, "run", "--config", settings], stderr=words)
        bridge = subprocess.Popen(
            [programs / "binnacle-simulator", "voyage", "--scenario", scenario, "--seed", "11",
             "--days", str(days), "--out", "/dev/stdout"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        try:
            line, _ = feed.accept()
            with line:
                play(bridge.stdout, line)
                server.last_request = time.monotonic()
                while time.monotonic() - server.last_request < QUIET_S:
                    time.sleep(0.2)
            if running.poll() is not None or bridge.wait() != 0:
                raise SystemExit(f"a program failed: {log.read_text()}")
        finally:
            for program in (running, bridge):
                program.kill()
                program.wait()
            server.shutdown()
            feed.close()
    if server.contiguous() != len(server.batches) or not server.batches:
        raise SystemExit(f"{len(server.batches)} batches arrived, not all of them")
    return [server.batches[seq] for seq in sorted(server.batches)]
