"""PELT, as someone would use it who watches a ship: every three hours the penalised
segmentation [Killick, Fearnhead & Eckley 2012] of the last fortnight's hourly residuals,
by `ruptures`. The alarm is a segment that began in the watch, still lasts, and is off what
the fit expects by more than the penalty: that a storm is over is no alarm.

The penalty is the least of a geometric series at which the first fleet, to which nothing
happens, gives no more false alarms than are allowed. Reads hours.csv of a folder, writes
alarms.csv and penalty.
usage: pelt.py FOLDER ALLOWED_FALSE_ALARMS SECONDS_UNHEARD_AFTER_AN_ALARM
"""

import bisect
import csv
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import ruptures

WINDOW_HOURS = 14 * 24
EVERY_HOURS = 3
# A shorter segment is a passing disturbance.
SHORTEST_HOURS = 6
# Residuals beyond so many standard deviations count for that many.
WILD = 3.0
PENALTIES = 5 * 1.05 ** np.arange(128)


@dataclass
class Ship:
    """Hours of one ship: last rows, times, and the signal that is segmented."""

    rows: np.ndarray
    time_s: np.ndarray
    # The first hour that is watched.
    watched: int
    signal: np.ndarray

    @staticmethod
    def of(hours):
        row, time_s, watched, residual, by_bx, by_by = np.array(hours).T
        residual = np.clip(residual, -WILD, WILD)
        # A step of bx turns the compass as the sine of its heading, one of by as the cosine.
        by = np.column_stack([by_bx, by_by])
        by *= np.sqrt(2) / np.linalg.norm(by, axis=1, keepdims=True)
        signal = np.ascontiguousarray(residual[:, None] * by)
        return Ship(row.astype(int), time_s, int(np.argmax(watched)), signal)

    def is_changed(self, since, until, penalty):
        """Whether the hours end with a segment that is off."""
        first = max(since, until - WINDOW_HOURS)
        if until - first < 2 * SHORTEST_HOURS:
            return False
        window = self.signal[first:until]
        # Of the last one, two, three … hours.
        sums = np.cumsum(window[::-1], axis=0)
        off = np.sum(sums**2, axis=1) / np.arange(1, len(window) + 1)
        if not np.any(off[SHORTEST_HOURS - 1 :] > penalty):
            return False
        search = ruptures.KernelCPD(kernel="linear", min_size=SHORTEST_HOURS)
        began, end = ([0] + search.fit_predict(window, pen=penalty))[-2:]
        in_the_watch = began > 0 and first + began >= self.watched
        return in_the_watch and off[end - began - 1] > penalty

    def alarms(self, penalty, unheard_s):
        """Rows of the alarms."""
        found, since, heard_from = [], 0, -np.inf
        for until in range(self.watched + 1, len(self.rows) + 1, EVERY_HOURS):
            now = self.time_s[until - 1]
            if now >= heard_from and self.is_changed(since, until, penalty):
                found.append(int(self.rows[until - 1]))
                since, heard_from = until, now + unheard_s
        return found


def read(path):
    """Ships by fleet and number."""
    hours = {}
    with open(path, newline="", encoding="utf-8") as file:
        lines = csv.reader(file)
        next(lines)
        for fleet, ship, *values in lines:
            hours.setdefault((int(fleet), int(ship)), []).append([float(v) for v in values])
    return {place: Ship.of(of_one) for place, of_one in hours.items()}


def set_penalty(ships, allowed, unheard_s):
    """The least penalty with no more alarms than are allowed."""

    def is_enough(penalty):
        return sum(len(ship.alarms(penalty, unheard_s)) for ship in ships) <= allowed

    return PENALTIES[bisect.bisect_left(PENALTIES, True, key=is_enough)]


def main():
    folder, allowed, unheard_s = Path(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3])
    ships = read(folder / "hours.csv")
    quiet = [ship for (fleet, _), ship in ships.items() if fleet == 0]
    penalty = set_penalty(quiet, allowed, unheard_s)
    (folder / "penalty").write_text(f"{penalty}\n", encoding="utf-8")
    with open(folder / "alarms.csv", "w", newline="", encoding="utf-8") as file:
        lines = csv.writer(file)
        lines.writerow(["fleet", "ship", "row"])
        for (fleet, number), ship in ships.items():
            if fleet > 0:
                for row in ship.alarms(penalty, unheard_s):
                    lines.writerow([fleet, number, row])


if __name__ == "__main__":
    main()
