"""Prints the tables of BENCHMARKS.md about formats: `make bench-formats`.

    main.py PROGRAMS SCENARIO [DAYS]

PROGRAMS is the folder of binnacle-simulator and binnacle-agent. One voyage is sailed for
each profile; all formats get the batches that the agent then sent.
"""

import json
import subprocess
import sys
from pathlib import Path

from floor import NAMES, ORDER, floor_bits
from other_formats import forms, integers
from spool import sail

sys.path.insert(0, str(Path(__file__).parents[2] / "decoder"))
import sr1  # noqa: E402

# Full days at sea on the link (`make bench-link`).
PROFILES = {"vsat": "every hour", "standard": "four a day", "metered": "daily"}
COLUMNS = dict(zip(("time", "lat", "lon", "gyro", "satellite", "compass", "sog", "rate",
                    "spread", "windows"), range(1, 11)))
CIRCLES = {"lon": 360_000, "gyro": 7_200, "satellite": 7_200, "compass": 18_000}


def every_ten_minutes(batches):
    """Each sample alone, as it is finished; the last one carries the other counts."""
    alone = []
    for batch in batches:
        rest = {k: v for k, v in batch["tally"].items() if k != "accepted"}
        for sample in batch["samples"]:
            tally = {"accepted": sample["windows"]}
            if sample is batch["samples"][-1]:
                tally |= rest
            alone.append({**batch, "seq": len(alone) + 1, "tally": tally, "samples": [sample]})
    return alone


def between(measured, size):
    """Bytes of a body on the link, interpolated between the measured sizes."""
    for (low, a), (high, b) in zip(measured, measured[1:]):
        if size <= high or high == measured[-1][0]:
            return a + (b - a) * (size - low) / (high - low)
    raise SystemExit("no overhead was measured")


def whole_columns(batches):
    """The voyage's columns in one, directions unwound."""
    columns = {name: [] for name in COLUMNS}
    for batch in batches:
        for name, values in integers(batch).items():
            columns[name] += values
    for name, circle in CIRCLES.items():
        last = 0
        for row, value in enumerate(columns[name]):
            if value is not None:
                last += (value - last + circle // 2) % circle - circle // 2
                columns[name][row] = last
    return {COLUMNS[name]: values for name, values in columns.items() if any(
        value is not None for value in values)}


def table(head, rows):
    print("| " + " | ".join(head) + " |\n" + "|---" * len(head) + "|")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def main():
    programs, scenario = Path(sys.argv[1]), sys.argv[2]
    days = float(sys.argv[3]) if len(sys.argv) > 3 else 30.0
    here = Path(__file__).parent
    frames, batches = {}, {}
    for profile in PROFILES:
        print(f"sailing {days:g} days, {profile}", file=sys.stderr)
        frames[profile] = sail(programs, scenario, profile, days)
        batches[profile] = [sr1.decode(frame) for frame in frames[profile]]
    batches["ten minutes"] = every_ten_minutes(batches["metered"])
    print("measuring stock HTTPS", file=sys.stderr)
    https = json.loads(subprocess.run(
        ["unshare", "--net", sys.executable, here / "overhead.py"],
        check=True, stdout=subprocess.PIPE).stdout)

    sizes = {"Binnacle": {p: [len(f) for f in frames[p]] for p in PROFILES}}
    for name, form in forms().items():
        sizes[name] = {p: [len(form(b)) for b in batches[p]] for p in batches}
    cadences = {"ten minutes": "every 10 minutes", **PROFILES}
    counted = ", ".join(f"{len(batches[p])} batches {words}" for p, words in cadences.items())
    samples = sum(len(b["samples"]) for b in batches["metered"])
    print(f"{days:g} days, {samples} samples; {counted}\n")
    print("Payload, bytes a vessel-day:\n")
    table(["form", *cadences.values()], [
        [name, *(f"{sum(of[p]) / days:,.0f}" if p in of else "" for p in cadences)]
        for name, of in sizes.items()])
    for how, words in (("own", "on a connection of its own"), ("open", "on one that stays open")):
        print(f"Over stock HTTPS, each request {words}, IP bytes a vessel-day:\n")
        table(["form", *cadences.values()], [
            [name, *(f"{sum(between(https[how], s) for s in of[p]) / days:,.0f}" if p in of else ""
                     for p in cadences)]
            for name, of in sizes.items()])
        size, on_link = https[how][1]
        print(f"({on_link - size:,.0f} bytes beside a body of {size}.)\n")

    columns = whole_columns(batches["metered"])
    floor = floor_bits(columns)
    total = sum(floor.values()) / 8
    print(f"Entropy, at most, in bits a sample; {total / samples:.2f} bytes in all:\n")
    table(["column", "bits"], [
        [NAMES[c], f"{floor[c] / samples:.2f}"] for c in ORDER if c in floor])
    table(["batches", "bytes a sample, whole frames", "over the entropy"], [
        [words, f"{sum(sizes['Binnacle'][p]) / count(batches[p]):.2f}",
         f"{sum(sizes['Binnacle'][p]) / count(batches[p]) / (total / samples):.2f}"]
        for p, words in PROFILES.items()])


def count(batches):
    return sum(len(batch["samples"]) for batch in batches)


if __name__ == "__main__":
    main()
