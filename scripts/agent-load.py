#!/usr/bin/env python3
"""What the agent takes of a computer: memory and processor at 50 sentences a second.

    scripts/agent-load.py [AGENT [SECONDS]]

Plays instruments over TCP in real time to the agent (target/release/binnacle-agent, 300
seconds by default), which has a model, sends its heading to a client, and seals and sends
a batch every ten seconds. Prints its memory each minute, and at the end what /proc says as
JSON. The first ten seconds, in which the agent starts, count for memory and not for the
processor. The exit code is 1 if the agent died.
"""

import json
import math
import os
import random
import socket
import sys
import threading
import time

from agent_under_test import Server, running, sentence

WARM_UP_S = 10
MINUTE_S = 60


def second(now):
    """One RMC, ten each of HDG, both THS and ROT, nine of XDR: fifty sentences."""
    at = time.gmtime(now)
    heading = 100 + 0.5 * math.sin(now / 7)
    clock, date = time.strftime("%H%M%S", at), time.strftime("%d%m%y", at)
    yield sentence(f"GPRMC,{clock}.00,A,4330.000,N,00300.000,W,12.0,100.0,{date},,,A")
    for tenth in range(10):
        # Each has noise of its own: what shares the compass's is no reference.
        noise = [random.gauss(0, 0.2) for _ in range(3)]
        yield sentence(f"HCHDG,{heading - 3 + noise[0]:.1f},,,,")
        yield sentence(f"HETHS,{heading + noise[1]:.1f},A")
        yield sentence(f"GPTHS,{heading + 0.3 + noise[2]:.1f},A")
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


def receive(address, heard):
    """Reads what the agent sends, as an autopilot does."""
    while True:
        try:
            with socket.create_connection(address) as connection:
                while chunk := connection.recv(4096):
                    heard.append(chunk.count(b"HDG"))
        except OSError:
            time.sleep(0.1)


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return listener.getsockname()[1]


def cpu_s(pid):
    with open(f"/proc/{pid}/stat", encoding="utf-8") as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def memory_mb(pid, name):
    with open(f"/proc/{pid}/status", encoding="utf-8") as status:
        for line in status:
            if line.startswith(name):
                return int(line.split()[1]) * 1024 / 1e6
    return math.nan


def main():
    agent = sys.argv[1] if len(sys.argv) > 1 else "target/release/binnacle-agent"
    seconds = int(sys.argv[2]) if len(sys.argv) > 2 else 300
    listener = socket.create_server(("127.0.0.1", 0))
    threading.Thread(target=play, args=(listener,), daemon=True).start()
    output = ("127.0.0.1", free_port())
    heard = []
    threading.Thread(target=receive, args=(output, heard), daemon=True).start()
    configuration = f"""
[inputs.bridge]
tcp = "127.0.0.1:{listener.getsockname()[1]}"
[output]
tcp_server = "{output[0]}:{output[1]}"
interval_s = 0.1
[page]
listen = "127.0.0.1:0"
"""
    with running(agent, configuration) as process:
        time.sleep(WARM_UP_S)
        began, before = time.time(), cpu_s(process.pid)
        minutes = []
        while (left := seconds - (time.time() - began)) > 0 and process.poll() is None:
            time.sleep(min(MINUTE_S, left))
            if process.poll() is None:
                minutes.append(memory_mb(process.pid, "VmRSS"))
                passed = (time.time() - began) / 60
                print(f"{passed:6.1f} min  {minutes[-1]:6.2f} MB", flush=True)
        if process.poll() is not None:
            sys.exit(f"the agent died with code {process.returncode}")
        used, passed = cpu_s(process.pid) - before, time.time() - began
        print(json.dumps({
            "seconds": round(passed), "sentences_a_second": len(list(second(0))),
            "headings_sent": sum(heard), "batches": Server.batches,
            "cpu_percent": round(100 * used / passed, 2),
            "resident_mb": round(minutes[-1], 1),
            "first_minute_mb": round(minutes[0], 1),
            "most_resident_mb": round(memory_mb(process.pid, "VmHWM"), 1),
        }))


if __name__ == "__main__":
    main()
