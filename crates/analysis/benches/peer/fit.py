"""The peer's side of `make bench-peer`: docs/science.md, §7, in NumPy.

`fit.py VOYAGE.csv PRODUCT.json` prints the fit and how long it took as JSON, reading the
file not counted; beside it, not timed, the fit by the levels that the product found. What
can be is done for all samples at once; the filter goes step by step, since its gain
depends on the weights before. The levels are sought in the plainest way: each in turn to
the lowest point of a parabola.
"""

import json
import sys
import time

import numpy as np

from magnetism import CONSTANT, POPULATION_SD, SCALE, UNKNOWNS, Nuisances, Voyage, rows
from noise import TYPICAL, Stations, whiten

ALIGNMENT_SD_DEG = 0.5
REFERENCE_SD_DEG = 0.5
LOG_SD = np.array([0.7, 0.6, 0.6, 0.5, 0.7, 0.5, 0.5])
USUAL_FUSION = 0.7
# Rounds of levels and unknowns: sweeps over the levels, and the step that settles.
ROUNDS = [(3, 0.01), (1, 5e-4)]
# The compass's part of what is new in every row, beside a gyro.
OF_WHITE = 0.85
BLOCK_S = 4 * 86_400
# The levels are sought on so many stretches of so many rows.
STRETCHES, STRETCH = 4, 1000


def prior_information():
    variance = np.ones(UNKNOWNS)
    variance[CONSTANT] = ALIGNMENT_SD_DEG**2 + REFERENCE_SD_DEG**2
    return np.diag(1 / variance)


def start(voyage, nuisances):
    """Unknowns by Huber's weights on some 4000 rows taken for independent, and the
    residuals' spread."""
    every = -(-len(voyage) // 4000)
    unknowns = np.zeros(UNKNOWNS)
    prior = prior_information()
    white = Stations(voyage).white[::every]
    voyage = voyage[::every]
    nuisances = Nuisances(voyage)
    for _ in range(30):
        r = rows(voyage, nuisances, unknowns, USUAL_FUSION)
        sizes = np.sort(np.abs(r.residual))
        sd = max(sizes[len(sizes) // 2] / 0.6744898, 0.02)
        own_sd = sd * np.sqrt(white)
        weight = np.minimum(2.5 / (np.abs(r.residual) / own_sd), 1) / own_sd**2
        weighted = r.columns * weight[:, None]
        score = weighted.T @ r.residual - prior @ unknowns
        step = np.linalg.solve(weighted.T @ r.columns + prior, score)
        unknowns = unknowns + step
        if np.abs(step).max() < 3e-3:
            break
    return unknowns, sd


def fit_levels(stations, r, prior, pull, levels, sweeps):
    """The levels by restricted maximum likelihood: each in turn to the lowest point of
    a parabola, `sweeps` times."""

    def objective(logs):
        found = whiten(stations, r, np.exp(logs))
        information, score = found.normal()
        information += prior
        score += pull
        far = ((logs - np.log(TYPICAL)) / LOG_SD) ** 2
        _, log_determinant = np.linalg.slogdet(information)
        gained = score @ np.linalg.solve(information, score)
        return found.loss() - gained + log_determinant + far.sum()

    logs = np.log(levels)
    here = objective(logs)
    for _ in range(sweeps):
        for k in range(len(logs)):
            here, logs = improve(objective, logs, k, here)
    return np.exp(logs)


def improve(objective, logs, k, here):
    def at(offset):
        moved = logs.copy()
        moved[k] += offset
        return objective(moved), offset

    below, above = at(-0.3)[0], at(0.3)[0]
    curvature, slope = below + above - 2 * here, (above - below) / 2
    if curvature > 0:
        offset = float(np.clip(-slope / curvature * 0.3, -0.9, 0.9))
    else:
        offset = -np.copysign(0.9, slope)
    value, chosen = min((here, 0.0), (below, -0.3), (above, 0.3), at(offset))
    moved = logs.copy()
    moved[k] += chosen
    return value, moved


def compass_share(stations, r, levels):
    """w of eq. 14: the trace of V^-1 V_compass over that of V^-1 V."""

    def log_variance(nudge):
        nudged = levels.copy()
        nudged[0] *= np.exp(OF_WHITE * nudge)
        nudged[4] *= np.exp(nudge)
        return whiten(stations, r, nudged).log_variance()

    slope = (log_variance(0.05) - log_variance(-0.05)) / 0.2
    return float(np.clip(slope / len(r.residual), 0, 1))


def in_the_tail(unknowns, covariance):
    """The prior's information where Student's tails have it: six degrees of freedom
    for the seven ratios together, three for the constant."""
    prior = prior_information()
    distance = np.diag(prior)[:8] * (np.diag(covariance)[:8] + unknowns[:8] ** 2)
    prior[:7, :7] /= (6 + distance[:7].sum()) / (6 + 7)
    prior[7, 7] /= (3 + distance[7]) / (3 + 1)
    return prior


def inflation(voyage, found, covariance):
    """How much the scores of four-day stretches vary beyond what the noise says."""
    number = np.floor(voyage.time_s / BLOCK_S)
    begins = np.flatnonzero(np.diff(number, prepend=np.nan))
    columns = found.innovations[:, 1:]
    per_variance = found.weight / found.variance
    scores = np.add.reduceat(columns * (per_variance * found.innovations[:, 0])[:, None], begins)
    seen = np.einsum("bi,ij,bj->", scores, covariance, scores)
    expected = 0.0
    for begin, end in zip(begins, np.append(begins[1:], len(voyage))):
        weighted = columns[begin:end] * per_variance[begin:end, None]
        share = weighted.T @ columns[begin:end] @ covariance
        expected += np.trace(share) - np.trace(share @ share)
    return max(seen / expected, 1.0) if expected > 1 else 1.0


def fit(voyage, given=None):
    """Ratios and constant at the last row with their covariance, and the levels, which
    are sought if they are not given."""
    nuisances, stations = Nuisances(voyage), Stations(voyage)
    unknowns, sd = start(voyage, nuisances)
    sought = TYPICAL.copy()
    sought[0] = np.clip(sd / 2, 0.02, 10)
    fusion, prior = USUAL_FUSION, prior_information()
    spacing = (len(voyage) - STRETCH) // (STRETCHES - 1)
    chosen = (spacing * np.arange(STRETCHES)[:, None] + np.arange(STRETCH)).ravel()
    looked_at = voyage[chosen]
    few_nuisances, few_stations = Nuisances(looked_at), Stations(looked_at)
    for sweeps, settled in ROUNDS:
        few = rows(looked_at, few_nuisances, unknowns, fusion)
        levels = given
        if given is None:
            pull = -prior @ unknowns
            levels = fit_levels(few_stations, few, prior, pull, sought, sweeps)
            sought = levels
        fusion = compass_share(few_stations, few, levels)
        while True:
            found = whiten(stations, rows(voyage, nuisances, unknowns, fusion), levels)
            information, score = found.normal()
            covariance = np.linalg.inv(information + prior)
            step = covariance @ (score - prior @ unknowns)
            unknowns = unknowns + step
            prior = in_the_tail(unknowns, covariance)
            if np.abs(step).max() < settled:
                break
    found = whiten(stations, rows(voyage, nuisances, unknowns, fusion), levels)
    covariance = np.linalg.inv(found.normal()[0] + prior)
    covariance *= inflation(voyage, found, covariance)
    return (*at_last(unknowns, covariance, found), levels)


def at_last(unknowns, covariance, found):
    """From the first row, where drift begins, to the last, in own units."""
    follows = np.eye(UNKNOWNS)
    drifting, scale = [0, 2], POPULATION_SD[[0, 2]]
    follows[drifting] -= found.states[5:, 1:] / scale[:, None]
    covariance = follows @ covariance @ follows.T
    covariance[np.ix_(drifting, drifting)] += found.covariance[5:, 5:] / np.outer(scale, scale)
    unknowns = unknowns.copy()
    unknowns[drifting] += found.states[5:, 0] / scale
    covariance = covariance[:8, :8] * np.outer(SCALE, SCALE)
    covariance[CONSTANT, CONSTANT] += REFERENCE_SD_DEG**2
    return unknowns[:8] * SCALE, covariance


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
    with open(sys.argv[2], encoding="ascii") as product:
        given = np.array(json.load(product)["levels"])
    answer["unknowns_by_its_levels"] = fit(voyage, given)[0].tolist()
    print(json.dumps(answer))


if __name__ == "__main__":
    main()
