#!/usr/bin/env python3
"""Make crates/schedule/data/places.csv: codes that are no sea port's, and the port meant.

Usage: scripts/places.py CODELIST.csv... > crates/schedule/data/places.csv

Reads the code list that scripts/ports.py reads, and the ports that it made. A place is
listed where one port of its country alone is called as it is, or as an airport's name
begins, and is not elsewhere by the list's own positions.
"""
import csv
import re
import sys

PORTS = "crates/schedule/data/ports.csv"
# Positions of one town may be as far apart, degrees.
APART = 1.0


def called(name):
    """A name in plain words, and shorter by "port"; an airport's beginnings, the longest first."""
    words = re.sub(r"[^a-z0-9]+", " ", re.split(r"[,(]", name)[0].lower()).split()
    if words and words[-1] == "apt":
        return [" ".join(words[:n]) for n in range(len(words) - 1, 0, -1)]
    of_port = words[-1:] in (["pt"], ["port"], ["harbour"])
    return [" ".join(words)] + ([" ".join(words[:-1])] if of_port else [])


ports, whole, short = {}, {}, {}
for port in csv.DictReader(open(PORTS)):
    code = port["code"]
    ports[code] = (float(port["lat"]), float(port["lon"]))
    names = called(port["plain_name"] or port["name"])
    for name, by_name in zip(names, (whole, short)):
        by_name.setdefault((code[:2], name), set()).add(code)

places = {}
for path in sys.argv[1:]:
    for row in csv.reader(open(path, encoding="cp1252")):
        change, country, place, _, plain, _, _, _, _, _, position, _ = row
        code = country + place
        if change == "X" or not place or code in ports:
            continue
        named = ((country, name) for name in called(plain) if name)
        found = (whole.get(name) or short.get(name) for name in named)
        meant = next((codes for codes in found if codes), set())
        at = re.fullmatch(r"(\d\d)(\d\d)([NS]) (\d{3})(\d\d)([EW])", position.strip())
        if at:
            d, m, ns, e, n, ew = at.groups()
            lat = (int(d) + int(m) / 60) * (1 if ns == "N" else -1)
            lon = (int(e) + int(n) / 60) * (1 if ew == "E" else -1)
            near = (ports[one] for one in meant)
            if any(abs(lat - y) > APART or abs(lon - x) > APART for y, x in near):
                continue
        if len(meant) == 1:
            places[code] = meant.pop()

out = csv.writer(sys.stdout, lineterminator="\n")
out.writerow(["code", "port"])
out.writerows(sorted(places.items()))
