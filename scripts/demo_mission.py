#!/usr/bin/env python3
"""The shore side of `make demo`: firms, teams, port calls, binnacles, and orders in every state.

Called by scripts/demo once the simulated fleet has sailed. Everything is done by the public
API, as the people of the demo would do it, and by `binnacle-server import`. Eight coasters join
the simulated fleet: their samples are imported from tables, so that a compass which was
adjusted half a day ago can be read as it points since. Passwords come from the environment,
BINNACLE_PASSWORD for everyone.
"""

import argparse
import csv
import datetime
import http.cookiejar
import json
import math
import os
import random
import subprocess
import sys
import time
import urllib.error
import urllib.request

UTC = datetime.timezone.utc
DAY = datetime.timedelta(days=1)
HOUR = datetime.timedelta(hours=1)

# Share of the earth's field that reaches a coaster's compass: only the berth tells.
LAMBDA = 0.9
# The berth at Bilbao and the heading alongside.
BERTH = {"lat": 43.35, "lon": -3.04, "heading": 40.0}
HOME_PORT = "ESBIO"
# Two magnetic latitudes: without them induced and permanent magnetism cannot be told apart.
TURNS = [(43.6, -3.2), (10.0, -25.0)]
COASTERS = ["Nervión", "Ibaizabal", "Cadagua", "Bidasoa", "Urola", "Zadorra", "Oria", "Deba"]
# Ports of call of the simulated ships, the next first, and days from now to arrival.
CALLS = {
    "Cabo Verde Star": [("ZACPT", 9), ("NLRTM", 27)],
    "Baía de Santos": [("ESALG", 6), ("BRSSZ", 24)],
    "Kuroshio Maru": [("AUSYD", 5), ("JPYOK", 18)],
    "Östersjön": [("PLGDY", 4), ("FIHEL", 7), ("DEKEL", 12)],
    "Costa Caribe": [("COCTG", 3), ("PRSJU", 7), ("USGLS", 13)],
    "Indian Ocean Pearl": [("LKCMB", 4), ("AEJEA", 11)],
    "Humboldt": [("PECLL", 3), ("PABLB", 9), ("CLVAP", 21)],
    "Atlantic Trader": [("CAHAL", 4), ("USNYC", 7), ("GBSOU", 17)],
}
# Days since the last adjustment; of the Atlantic Trader none is on record.
ADJUSTED_DAYS_AGO = {
    "Cabo Verde Star": 400, "Baía de Santos": 690, "Kuroshio Maru": 771, "Östersjön": 701,
    "Costa Caribe": 300, "Indian Ocean Pearl": 724, "Humboldt": 210,
}
FIRMS = {
    "Nervión Compass": {
        "ports": ["ESBIO", "ESALG", "BRSSZ", "COCTG", "PRSJU", "USGLS"],
        "teams": ["Etxeberria", "Sáez", "Uriarte"], "fee": 1400,
    },
    "Baltic & North Sea Adjusters": {
        "ports": ["NLRTM", "GBSOU", "DEKEL", "PLGDY", "FIHEL", "CAHAL", "USNYC"],
        "teams": ["Jansen", "Lindqvist"], "fee": 1800,
    },
    "Southern Ocean Compass": {
        "ports": ["ZACPT", "AUSYD", "JPYOK", "LKCMB", "AEJEA", "AUFRE", "PECLL",
                  "PABLB", "CLVAP"],
        "teams": ["Rojas", "Perera"], "fee": 1600,
    },
}


class Person:
    """Someone who is signed in."""

    def __init__(self, server, email, password):
        self.base = server + "/api/v1"
        jar = http.cookiejar.CookieJar()
        self.opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(jar))
        self.ask("POST", "/session", {"email": email, "password": password})

    def ask(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        headers = {"Content-Type": "application/json", "X-Binnacle-Request": "1"}
        request = urllib.request.Request(self.base + path, data, headers, method=method)
        try:
            with self.opener.open(request) as response:
                text = response.read()
        except urllib.error.HTTPError as refused:
            sys.exit(f"demo: {method} {path}: {refused.code} {refused.read().decode()}")
        return json.loads(text) if text else None

    def get(self, path):
        return self.ask("GET", path)

    def post(self, path, body):
        return self.ask("POST", path, body)

    def put(self, path, body):
        return self.ask("PUT", path, body)


def stamp(at):
    return at.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


class Earth:
    """The earth's field along the coasters' voyage, from `binnacle-server field`."""

    STEPS = 40

    def __init__(self, program, day):
        self.path = [along(i / self.STEPS) for i in range(self.STEPS + 1)]
        self.known = [self.ask(program, lat, lon, day) for lat, lon in self.path]

    @staticmethod
    def ask(program, lat, lon, day):
        command = [program, "field", "--lat", str(lat), "--lon", str(lon), "--date", str(day)]
        found = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
        return found["x_nt"], found["y_nt"], found["z_nt"]

    def at(self, share):
        """North, east and down, nT, after a share of the way out."""
        low = min(int(share * self.STEPS), self.STEPS - 1)
        part = share * self.STEPS - low
        return [a + part * (b - a) for a, b in zip(self.known[low], self.known[low + 1])]


def along(share):
    (lat, lon), (lat_out, lon_out) = TURNS
    return lat + share * (lat_out - lat), lon + share * (lon_out - lon)


class Coaster:
    """A simulated compass: Poisson's equations over λ (docs/science.md, section 1)."""

    def __init__(self, name, dice):
        self.name, self.dice = name, dice
        self.b = dice.uniform(900, 1600), dice.uniform(-1100, 1100)
        self.chi13, self.chi23, self.d = dice.uniform(-0.012, 0), 0.002, dice.uniform(0.012, 0.02)
        self.gyro = name != "Deba"

    def field(self, earth, magnetic_deg):
        """Field at the compass over λ, forward and starboard, nT, and down."""
        north, east, down = earth
        horizontal = math.hypot(north, east)
        angle = math.radians(magnetic_deg)
        ahead, abeam = horizontal * math.cos(angle), -horizontal * math.sin(angle)
        forward = (1 + self.d) * ahead + self.chi13 * down + self.b[0]
        starboard = (1 - self.d) * abeam + self.chi23 * down + self.b[1]
        return forward, starboard, down

    def reads(self, earth, heading_deg):
        """Reading of the compass, degrees, on a true heading."""
        magnetic = heading_deg - variation(earth)
        forward, starboard, _ = self.field(earth, magnetic)
        return math.degrees(math.atan2(-starboard, forward)) % 360

    def row(self, at, share, heading, compass, position=None):
        lat, lon = position or along(share)
        noisy = lambda angle, sd: f"{(angle + self.dice.gauss(0, sd)) % 360:.2f}"
        return {
            "time": stamp(at), "lat": f"{lat:.4f}", "lon": f"{lon:.4f}",
            "compass_deg": noisy(compass, 0.3), "gyro_deg": noisy(heading, 0.2) if self.gyro else "",
            "satellite_deg": noisy(heading, 0.2), "sog_kn": "11.5", "rate_of_turn_deg_min": "0",
            "spread_deg": "0.3", "windows": "60",
        }

    def voyage(self, earth, until, days=20):
        """A sample every twenty minutes, out and back, with another heading every three hours."""
        count = days * 72
        for i in range(count):
            share = 1 - abs(2 * i / count - 1)
            heading = 107.0 * (i // 9) % 360
            at = until - (count - i) * HOUR / 3
            yield self.row(at, share, heading, self.reads(earth.at(share), heading))

    def off_bilbao(self, earth, card, start, until, wrong_deg):
        """Samples every ten minutes since an adjustment: as its card predicts, or wrong."""
        at, i = start, 0
        while at < until:
            heading = 75.0 * (i // 3) % 360
            magnetic = heading - variation(earth)
            compass = magnetic
            for _ in range(5):
                compass = magnetic - interpolated(card, compass) - wrong_deg
            yield self.row(at, 0, heading, compass)
            at, i = at + HOUR / 6, i + 1


def variation(earth):
    return math.degrees(math.atan2(earth[1], earth[0]))


def interpolated(card, compass_deg):
    """Deviation between a card's rows, which are 15° apart."""
    low = int(compass_deg % 360 // 15)
    part = (compass_deg % 360 - 15 * low) / 15
    return card[low] + part * (card[(low + 1) % 24] - card[low])


# States of work orders that the demo shows.
STATES = ["accepted", "adjusted", "adjusting", "cancelled", "closed", "closed_unverified", "declined",
          "failed", "measured", "offered", "on_board", "planned", "proposed", "verified"]
# A compass that passed every check alongside.
SOUND = {check: "sound" for check in ["bubble", "pivot", "gimbals", "lubber_line"]}


class Mission:
    def __init__(self, args):
        self.args, self.now = args, datetime.datetime.now(UTC).replace(microsecond=0)
        password = os.environ["BINNACLE_PASSWORD"]
        self.office = Person(args.server, args.email, password)
        names = [args.firms[i : i + 3] for i in range(0, len(args.firms), 3)]
        self.firms = {name: firm for name, firm, _ in names}
        self.adjusters = {name: Person(args.server, mail, password) for name, _, mail in names}
        self.dice = random.Random(2026)
        self.vessels = {one["name"]: one for one in self.office.get("/vessels?limit=200")["items"]}

    def vessel(self, name):
        return f"/vessels/{self.vessels[name]['id']}"

    def compass(self, name):
        return self.vessels[name]["compasses"][0]["id"]

    def state_terms(self):
        every_day = ["Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"]
        for name, firm in FIRMS.items():
            ports = [{"port": port, "travel_eur": 200} for port in firm["ports"]]
            terms = {"fee_eur": firm["fee"], "extra_compass_eur": 400, "ports": ports,
                     "working_days": every_day, "first_hour": 0, "last_hour": 24,
                     "jobs_a_team_day": 4}
            self.office.put(f"/firms/{self.firms[name]}/terms", terms)
            teams = {"teams": [{"name": team} for team in firm["teams"]]}
            self.adjusters[name].put(f"/firms/{self.firms[name]}/teams", teams)

    def enter_records(self):
        """Port calls, last adjustments, steel on board, and how often agents upload."""
        for name, calls in CALLS.items():
            for port, days in calls:
                eta = self.now + days * DAY
                call = {"port": port, "eta": stamp(eta), "etd": stamp(eta + 1.5 * DAY)}
                self.office.post(self.vessel(name) + "/port-calls", call)
        for name, days in ADJUSTED_DAYS_AGO.items():
            entry = {"kind": "adjustment", "from": stamp(self.now - days * DAY)}
            self.office.post(self.vessel(name) + "/logbook", entry)
        steel = {"kind": "magnetic_cargo", "cargo": "steel", "note": "Plates in hold 2",
                 "from": stamp(self.now - 26 * DAY), "to": stamp(self.now - 12.8 * DAY)}
        self.office.post(self.vessel("Costa Caribe") + "/logbook", steel)
        for name in CALLS:
            path = self.vessel(name) + "/settings"
            settings = self.office.get(path)
            settings["agent"].update(seal_s=180, sample_s=60)
            self.office.put(path, settings)

    def bring_coasters(self, earth):
        """Eight coasters, with a voyage each that ended at Bilbao half a day ago."""
        self.coasters = {}
        for name in COASTERS:
            new = {"name": name, "flag": "ES", "call_sign": "E" + name[:3].upper().replace("Ó", "O")}
            made = self.office.post("/vessels", new)
            self.vessels[name] = made
            ship = self.coasters[name] = Coaster(name, self.dice)
            self.bring(name, ship.voyage(earth, self.now - 13 * HOUR))
            if name == "Deba":
                continue
            entry = {"kind": "adjustment", "from": stamp(self.now - 725 * DAY)}
            self.office.post(self.vessel(name) + "/logbook", entry)
        for name in COASTERS + ["Humboldt", "Baía de Santos", "Indian Ocean Pearl"]:
            path = f"{self.vessel(name)}/compasses/{self.compass(name)}/binnacle"
            self.office.put(path, self.binnacle())
        for name in COASTERS:
            self.wait(self.vessel(name), lambda vessel: vessel["model"], f"the model of {name}")

    def bring(self, name, rows):
        rows = list(rows)
        path = os.path.join(self.args.dir, f"{self.vessels[name]['id']}.csv")
        with open(path, "w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, rows[0])
            table.writeheader()
            table.writerows(rows)
        command = [self.args.program, "import", "--vessel", self.vessels[name]["id"], path]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"demo: import of {name}: {done.stderr}")

    def binnacle(self):
        design = self.office.get("/binnacle-types/class_a_trays")
        aboard = {"magnets": [{"magnet": "200 mm", "count": 12}], "quadrantal": ["7 inch"],
                  "flinders_pieces_mm": [300, 150, 75, 75]}
        return {"version": 1, "serial": str(self.dice.randint(1000, 9999)), "type": design,
                "aboard": aboard, "setting": {}}

    def wait(self, path, found, what, seconds=180):
        for _ in range(seconds):
            answer = self.office.get(path)
            if found(answer):
                return answer
            time.sleep(1)
        sys.exit(f"demo: {what} did not come")

    def order(self, name, firm=None, port=None, hours=4.0, **more):
        """Orders an adjustment, offered to a firm where one is named."""
        at = self.now + hours * HOUR
        new = {"vessel_id": self.vessels[name]["id"], "compass_id": self.compass(name),
               "port": port or HOME_PORT, "planned_at": stamp(at), **more}
        if firm:
            new["offer"] = {"firms": [self.firms[firm]], "answer_within_hours": 72}
        return self.office.post("/work-orders", new)["id"]

    def order_at_next_call(self, name, firm):
        port, days = CALLS[name][0]
        return self.order(name, firm, port, 24 * days + 6)

    def accept(self, firm, order, who):
        answer = {"adjuster_name": who, "adjuster_licence": "ES-CA-114"}
        self.adjusters[firm].post(f"/work-orders/{order}/accept", answer)

    def reading(self, name, earth, at):
        """What a magnetometer shows at the berth with the bowl out, and the compass before."""
        magnetic = BERTH["heading"] - variation(earth)
        forward, starboard, down = self.coasters[name].field(earth, magnetic)
        micro = lambda nt: round(LAMBDA * nt / 1000, 3)
        return {"at": stamp(at), "lat": BERTH["lat"], "lon": BERTH["lon"],
                "heading_true_deg": BERTH["heading"], "heading_from": "ashore",
                "forward": micro(forward), "starboard": micro(starboard), "unit": "microtesla",
                "magnetometer": "fluxgate",
                "compass_deg": round(self.coasters[name].reads(earth, BERTH["heading"]), 1)}

    def work(self, name, earth, until, at=None, hours=0.5):
        """The firm's work at the berth, up to a state; returns the order."""
        firm, who = "Nervión Compass", "M. Etxeberria"
        order = self.order(name, firm, hours=hours)
        self.accept(firm, order, who)
        path, adjuster = f"/work-orders/{order}", self.adjusters[firm]
        arrived = {} if at is None else {"at": stamp(at - HOUR / 2)}
        adjuster.post(path + "/on-board", arrived)
        if until == "on_board":
            return order
        recorded = adjuster.get(path + "/binnacle")["binnacle"]["setting"]
        adjuster.post(path + "/as-found", {"setting": recorded, "dockside": SOUND, "photos": []})
        adjuster.post(path + "/berth-reading", self.reading(name, earth, at or self.now))
        if until == "measured":
            return order
        found = adjuster.post(path + "/plan", {})
        while found["next_step"]:
            step = found["next_step"]
            after = {"after_deg": step["expected_compass_deg"]}
            found = adjuster.post(f"{path}/steps/{step['number']}", after)
            if until == "adjusting":
                return order
        sign_off = {"adjuster_name": who, "adjuster_licence": "ES-CA-114", "firm": firm,
                    "signature": who, "at": stamp(at + HOUR / 4)}
        adjuster.post(path + "/complete", sign_off)
        return order

    def card(self, order):
        """Predicted deviations of a completed order at the berth, every 15° from 0°."""
        record = self.office.get(f"/work-orders/{order}/record.json")
        table = next(one for one in record["predicted_after"] if one["place"] == "berth")
        return [row["deviation_deg"] for row in table["rows"]]

    def sail_since(self, name, order, earth, at, wrong_deg, state):
        rows = self.coasters[name].off_bilbao(
            earth, self.card(order), at + HOUR, self.now, wrong_deg)
        self.bring(name, rows)
        path = f"/work-orders/{order}"
        self.wait(path, lambda found: found["state"] == state, f"{name}'s order as {state}")

    def adjust_coasters(self, earth):
        """Orders that are being done, and done ones with and without headings at sea."""
        home = earth.at(0)
        for name, state in [("Nervión", "adjusting"), ("Ibaizabal", "measured"),
                            ("Cadagua", "on_board")]:
            self.work(name, home, state)
        at = self.now - 11 * HOUR
        done = {name: self.work(name, home, "adjusted", at, 5.0 + 4 * i)
                for i, name in enumerate(["Bidasoa", "Urola", "Zadorra", "Oria", "Deba"])}
        self.sail_since("Urola", done["Urola"], home, at, 0.0, "verified")
        self.sail_since("Zadorra", done["Zadorra"], home, at, 4.0, "failed")
        self.sail_since("Oria", done["Oria"], home, at, 0.0, "verified")
        close = {"text": "Papers are filed."}
        self.office.post(f"/work-orders/{done['Oria']}/close", close)
        unverified = {"text": "The vessel is laid up.", "without_verification": True}
        self.office.post(f"/work-orders/{done['Deba']}/close", unverified)

    def order_at_sea(self):
        """Orders of the simulated ships, at their next port calls."""
        home, north, south = FIRMS
        self.order_at_next_call("Baía de Santos", home)
        accepted = self.order_at_next_call("Indian Ocean Pearl", south)
        self.accept(south, accepted, "D. Perera")
        proposed = self.order_at_next_call("Östersjön", north)
        terms = {"terms": {"fee_eur": 2100}, "text": "A second team has to come from Rotterdam."}
        self.adjusters[north].post(f"/work-orders/{proposed}/propose", terms)
        declined = self.order_at_next_call("Atlantic Trader", north)
        self.adjusters[north].post(f"/work-orders/{declined}/decline", {"text": "No team is free."})
        cancelled = self.order_at_next_call("Cabo Verde Star", south)
        self.office.post(f"/work-orders/{cancelled}/cancel", {"text": "The call is too short."})
        self.order_at_next_call("Costa Caribe", None)
        self.office.post("/schedule/solve", {})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--server", required=True)
    parser.add_argument("--program", required=True, help="binnacle-server, for its commands")
    parser.add_argument("--dir", required=True, help="folder for the tables of samples")
    parser.add_argument("--email", required=True, help="of the operator's admin")
    parser.add_argument("firms", nargs="+", help="name, id and adjuster's e-mail of each firm")
    args = parser.parse_args()
    mission = Mission(args)
    earth = Earth(args.program, mission.now.date())
    mission.state_terms()
    mission.enter_records()
    mission.bring_coasters(earth)
    mission.adjust_coasters(earth)
    mission.order_at_sea()
    states = sorted({one["state"] for one in mission.office.get("/work-orders?limit=200")["items"]})
    if missing := sorted(set(STATES) - set(states)):
        sys.exit(f"demo: no order is in these states: {', '.join(missing)}")
    print(f"  Orders are in these states: {', '.join(states)}.")


main()
