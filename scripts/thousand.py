#!/usr/bin/env python3
"""A fleet of a thousand vessels, to measure the dashboard with: `scripts/thousand.py DB [N]`.

Takes a SQLite database in which a simulated fleet has sailed (as scripts/browser-test
makes one), and adds copies of its vessels, with their compasses, analyses, current models
and alerts, each elsewhere, until there are N (1000). The same numbers each time.
"""

import json
import math
import random
import sqlite3
import sys
import uuid

DAY_MICROS = 86_400_000_000
TRACK_STEPS = 60


def columns(db, table):
    return [row[1] for row in db.execute(f"PRAGMA table_info({table})")]


def copy(db, table, row, changes):
    values = {**dict(zip(columns(db, table), row)), **changes}
    names = ", ".join(values)
    marks = ", ".join("?" for _ in values)
    db.execute(f"INSERT INTO {table} ({names}) VALUES ({marks})", list(values.values()))


def rows(db, table, vessel, more=""):
    return db.execute(f"SELECT * FROM {table} WHERE vessel_id = ? {more}", (vessel,)).fetchall()


def new_id(dice, count):
    """A UUID of version 7: later ones sort after earlier ones."""
    time_ms = 1_900_000_000_000 + count
    bits = time_ms << 80 | 0x7 << 76 | dice.getrandbits(12) << 64 | 0x2 << 62 | dice.getrandbits(62)
    return uuid.UUID(int=bits).bytes


def track(dice):
    """A month's voyage between 55° S and 60° N, somewhere, across the antimeridian or not."""
    lat, lon, course = dice.uniform(-50, 55), dice.uniform(-180, 180), dice.uniform(0, 2 * math.pi)
    places = []
    for _ in range(TRACK_STEPS):
        course += dice.gauss(0, 0.3)
        lat = max(-55.0, min(60.0, lat + 2.4 * math.cos(course)))
        lon = (lon + 2.4 * math.sin(course) / math.cos(math.radians(lat)) + 180) % 360 - 180
        places.append([round(lat, 2), round(lon, 2)])
    return places


def add(db, dice, count, model):
    vessel, compasses = new_id(dice, count), {}
    places = track(dice)
    (row,) = db.execute("SELECT * FROM vessels WHERE id = ?", (model,)).fetchall()
    known = dict(zip(columns(db, "vessels"), row))
    copy(db, "vessels", row, {
        "id": vessel, "name": f"{known['name']} {count}", "imo_number": None,
        "last_lat": places[-1][0], "last_lon": places[-1][1],
        "last_upload_at": known["last_upload_at"] - int(dice.expovariate(1) * DAY_MICROS / 4),
    })
    for row in rows(db, "compasses", model):
        old = dict(zip(columns(db, "compasses"), row))["id"]
        compasses[old] = new_id(dice, count)
        copy(db, "compasses", row, {"vessel_id": vessel, "id": compasses[old]})
    of = lambda table, row: compasses[dict(zip(columns(db, table), row))["compass_id"]]
    for row in rows(db, "analyses", model):
        changes = {"vessel_id": vessel, "compass_id": of("analyses", row), "track": json.dumps(places)}
        copy(db, "analyses", row, changes)
    if dice.random() < 0.97:
        for row in rows(db, "models", model, "ORDER BY version DESC LIMIT 2"):
            changes = {"vessel_id": vessel, "id": new_id(dice, count), "compass_id": of("models", row)}
            copy(db, "models", row, changes)
    if dice.random() < 0.3:
        for row in rows(db, "alerts", model, "AND state <> 'cleared'"):
            copy(db, "alerts", row, {
                "vessel_id": vessel, "id": new_id(dice, count), "compass_id": of("alerts", row),
                "severity": dice.choice(["notice", "warning", "warning", "critical"]),
            })


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__.splitlines()[0])
    wanted = int(sys.argv[2]) if len(sys.argv) == 3 else 1000
    db, dice = sqlite3.connect(sys.argv[1]), random.Random(1)
    models = [row[0] for row in db.execute("SELECT DISTINCT vessel_id FROM models ORDER BY vessel_id")]
    if not models:
        sys.exit(f"thousand: {sys.argv[1]}: no vessel has a model")
    (there,) = db.execute("SELECT COUNT(*) FROM vessels").fetchone()
    with db:
        for count in range(there, wanted):
            add(db, dice, count, models[count % len(models)])
    print(f"{max(there, wanted)} vessels")


main()
