"""statsmodels' side of `make bench-peer`: docs/science.md, §7, as a state-space model of
that library.

`statespace.py VOYAGE.csv` prints the fit and how long it took as JSON, reading the file
not counted. What the library has no place for is left out, in its favour: every
innovation keeps its full weight, neither has the prior tails nor have the levels a prior,
and the standard errors stay unjudged.
"""

import json
import sys
import time

import numpy as np
from statsmodels.tsa.statespace.mlemodel import MLEModel

from fit import OF_WHITE, REFERENCE_SD_DEG, USUAL_FUSION, prior_information, start
from magnetism import CONSTANT, POPULATION_SD, SCALE, UNKNOWNS, Nuisances, Voyage, rows
from noise import TYPICAL, Stations

# Schuler swing and rate, the gyro's slow error, the compass's swing, the variation's.
PASSING = 5
STATES = UNKNOWNS + PASSING
# Those into which new noise comes: bx and by, which drift, and all that pass.
NOISY = [0, 2, *range(UNKNOWNS, STATES)]
# A step of the unknowns, in population units, that is none.
SETTLED = 5e-4


class Ship(MLEModel):
    """Unknowns and passing errors in one state vector, bx and by as random walks; what
    the likelihood is maximised by are the levels. Steps in time differ, and so do
    transitions and noise."""

    param_names = ["white", "schuler", "turn", "slow", "swing", "variation", "drift"]

    def __init__(self, stations, r, unknowns):
        # What was measured, were all states zero.
        measured = r.residual + r.columns @ unknowns
        super().__init__(measured, k_states=STATES, k_posdef=len(NOISY))
        # More than twice as fast as the usual filter, and the same for a single series.
        self.ssm.filter_univariate = True
        self.stations = stations
        self["design"] = np.hstack([r.columns, stations.load[:, :PASSING]]).T[None]
        transition = np.repeat(np.eye(STATES)[:, :, None], len(measured), axis=2)
        # The library's transition leads to the next row, a station's from the one before.
        passing = stations.transition[1:, :PASSING, :PASSING]
        transition[UNKNOWNS:, UNKNOWNS:, :-1] = passing.transpose(1, 2, 0)
        self["transition"] = transition
        self["selection"] = np.eye(STATES)[:, NOISY]
        self.unknowns_covariance = np.linalg.inv(prior_information())

    def transform_params(self, unconstrained):
        return np.exp(unconstrained)

    def untransform_params(self, constrained):
        return np.log(constrained)

    def update(self, params, **kwargs):
        params = super().update(params, **kwargs)
        white, schuler, turn, slow, swing, variation, drift = params**2
        stations = self.stations
        self["obs_cov"] = (white * stations.white)[None, None]
        new = np.zeros((len(NOISY), len(NOISY), len(stations.white)), dtype=params.dtype)
        new[0, 0, :-1] = drift / POPULATION_SD[0] ** 2 * stations.months[1:]
        new[1, 1, :-1] = drift / POPULATION_SD[2] ** 2 * stations.months[1:]
        of_swing = schuler * stations.lost_swing[1:] + turn * stations.kick[1:]
        new[2:4, 2:4, :-1] = of_swing.transpose(1, 2, 0)
        for k, variance in enumerate([slow, swing, variation]):
            new[4 + k, 4 + k, :-1] = variance * stations.lost[1:, k]
        self["state_cov"] = new
        initial = np.zeros((STATES, STATES), dtype=params.dtype)
        initial[:UNKNOWNS, :UNKNOWNS] = self.unknowns_covariance
        passing = range(UNKNOWNS, STATES)
        initial[passing, passing] = [schuler, schuler, slow, swing, variation]
        self.ssm.initialize_known(np.zeros(STATES, dtype=params.dtype), initial)


def compass_share(ship, levels):
    """w of eq. 14, by the variances of the innovations."""

    def log_variance(nudge):
        nudged = levels.copy()
        nudged[0] *= np.exp(OF_WHITE * nudge)
        nudged[4] *= np.exp(nudge)
        return np.log(ship.filter(nudged, return_ssm=True).forecasts_error_cov).sum()

    slope = (log_variance(0.05) - log_variance(-0.05)) / 0.2
    return float(np.clip(slope / ship.nobs, 0, 1))


def fit(voyage):
    """Ratios and constant at the last row with their covariance, and the levels, which
    are sought once, from the start that the others have, too."""
    nuisances, stations = Nuisances(voyage), Stations(voyage)
    unknowns, sd = start(voyage, nuisances)
    levels = TYPICAL.copy()
    levels[0] = np.clip(sd / 2, 0.02, 10)
    ship = Ship(stations, rows(voyage, nuisances, unknowns, USUAL_FUSION), unknowns)
    # The library's own method, L-BFGS; neither smoother nor the levels' covariance.
    levels = ship.fit(levels, maxiter=200, disp=False, return_params=True)
    fusion = compass_share(ship, levels)
    step = np.inf
    while np.abs(step).max() >= SETTLED:
        ship = Ship(stations, rows(voyage, nuisances, unknowns, fusion), unknowns)
        found = ship.filter(levels, return_ssm=True)
        step = found.filtered_state[:UNKNOWNS, -1] - unknowns
        unknowns = unknowns + step
    covariance = found.filtered_state_cov[:8, :8, -1] * np.outer(SCALE, SCALE)
    covariance[CONSTANT, CONSTANT] += REFERENCE_SD_DEG**2
    return unknowns[:8] * SCALE, covariance, levels


def main():
    voyage = Voyage.read(sys.argv[1])
    clock, processor = time.perf_counter(), time.process_time()
    unknowns, covariance, levels = fit(voyage)
    answer = {
        "observations": len(voyage),
        "seconds": time.perf_counter() - clock,
        "processor_seconds": time.process_time() - processor,
        "unknowns": unknowns.tolist(),
        "covariance": covariance.tolist(),
        "levels": levels.tolist(),
    }
    print(json.dumps(answer))


if __name__ == "__main__":
    main()
