"""The real agent, enrolled at a server on loopback that gives it a model and takes what it sends.

Benchmarks of the agent share it: the server answers as the real one does, and stores nothing.
"""

import contextlib
import http.server
import json
import os
import subprocess
import tempfile
import threading

STREAM = "01934f2a-7c00-7000-8000-00000000002a"
SERVER_TIME = "2026-11-21T07:00:00Z"
SETTINGS = {
    "version": 1, "min_sog_kn": 4.0, "max_rate_of_turn_deg_min": 18.0, "settle_s": 0,
    "max_swing_deg": 2.0, "sample_s": 10, "seal_s": 10,
}
# Standard errors of 0.2 µT, 0.005 and 0.2° in the order of the parameters; no correlation.
ERRORS = [200.0, 0.005, 200.0, 0.005, 0.005, 0.005, 0.005, 0.0035]
MODEL = {
    "id": "01934f2a-7c00-7000-8000-000000000009", "version": 3,
    "data_until": "2026-11-20T00:00:00Z",
    "model": {
        "parameters_over_lambda": {
            "bx_nt": 1500.0, "chi13": 0.01, "by_nt": -800.0, "chi23": 0.0,
            "chi11_minus_chi22": 0.06, "chi12": 0.005, "chi21": 0.005,
        },
        "constant_deg": 0.5,
        "covariance": [[ERRORS[row] ** 2 if row == column else 0.0 for column in range(8)]
                       for row in range(8)],
        "identifiable": None, "rms_deg": 0.4, "samples_used": 500, "samples_rejected": 3,
        "quality": None, "reference_grade": "heading",
    },
}


class Server(http.server.BaseHTTPRequestHandler):
    """Takes every batch, and answers with the model."""

    protocol_version = "HTTP/1.1"
    batches = 0

    def reply(self, content):
        body = json.dumps(content).encode()
        self.send_response(200)
        self.send_header("content-length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def downlink(self, contiguous):
        self.reply({"contiguous_seq": contiguous, "settings": SETTINGS, "model": MODEL,
                    "server_time": SERVER_TIME})

    def body(self):
        self.rfile.read(int(self.headers.get("content-length", 0)))

    def do_POST(self):
        self.body()
        self.reply({"token": "t", "stream": STREAM, "vessel_name": "Bench",
                    "compass_name": "Standard compass", "server_time": SERVER_TIME})

    def do_PUT(self):
        self.body()
        Server.batches += 1
        self.downlink(int(self.path.split("?")[0].rsplit("/", 1)[1]))

    def do_GET(self):
        self.downlink(Server.batches)

    def log_message(self, *_):
        pass


def sentence(text):
    """Frames the text between $ and *."""
    check = 0
    for byte in text.encode():
        check ^= byte
    return f"${text}*{check:02X}\r\n".encode()


@contextlib.contextmanager
def running(agent, configuration):
    """Enrols the agent, runs it, and gives its process."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Server)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with tempfile.TemporaryDirectory() as folder:
        config = os.path.join(folder, "agent.toml")
        with open(config, "w", encoding="utf-8") as file:
            file.write(f'data_dir = "state"\n{configuration}')
        url = f"http://127.0.0.1:{server.server_address[1]}"
        subprocess.run([agent, "enrol", "--server", url, "--code", "BENCH", "--config", config],
                       check=True, stdout=subprocess.DEVNULL)
        process = subprocess.Popen([agent, "run", "--config", config],
                                   stderr=subprocess.DEVNULL)
        try:
            yield process
        finally:
            process.terminate()
            process.wait()
            server.shutdown()
