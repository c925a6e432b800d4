#!/usr/bin/env python3
"""How long a fleet's schedule takes: by the solver alone, and through the real server.

    scripts/bench-schedule.py solver
    scripts/bench-schedule.py server PROGRAM [VESSELS CALLS FIRMS]

`solver` builds and runs crates/schedule/examples/fleet.rs for the fleets of BENCHMARKS.md.
`server` starts PROGRAM (a binnacle-server) on a new SQLite database, enters a fleet over
its API (200 vessels, 6 calls each, 15 firms if not said), and times the schedule, the
needs and the fleet's calendar. Times are by the clock; the same fleet each time but for
its dates, which are ahead of today.
"""

import datetime
import http.client
import json
import os
import random
import socket
import subprocess
import sys
import tempfile
import time

FLEETS = [(200, 6, 15), (1000, 6, 15), (1000, 6, 60)]
SEEDS = (1, 2, 3)
PORTS = ["CNSGH", "SGSIN", "CNNBO", "HKHKG", "NLRTM", "BEANR", "DEHAM", "USLAX", "LKCMB", "ESVLC",
         "GRPIR", "BRSSZ", "ESALG", "USNYC", "JPTYO", "USHOU", "GBFXT", "FRLEH", "ITGOA", "AUMEL"]
PASSWORD = "six gulls over a green quay"


def solver():
    build = ["cargo", "run", "--quiet", "--release", "-p", "binnacle-schedule", "--example", "fleet"]
    for fleet in FLEETS:
        for seed in SEEDS:
            subprocess.run([*build, *map(str, (*fleet, seed))], check=True)


class Server:
    """A server of one's own, and an admin's requests to it."""

    def __init__(self, program, folder):
        self.program = program
        self.environment = {**os.environ, "BINNACLE_DATABASE_URL": f"sqlite://{folder}/bench.db"}
        self.cookie = None
        self.command("migrate")
        self.operator = self.command("admin", "create", "operator", "--name", "Bench")["operator_id"]
        who = ["--operator", self.operator, "--email", "a@bench.example", "--name", "A", "--role", "admin"]
        self.command("admin", "create", "user", *who, "--password-stdin", typed=PASSWORD + "\n")
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.running = subprocess.Popen(
            [program, "serve", "--listen", f"127.0.0.1:{self.port}"], env=self.environment,
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.running.stdout.readline()
        self.connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=600)
        self.ask("POST", "/session", {"email": "a@bench.example", "password": PASSWORD})

    def command(self, *words, typed=None):
        done = subprocess.run([self.program, *words], env=self.environment, input=typed, text=True,
                              capture_output=True, check=True)
        return json.loads(done.stdout) if words[0] == "admin" else None

    def ask(self, method, path, body=None, kind="application/json"):
        """The answer's text; JSON goes out unless the body is text already."""
        headers = {"content-type": kind, "x-binnacle-request": "1"}
        if self.cookie:
            headers["cookie"] = self.cookie
        sent = body if isinstance(body, str) or body is None else json.dumps(body)
        self.connection.request(method, f"/api/v1{path}", sent, headers)
        answer = self.connection.getresponse()
        text = answer.read().decode()
        if answer.status >= 300:
            sys.exit(f"bench-schedule: {method} {path}: {answer.status} {text[:300]}")
        self.cookie = self.cookie or (answer.headers.get("set-cookie") or "").split(";")[0]
        return text

    def timed(self, method, path, body=None):
        begun = time.monotonic()
        text = self.ask(method, path, body)
        return text, time.monotonic() - begun

    def stop(self):
        self.running.terminate()
        self.running.wait()


def enter(server, vessels, calls, firms):
    """Ships due within half a year, their calls, and firms with terms."""
    dice = random.Random(1)
    today = datetime.datetime.now(datetime.UTC).replace(minute=0, second=0, microsecond=0)
    lines = ["vessel,id,port,eta,etd,eta_uncertainty_h,etd_uncertainty_h"]
    for number in range(vessels):
        vessel = json.loads(server.ask("POST", "/vessels", {"name": f"Ship {number}"}))
        path = f"/vessels/{vessel['id']}"
        server.ask("PUT", f"{path}/particulars",
                   {"flag_state": "NO", "gross_tonnage": 24000, "trade": "bulk", "deviation_record": "kept"})
        adjusted = today - datetime.timedelta(days=730 - dice.uniform(6, 180))
        server.ask("POST", f"{path}/logbook",
                   {"kind": "adjustment", "from": adjusted.strftime("%Y-%m-%dT%H:%M:%SZ")})
        apart_h = 180 * 24 / calls
        for call in range(calls):
            begins_h = round(1 + apart_h * (call + dice.uniform(0, 0.6)))
            eta = today + datetime.timedelta(hours=begins_h)
            etd = eta + datetime.timedelta(hours=round(min(dice.uniform(14, 72), 0.35 * apart_h)))
            unsure_h = round(2 + begins_h * 46 / 4320)
            times = ",".join(at.strftime("%Y-%m-%dT%H:%M:%SZ") for at in (eta, etd))
            lines.append(f"{vessel['id']},{number}-{call},{dice.choice(PORTS)},{times},{unsure_h},{unsure_h}")
    for number in range(firms):
        made = server.command("admin", "create", "firm", "--name", f"Firm {number}",
                              "--operator", server.operator)
        ports = dice.sample(PORTS, dice.randint(3, 9))
        server.ask("PUT", f"/firms/{made['firm_id']}/terms", {
            "ports": [{"port": port, "travel_eur": dice.randint(0, 800)} for port in ports],
            "teams": dice.randint(1, 3), "jobs_a_team_day": dice.randint(1, 2),
            "fee_eur": dice.randint(1200, 3500), "lead_time_h": dice.randint(24, 120),
        })
    server.ask("POST", "/port-calls.csv", "\n".join(lines) + "\n", "text/csv")


def through_server(program, vessels=200, calls=6, firms=15):
    with tempfile.TemporaryDirectory() as folder:
        server = Server(program, folder)
        try:
            enter(server, vessels, calls, firms)
            text, took_s = server.timed("POST", "/schedule/solve")
            plan = json.loads(text)["plan"]
            _, needs_s = server.timed("GET", "/needs?limit=100")
            calendar, calendar_s = server.timed("GET", "/calendar.ics")
        finally:
            server.stop()
    print(f"{vessels} vessels × {calls} calls × {firms} firms: {len(plan['jobs'])} jobs, "
          f"{len(plan['unscheduled'])} unscheduled, gap {plan['gap_percent']:.3f} %, "
          f"optimal {plan['proven_optimal']}; solver {plan['solved_in_s']:.2f} s, "
          f"request {took_s:.2f} s; GET /needs {needs_s:.2f} s; "
          f"calendar {calendar_s:.2f} s, {calendar.count('BEGIN:VEVENT')} events")


def main():
    match sys.argv[1:]:
        case ["solver"]:
            solver()
        case ["server", program, *size] if len(size) in (0, 3):
            through_server(program, *map(int, size))
        case _:
            sys.exit(__doc__)


main()
