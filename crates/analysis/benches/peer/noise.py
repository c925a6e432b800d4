"""The noise's part: seven states, the filter that whitens, and what it adds up to.

The states are the Schuler swing and its rate, the gyro's slow error, the compass's
swing, the variation's error, and how bx and by have drifted since the first row. The
filter's gain depends on the noise alone, so that one covariance serves the residual and
every column: they are whitened together.
"""

from dataclasses import dataclass

import numpy as np

from magnetism import UNKNOWNS, wrap

STATES = 7
# White, Schuler, turn, slow gyro, compass swing, variation (degrees), drift (nT).
TYPICAL = np.array([0.2, 0.2, 0.4, 0.3, 0.2, 0.2, 60.0])
SCHULER_PER_S = 2 * np.pi / (84.4 * 60)
DAMPING = 0.2
SETTLED_S = 900.0
DOUBTED = 2.5
GROSS = 6.0


def swing_over(seconds):
    """The damped swing and its rate (in units of the swing) after `seconds`."""
    phase = SCHULER_PER_S * seconds
    damped = np.sqrt(1 - DAMPING**2)
    shrink = np.exp(-DAMPING * phase)
    sin, cos = shrink * np.sin(damped * phase) / damped, shrink * np.cos(damped * phase)
    return np.array([[cos + DAMPING * sin, sin], [-sin, cos - DAMPING * sin]])


class Stations:
    """All that the filter needs to know of the samples but the rows."""

    def __init__(self, voyage):
        n = len(voyage)
        seconds, miles, turned = np.zeros(n), np.zeros(n), np.zeros(n, dtype=bool)
        seconds[1:] = np.diff(voyage.time_s)
        middle = np.radians((voyage.lat[1:] + voyage.lat[:-1]) / 2)
        east = wrap(np.diff(voyage.lon)) * np.cos(middle)
        miles[1:] = 60 * np.hypot(np.diff(voyage.lat), east)
        heading = voyage.compass + voyage.deviation + voyage.variation
        turned[1:] = np.abs(wrap(np.diff(heading))) > 20
        decay = np.exp([-seconds / (3 * 86_400), -seconds / 1200, -miles / 60])

        self.transition = np.zeros((n, STATES, STATES))
        schuler = swing_over(seconds).transpose(2, 0, 1)
        self.transition[:, :2, :2] = schuler
        for k in range(3):
            self.transition[:, 2 + k, 2 + k] = decay[k]
        self.transition[:, 5, 5] = self.transition[:, 6, 6] = 1
        # New noise of each step, were every level 1: what the stationary processes
        # lost, a turn's kick to the rate, and the random walk.
        self.lost_swing = np.eye(2) - schuler @ schuler.transpose(0, 2, 1)
        kick = swing_over(np.minimum(seconds, SETTLED_S))[:, 1, :].T * turned[:, None]
        self.kick = kick[:, :, None] * kick[:, None, :]
        self.lost = 1 - decay.T**2
        self.months = seconds / (30 * 86_400)

        self.white = (1 + 60 / np.clip(voyage.windows, 1, 60)) / 2
        self.load = np.zeros((n, STATES))
        per_cos_lat = 1 / np.maximum(np.cos(np.radians(voyage.lat)), 0.17)
        self.load[:, 0] = self.load[:, 2] = per_cos_lat
        self.load[:, 3] = 1
        self.load[:, 4] = np.clip(24_000 / voyage.h, 0.5, 4.0)

    def process_noise(self, levels):
        _, schuler, turn, slow, swing, variation, drift = levels**2
        noise = np.zeros_like(self.transition)
        noise[:, :2, :2] = schuler * self.lost_swing + turn * self.kick
        for k, variance in enumerate([slow, swing, variation]):
            noise[:, 2 + k, 2 + k] = variance * self.lost[:, k]
        noise[:, 5, 5] = noise[:, 6, 6] = drift * self.months
        return noise


@dataclass
class Pass:
    """What one pass of the filter comes to."""

    # Innovations of residual and columns, the residual's variance, and its weight.
    innovations: np.ndarray
    variance: np.ndarray
    weight: np.ndarray
    # Where the states of residual and columns end, and their covariance.
    states: np.ndarray
    covariance: np.ndarray

    def normal(self):
        """Information and score."""
        columns = self.innovations[:, 1:]
        weighted = columns * (self.weight / self.variance)[:, None]
        return weighted.T @ columns, weighted.T @ self.innovations[:, 0]

    def log_variance(self):
        return np.log(self.variance).sum()

    def loss(self):
        """-2 log likelihood but for a constant, the loss of gross innovations capped."""
        z = np.abs(self.innovations[:, 0]) / np.sqrt(self.variance)
        z = np.minimum(z, GROSS)
        beyond = DOUBTED**2 * (1 + 2 * np.log(np.maximum(z, DOUBTED) / DOUBTED))
        return np.where(z <= DOUBTED, z**2, beyond).sum() + self.log_variance()


def whiten(stations, rows, levels):
    """Runs the filter over all rows."""
    n = len(rows.residual)
    series = np.column_stack([rows.residual, rows.columns])
    load = stations.load.copy()
    load[:, 5:] = rows.drift
    white = levels[0] ** 2 * stations.white
    process_noise = stations.process_noise(levels)
    innovations, variances, weights = np.empty_like(series), np.empty(n), np.empty(n)
    initial = levels[[1, 1, 3, 4, 5, 6, 6]] ** 2
    initial[5:] = 0
    # The covariance and, beside it, the states of all series: they go over from row to
    # row by the same matrix and meet the measurement by the same load.
    both = np.zeros((STATES, STATES + 1 + UNKNOWNS))
    covariance, states = both[:, :STATES], both[:, STATES:]
    covariance[:] = np.diag(initial)
    steps = zip(stations.transition, process_noise, load, white.tolist(), series)
    for k, (transition, new, h, r, y) in enumerate(steps):
        both[:] = transition.dot(both)
        covariance[:] = covariance.dot(transition.T)
        covariance += new
        seen = h.dot(both)
        gain, innovation = seen[:STATES], y - seen[STATES:]
        variance = float(gain.dot(h)) + r
        z_squared = float(innovation[0]) ** 2 / variance
        weight = 1.0 if z_squared <= DOUBTED**2 else DOUBTED**2 / z_squared
        seen[STATES:] = -innovation
        both -= (gain * (weight / variance))[:, None] * seen
        innovations[k] = innovation
        variances[k] = variance
        weights[k] = weight
    return Pass(innovations, variances, weights, states.copy(), covariance.copy())
