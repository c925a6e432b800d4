#!/usr/bin/env python3
"""What the agent takes of a computer: memory and processor at 50 sentences a second.

    scripts/agent-load.py [AGENT [SECONDS]]

Plays instruments over TCP in real time to the agent (target/release/binnacle-agent, 300
seconds by default), enrolled at a made-up shore on loopback that takes what it sends
every ten seconds, and prints what /proc says as JSON. The first ten seconds, in which the
agent starts, count for memory and not for the processor.
"""

import http.server
import json
import math
import os
import socket
import subprocess
import sys
import tempfile
import threading
import time

STREAM = "01934f2a-7c00-7000-8000-00000000002a"
SETTINGS = {
    "version": 1, "min_sog_kn": 4.0, "max_rate_of_turn_deg_min": 18.0, "settle_s": 0,
    "max_swing_deg": 2.0, "sample_s": 10, "seal_s": 10,
}
WARM_UP_S = 10
batches = 0


class Shore(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def reply(self, answer):
        body = json.dumps(answer).encode()
        self.send_response(200)
        self.send_header("content-length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def downlink(self, contiguous):
        self.reply({"contiguous_seq": contiguous, "settings": SETTINGS,
                    "server_time": "2026-11-21T07:00:00Z"})

    def body(self):
        self.rfile.read(int(self.headers.get("content-length", 0)))

    def do_POST(self):
        self.body()
        self.reply({"token": "t", "stream": STREAM, "vessel_name": "Load",
                    "compass_name": "Standard compass",
                    "server_time": "2026-11-21T07:00:00Z"})

    def do_PUT(self):
        global batches
        self.body()
        batches += 1
        self.downlink(int(self.path.split("?")[0].rsplit("/", 1)[1]))

    def do_GET(self):
        self.downlink(batches)

    def log_message(self, *_):
        pass


def sentence(text):
    check = 0
    for octet in text.encode():
        check ^= octet
    return f"${text}*{check:02X}\r\n".encode()


def second(now):
    """One RMC, ten each of HDG, both THS and ROT, nine of XDR: fifty sentences."""
    at = time.gmtime(now)
    heading = 100 + 0.5 * math.sin(now / 7)
    clock, date = time.strftime("%H%M%S", at), time.strftime("%d%m%y", at)
    yield sentence(f"GPRMC,{clock}.00,A,4330.000,N,00300.000,W,12.0,100.0,{date},,,A")
    for tenth in range(10):
        yield sentence(f"HCHDG,{heading - 3:.1f},,,,")
        yield sentence(f"HETHS,{heading:.1f},A")
        yield sentence(f"GPTHS,{heading + 0.3:.1f},A")
        yield sentence("TIROT,0.5,A")
        if tenth:
            yield sentence("IIXDR,A,1.5,D,ROLL")


def play(listener):
    connection, _ = listener.accept()
    due = time.time()
    while True:
        try:
            connection.sendall(b"".join(second(due)))
        except OSError:
            return
        due += 1
        time.sleep(max(0, due - time.time()))


def cpu_s(pid):
    fields = open(f"/proc/{pid}/stat").read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def memory_mb(pid, name):
    for line in open(f"/proc/{pid}/status"):
        if line.startswith(name):
            return int(line.split()[1]) * 1024 / 1e6
    return math.nan


def main():
    agent = sys.argv[1] if len(sys.argv) > 1 else "target/release/binnacle-agent"
    seconds = int(sys.argv[2]) if len(sys.argv) > 2 else 300
    shore = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Shore)
    threading.Thread(target=shore.serve_forever, daemon=True).start()
    listener = socket.create_server(("127.0.0.1", 0))
    threading.Thread(target=play, args=(listener,), daemon=True).start()
    with tempfile.TemporaryDirectory() as folder:
        config = os.path.join(folder, "agent.toml")
        with open(config, "w") as file:
            file.write(f"""data_dir = "state"
[inputs.bridge]
tcp = "127.0.0.1:{listener.getsockname()[1]}"
[output]
tcp_server = "127.0.0.1:0"
[page]
listen = "127.0.0.1:0"
""")
        url = f"http://127.0.0.1:{shore.server_address[1]}"
        subprocess.run([agent, "enrol", "--server", url, "--code", "LOAD", "--config", config],
                       check=True, stdout=subprocess.DEVNULL)
        process = subprocess.Popen([agent, "run", "--config", config],
                                   stderr=subprocess.DEVNULL)
        time.sleep(WARM_UP_S)
        began, before = time.time(), cpu_s(process.pid)
        time.sleep(seconds)
        used, passed = cpu_s(process.pid) - before, time.time() - began
        told = {
            "seconds": round(passed), "sentences_a_second": len(list(second(0))),
            "batches": batches, "cpu_percent": round(100 * used / passed, 2),
            "resident_mb": round(memory_mb(process.pid, "VmRSS"), 1),
            "most_resident_mb": round(memory_mb(process.pid, "VmHWM"), 1),
        }
        process.terminate()
        process.wait()
    print(json.dumps(told))


if __name__ == "__main__":
    main()
