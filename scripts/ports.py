#!/usr/bin/env python3
"""Make crates/schedule/data/ports.csv from UNECE's UN/LOCODE list.

Usage: scripts/ports.py CODELIST.csv... SEA-PORTS.json ZONE.TAB > crates/schedule/data/ports.csv

The code list's parts (issue 2023-1, Windows-1252) are in PyPI's pyunlocode 0.1.0 as
UNECE publishes them; lib/ports.json of npm's sea-ports 0.0.9 fills in positions. Of 761
codes that both have a position for, 746 agree within half a degree; UNECE's is taken. zone.tab (public domain) is of tzdb 2026f, as
in PyPI's tzdata 2026.6; scripts/port_zones.py says which of its zones a port keeps.
"""
import csv
import json
import re
import sys

import port_zones

*lists, more, zone_tab = sys.argv[1:]
elsewhere = {}
for code, port in json.load(open(more)).items():
    lon, lat = port.get("coordinates") or (0, 0)
    if (lat or lon) and abs(lat) <= 90 and abs(lon) <= 180:
        for alias in [code, *port.get("unlocs", [])]:
            elsewhere.setdefault(alias, (lat, lon))

ports = {}
for path in lists:
    for row in csv.reader(open(path, encoding="cp1252")):
        change, country, place, name, plain, state, function, *_, position, _ = row
        if change == "X" or not place or not function.startswith("1"):
            continue
        found = re.fullmatch(r"(\d\d)(\d\d)([NS]) (\d{3})(\d\d)([EW])", position.strip())
        where = elsewhere.get(country + place)
        if found:
            d, m, ns, e, n, ew = found.groups()
            lat, lon = int(d) + int(m) / 60, int(e) + int(n) / 60
            if lat <= 90 and lon <= 180:
                where = (lat if ns == "N" else -lat, lon if ew == "E" else -lon)
        if where:
            ports[country + place] = (name, "" if plain == name else plain, state, *where)

places = {code: (state, lat, lon) for code, (_, _, state, lat, lon) in ports.items()}
zones = port_zones.zones_of(places, port_zones.read(zone_tab))
out = csv.writer(sys.stdout, lineterminator="\n")
out.writerow(["code", "name", "plain_name", "lat", "lon", "zone"])
for code, (name, plain, _, lat, lon) in sorted(ports.items()):
    out.writerow([code, name, plain, f"{lat:.2f}", f"{lon:.2f}", zones[code]])
