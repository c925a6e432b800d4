#!/usr/bin/env python3
"""How long a compass reading takes through the agent, from its datagram to the heading's.

    scripts/agent-latency.py [AGENT [SECONDS]]

Sends ten readings a second over UDP to the agent (target/release/binnacle-agent, 120 seconds
by default) while the ship turns through 360° a minute, and takes the time until the
corrected heading made of each reading arrives over UDP. Prints percentiles in milliseconds,
and the turn that they mean at that rate, as JSON.
"""

import bisect
import json
import socket
import sys
import threading
import time

from agent_under_test import running, sentence

RATE_HZ = 10
TURN_DEG_S = 6.0
WARM_UP_S = 10


def receive(receiver, arrivals):
    """Notes when the first heading made of each reading arrives."""
    while True:
        datagram = receiver.recv(2048)
        now = time.monotonic()
        for line in datagram.decode().splitlines():
            fields = line.split(",")
            if fields[0] == "$IIHDG" and fields[1]:
                arrivals.append((float(fields[1]), now))


def percentile(ordered, share):
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        return taken.getsockname()[1]


def main():
    agent = sys.argv[1] if len(sys.argv) > 1 else "target/release/binnacle-agent"
    seconds = int(sys.argv[2]) if len(sys.argv) > 2 else 120
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    receiver.bind(("127.0.0.1", 0))
    arrivals = []
    threading.Thread(target=receive, args=(receiver, arrivals), daemon=True).start()
    bridge = ("127.0.0.1", free_port())
    configuration = f"""
[inputs.bridge]
udp = "{bridge[0]}:{bridge[1]}"
[output]
udp = "127.0.0.1:{receiver.getsockname()[1]}"
interval_s = 0.05
"""
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sent = []
    with running(agent, configuration):
        start = time.monotonic()
        for count in range((WARM_UP_S + seconds) * RATE_HZ):
            due = start + count / RATE_HZ
            time.sleep(max(0, due - time.monotonic()))
            reading = round(TURN_DEG_S * count / RATE_HZ % 360, 1)
            if count % RATE_HZ == 0:
                at = time.gmtime()
                clock, date = time.strftime("%H%M%S", at), time.strftime("%d%m%y", at)
                position = f"GPRMC,{clock}.00,A,4330.000,N,00300.000,W,12.0,100.0,{date},,,A"
                sender.sendto(sentence(position), bridge)
            sent.append((reading, time.monotonic()))
            sender.sendto(sentence(f"HCHDG,{reading:.1f},,,,"), bridge)
        time.sleep(1)
    # Readings repeat after a minute: each is answered by the first arrival after it.
    by_reading = {}
    for reading, arrived in arrivals:
        by_reading.setdefault(reading, []).append(arrived)
    delays, lost = [], 0
    for reading, at in sent[WARM_UP_S * RATE_HZ:]:
        times = by_reading.get(reading, [])
        first = bisect.bisect_left(times, at)
        if first < len(times) and times[first] < at + 1:
            delays.append(1e3 * (times[first] - at))
        else:
            lost += 1
    if not delays:
        sys.exit("no heading arrived")
    delays.sort()
    p99_ms = percentile(delays, 0.99)
    print(json.dumps({
        "readings": len(delays), "without_a_heading_within_1_s": lost,
        "p50_ms": round(percentile(delays, 0.5), 2), "p99_ms": round(p99_ms, 2),
        "max_ms": round(delays[-1], 2), "p99_deg": round(TURN_DEG_S * p99_ms / 1e3, 3),
    }))


if __name__ == "__main__":
    main()
