"""A satellite link between this network namespace and a new one, the ship's.

    link.py        (as root of a network namespace; needs /dev/net/tun and ip(8))

Packets that leave one end of the link arrive at the other as late, as seldom and
as slowly as asked for, and are counted. The ship also has a cable to here, on which
nothing is lost or counted: its instruments.

              the link            the cable
    server    10.77.0.1           10.78.0.1
    ship      10.77.0.2           10.78.0.2

Prints {"ship": PID} when both are up: whatever `nsenter --net --target PID` runs is
on board. Then takes lines of JSON: settings to change, or {"tally": true}, which is
which prints a line with the IP packets and bytes put on the link so far, lost ones
included. The end of its input is the end of the link.

    up             whether anything passes at all; what is sent meanwhile is lost
    round_trip_ms  half of it each way
    loss           the share of packets that get lost, each way
    bits_per_s     each way; 0 is without limit. Sixteen packets may wait.
"""

import ctypes
import fcntl
import heapq
import json
import os
import random
import select
import signal
import socket
import struct
import subprocess
import sys
import time

CLONE_NEWNET = 0x40000000
TUNSETIFF = 0x400454CA
IFF_TUN = 0x0001
IFF_NO_PI = 0x1000
WAITING = 16
# The dice fall the same way in every run.
SEED = 20261121


def tun(name):
    end = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)
    fcntl.ioctl(end, TUNSETIFF, struct.pack("16sH22x", name.encode(), IFF_TUN | IFF_NO_PI))
    return end


def ip(*words):
    subprocess.run(["ip", *words], check=True, stdin=subprocess.DEVNULL, stdout=sys.stderr)


def bring_up(name, own, other):
    ip("address", "add", own, "peer", other, "dev", name)
    ip("link", "set", name, "up")


def enter_ship(parent):
    """The ship's namespace, until the parent is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if ctypes.CDLL(None, use_errno=True).unshare(CLONE_NEWNET) != 0:
        raise OSError(ctypes.get_errno(), "cannot make a network namespace")
    ip("link", "set", "lo", "up")
    end = tun("satellite")
    bring_up("satellite", "10.77.0.2", "10.77.0.1")
    socket.send_fds(parent, [b"link"], [end])
    parent.recv(1)  # the cable is laid
    bring_up("instruments", "10.78.0.2", "10.78.0.1")
    parent.send(b"ready")
    parent.recv(1)


class Way:
    """One direction of the link."""

    def __init__(self, source, sink):
        self.source = source
        self.sink = sink
        self.free_at = 0.0
        self.packets = 0
        self.bytes_sent = 0


class Link:
    def __init__(self, ways):
        self.ways = ways
        self.settings = {"up": True, "round_trip_ms": 0.0, "loss": 0.0, "bits_per_s": 0.0}
        self.dice = random.Random(SEED)
        self.under_way = []
        self.number = 0

    def take(self, way):
        while True:
            try:
                packet = os.read(way.source, 65536)
            except BlockingIOError:
                return
            # IPv6 has no peer here.
            if packet[0] >> 4 == 4:
                self.send(way, packet)

    def send(self, way, packet):
        way.packets += 1
        way.bytes_sent += len(packet)
        s = self.settings
        now = time.monotonic()
        takes = 8 * len(packet) / s["bits_per_s"] if s["bits_per_s"] else 0.0
        if not s["up"] or self.dice.random() < s["loss"]:
            return
        if way.free_at - now > WAITING * takes:
            return
        way.free_at = max(way.free_at, now) + takes
        due = way.free_at + s["round_trip_ms"] / 2000
        self.number += 1
        heapq.heappush(self.under_way, (due, self.number, way.sink, packet))

    def deliver(self):
        while self.under_way and self.under_way[0][0] <= time.monotonic():
            _, _, sink, packet = heapq.heappop(self.under_way)
            if self.settings["up"]:
                try:
                    os.write(sink, packet)
                except OSError:
                    pass  # lost, as on any link

    def wait(self):
        return max(0.0, self.under_way[0][0] - time.monotonic()) if self.under_way else None

    def command(self, line):
        asked = json.loads(line)
        if asked.pop("tally", False):
            ways = zip(("to_server", "to_ship"), self.ways)
            tally = {name: {"packets": w.packets, "bytes": w.bytes_sent} for name, w in ways}
            print(json.dumps(tally), flush=True)
        unknown = asked.keys() - self.settings.keys()
        if unknown:
            raise SystemExit(f"link.py: there is no setting {sorted(unknown)}")
        self.settings.update(asked)


def main():
    here, there = socket.socketpair()
    child = os.fork()
    if child == 0:
        here.close()
        enter_ship(there)
        os._exit(0)
    there.close()
    ip("link", "set", "lo", "up")
    server = tun("satellite")
    bring_up("satellite", "10.77.0.1", "10.77.0.2")
    _, [ship], _, _ = socket.recv_fds(here, 16, 1)
    os.set_blocking(ship, False)
    # The kernel takes the cable of an earlier link away some time after its namespace.
    subprocess.run(["ip", "link", "delete", "instruments"], check=False,
                   stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    ip("link", "add", "instruments", "type", "veth", "peer", "name", "instruments",
       "netns", str(child))
    bring_up("instruments", "10.78.0.1", "10.78.0.2")
    here.send(b"c")
    if here.recv(5) != b"ready":
        raise SystemExit("link.py: the ship's end did not come up")
    print(json.dumps({"ship": child}), flush=True)

    to_server, to_ship = Way(ship, server), Way(server, ship)
    link = Link([to_server, to_ship])
    lines = b""
    while True:
        readable, _, _ = select.select([0, ship, server], [], [], link.wait())
        if ship in readable:
            link.take(to_server)
        if server in readable:
            link.take(to_ship)
        if 0 in readable:
            read = os.read(0, 65536)
            if not read:
                break
            lines += read
            while b"\n" in lines:
                line, lines = lines.split(b"\n", 1)
                link.command(line)
        link.deliver()
    here.close()
    os.waitpid(child, 0)


if __name__ == "__main__":
    main()
