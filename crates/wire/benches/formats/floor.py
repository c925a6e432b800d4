"""An upper bound of the entropy of a voyage's columns, in bits.

Each column's integers are coded by a mixture of experts, each a predictor with a
distribution about its prediction, whose weights follow how well each did so far. The
sum of −log2 of the mixture's probabilities is the length that an arithmetic coder would
reach, without headers and without ever restarting; no decoder is kept from doing the
same, for every expert sees only what came before, and columns earlier in the order.
"""

import math

import numpy as np

# Part of the weights that is redistributed at each value: experts may change places.
SHARE = 0.002
SCALES = 2.0 ** np.arange(-3, 9, 0.5)
TIME, LAT, LON, GYRO, SATELLITE, COMPASS, SOG, RATE, SPREAD, WINDOWS = range(1, 11)
NAMES = {
    TIME: "time", LAT: "latitude", LON: "longitude", GYRO: "gyro",
    SATELLITE: "satellite less gyro", COMPASS: "compass less reference", SOG: "speed",
    RATE: "rate of turn", SPREAD: "spread", WINDOWS: "windows",
}
# Later ones may be predicted from earlier ones.
ORDER = (WINDOWS, TIME, GYRO, SOG, LAT, LON, COMPASS, SATELLITE, RATE, SPREAD)


def normal(x):
    """The normal distribution's function: any rising function would do (7.1.26 of
    Abramowitz & Stegun)."""
    z = np.abs(x) / math.sqrt(2)
    t = 1 / (1 + 0.3275911 * z)
    series = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (
        -1.453152027 + t * 1.061405429))))
    upper = series * np.exp(-z * z) / 2
    return np.where(x > 0, 1 - upper, upper)


def logistic(x):
    return 1 / (1 + np.exp(-np.clip(x, -700, 700)))


def cauchy(x):
    return np.arctan(x) / math.pi + 0.5


SHAPES = (normal, logistic, cauchy)


class Mixture:
    """Experts, and how far each is trusted."""

    def __init__(self, predictors):
        self.weights = np.full((predictors, len(SHAPES), len(SCALES)), 1.0)
        self.weights /= self.weights.size

    def bits(self, predictions, value):
        """Bits of the value; updates the weights."""
        low = (value - 0.5 - predictions)[:, None] / SCALES
        high = (value + 0.5 - predictions)[:, None] / SCALES
        chances = np.stack([shape(high) - shape(low) for shape in SHAPES], axis=1)
        # Nothing is impossible: a value of some millions costs 40 bits more.
        chances = chances * (1 - 1e-6) + 1e-6 * 2.0**-34
        likely = self.weights * chances
        total = likely.sum()
        self.weights = likely / total * (1 - SHARE) + SHARE / likely.size
        return -math.log2(total)


class Frequencies:
    """Counts of each number so far, as an offset from an anchor: some columns have
    favourites that no smooth distribution has."""

    FIRM = 8.0

    def __init__(self):
        self.counts, self.all = {}, 0.0

    def chance(self, number, otherwise):
        seen = self.counts.get(number, 0.0)
        return (seen + self.FIRM * otherwise) / (self.all + self.FIRM)

    def update(self, number):
        self.counts[number] = self.counts.get(number, 0.0) + 1
        self.all += 1


class Best:
    """A mixture over the smooth one and the frequencies about each anchor."""

    def __init__(self, smooth, anchors):
        self.smooth = Mixture(smooth)
        self.frequencies = [Frequencies() for _ in range(anchors)]
        self.weights = np.full(1 + anchors, 1 / (1 + anchors))

    def bits(self, predictions, anchors, value):
        smooth = 2.0 ** -self.smooth.bits(predictions, value)
        numbers = [value - round(anchor) for anchor in anchors]
        known = [f.chance(n, smooth) for f, n in zip(self.frequencies, numbers)]
        likely = self.weights * np.array([smooth, *known])
        total = likely.sum()
        self.weights = likely / total * (1 - SHARE) + SHARE / len(likely)
        for frequencies, number in zip(self.frequencies, numbers):
            frequencies.update(number)
        return -math.log2(total)


class Regression:
    """The next value as a line through what is known, refitted with each value."""

    FORGETS = 0.995

    def __init__(self, count):
        self.p = np.eye(count) * 1e3
        self.w = np.zeros(count)

    def predict(self, x):
        return float(self.w @ x)

    def update(self, x, value):
        gain = self.p @ x / (self.FORGETS + x @ self.p @ x)
        self.w += gain * (value - self.w @ x)
        self.p = (self.p - np.outer(gain, x @ self.p)) / self.FORGETS
        self.p = (self.p + self.p.T) / 2


class Past:
    """The predictors that every column has."""

    SHARES = (1 / 2, 1 / 4, 1 / 8, 1 / 16, 1 / 32)

    def __init__(self, value):
        self.last, self.before, self.mean = value, value, np.full(len(self.SHARES), float(value))
        self.all, self.count = float(value), 1

    def predict(self):
        mean = self.all / self.count
        return [self.last, 2 * self.last - self.before, (self.last + mean) / 2, mean, *self.mean]

    def update(self, value):
        self.before, self.last = self.last, value
        self.mean += (value - self.mean) * self.SHARES
        self.all += value
        self.count += 1


def column_bits(values, hints, features):
    """Bits of a column's values. `hints` are other predictions of each; `features` say
    what a change from the last value may follow from."""
    past, mixture, regression, total = None, None, None, 0.0
    for row, value in enumerate(values):
        if value is None:
            continue
        if past is None:
            past = Past(value)
            total += 2 * math.log2(abs(value) + 2)
            continue
        x = np.array([1.0, past.last - past.mean[1], past.last - past.mean[3],
                      past.last - past.before, *features(row)])
        if mixture is None:
            regression = Regression(len(x))
        hinted = hints(row)
        predicted = [*past.predict(), *hinted, past.last + regression.predict(x)]
        anchors = [0, past.last, *hinted]
        if mixture is None:
            mixture = Best(len(predicted), len(anchors))
        total += mixture.bits(np.array(predicted), anchors, value)
        regression.update(x, value - past.last)
        past.update(value)
    return total


def floor_bits(columns):
    """Bits by column, of columns that are whole, in their steps (FORMAT.md)."""
    return {c: column_bits(columns[c], *hints_and_features(columns, c)) for c in ORDER if c in columns}


def hints_and_features(columns, column):
    """What is known of a column's next value from the columns before it."""
    c = {name: np.array([v or 0.0 for v in values]) for name, values in columns.items()}
    none = lambda row: []
    if column == TIME:
        # Back to back: half of each, in steps of five seconds.
        return lambda row: [c[TIME][row - 1] + c[WINDOWS][row - 1] + c[WINDOWS][row]], none
    if column in (LAT, LON):
        rise = reckoning(c, column)
        memory = Memory()

        def hints(row):
            drift = memory.mean(c[column], rise, row)
            return [c[column][row - 1] + rise[row], c[column][row - 1] + rise[row] + drift,
                    2 * c[column][row - 1] - c[column][max(row - 2, 0)] + rise[row]
                    - rise[row - 1]]
        return hints, lambda row: [rise[row], rise[row - 1]]
    if column in (COMPASS, SATELLITE):
        return by_heading(c, column)
    if column == RATE:
        gyro = c[GYRO]
        return none, lambda row: [gyro[row] - gyro[row - 1],
                                  gyro[min(row + 1, len(gyro) - 1)] - gyro[row]]
    if column == SPREAD:
        return none, lambda row: [c[WINDOWS][row] - c[WINDOWS][row - 1],
                                  abs(c[GYRO][row] - c[GYRO][row - 1]) if GYRO in c else 0.0]
    if column == SOG:
        return none, lambda row: [c[WINDOWS][row] - c[WINDOWS][row - 1],
                                  abs(c[GYRO][row] - c[GYRO][row - 1]) if GYRO in c else 0.0]
    return none, none


class Memory:
    """What dead reckoning lacked of late: current and leeway."""

    def __init__(self):
        self.drift = 0.0

    def mean(self, values, rise, row):
        if row >= 2:
            missed = values[row - 1] - values[row - 2] - rise[row - 1]
            if abs(missed) < 50:
                self.drift += (missed - self.drift) / 4
        return self.drift


def reckoning(c, column):
    """By how much each sample lies beyond the one before, by heading and speed."""
    hours = np.diff(c[TIME], prepend=c[TIME][0]) * 5 / 3600
    heading = np.radians(c[GYRO] * 0.05)
    knots = c[SOG] * 0.2
    north, east = knots * np.cos(heading), knots * np.sin(heading)
    along = north if column == LAT else east / np.cos(np.radians(c[LAT] * 0.001))
    mean = (along + np.concatenate([along[:1], along[:-1]])) / 2
    return mean * hours / 60 * 1000


def by_heading(c, column):
    """Deviation is a matter of heading: its value at the last visit to that heading."""
    bins = (c[GYRO] * 0.05 // 5 % 72).astype(int)
    kept, curve = {}, Regression(5)
    angle = np.radians(c[GYRO] * 0.05)
    harmonics = np.stack([np.ones_like(angle), np.sin(angle), np.cos(angle), np.sin(2 * angle),
                          np.cos(2 * angle)])
    curve.FORGETS = 0.999

    def hints(row):
        # Taken in here, once a row: rows come in their order.
        curve.update(harmonics[:, row - 1], c[column][row - 1])
        before = kept.get(bins[row - 1], c[column][row - 1])
        kept[bins[row - 1]] = before + (c[column][row - 1] - before) / 4
        there = curve.predict(harmonics[:, row])
        step = there - curve.predict(harmonics[:, row - 1])
        return [kept.get(bins[row], c[column][row - 1]), there, c[column][row - 1] + step]
    return hints, lambda row: list((harmonics[1:, row] - harmonics[1:, row - 1]) * 100)
