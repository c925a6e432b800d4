"""The ship's part of the model: rows of the linear problem, all samples at once.

Equation numbers are those of docs/science.md. Unknowns are the seven ratios and the
constant, each in the population's standard deviations (the constant in degrees), and
three nuisances in their own: a gyro's leftover speed error and the two phases of the
daily swing of variation. A voyage with a gyro alone has no fourth.
"""

from dataclasses import dataclass

import numpy as np

POPULATION_SD = np.array([1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008])
SCALE = np.append(POPULATION_SD, 1.0)
CONSTANT = 7
UNKNOWNS = 11
SPEED_ERROR_SD = 0.15
DAILY_SD_DEG = 0.08
# A residual beyond this says nothing about the heading.
FUSION_LIMIT_DEG = 3.0


def wrap(degrees):
    """Into (-180, 180]."""
    return 180.0 - (180.0 - degrees) % 360.0


@dataclass
class Voyage:
    """Columns of the CSV, sorted by time."""

    time_s: np.ndarray
    lat: np.ndarray
    lon: np.ndarray
    compass: np.ndarray
    deviation: np.ndarray
    variation: np.ndarray
    h: np.ndarray
    z: np.ndarray
    sog: np.ndarray
    windows: np.ndarray

    @staticmethod
    def read(path):
        columns = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
        order = np.argsort(columns[0], kind="stable")
        time_micros, *others = (column[order] for column in columns)
        return Voyage(time_micros * 1e-6, *others)

    def __len__(self):
        return len(self.time_s)

    def __getitem__(self, chosen):
        return Voyage(*(column[chosen] for column in vars(self).values()))


class Nuisances:
    """What their columns are made of."""

    def __init__(self, voyage):
        cos_lat = np.cos(np.radians(voyage.lat))
        # sin(error) = V cos(course) / (902.5 cos(latitude)).
        self.northerly_error = np.degrees(np.arcsin(voyage.sog / (902.5 * cos_lat)))
        phase = 2 * np.pi * (voyage.time_s % 86_400 / 86_400 + voyage.lon / 360)
        daily = DAILY_SD_DEG * np.clip(24_000 / voyage.h, 0.5, 4.0)
        self.daily = daily * np.array([np.sin(phase), np.cos(phase)])


@dataclass
class Rows:
    """Residuals and minus their slopes."""

    residual: np.ndarray
    columns: np.ndarray
    # By bx and by, degrees per nT.
    drift: np.ndarray


class Needle:
    """Where the compass settles on a magnetic heading (eq. 4, 5), with slopes (eq. 9)."""

    def __init__(self, parameters, magnetic_deg, h, z):
        bx, chi13, by, chi23, difference, chi12, chi21 = parameters
        d = difference / 2
        psi = np.radians(magnetic_deg)
        hx, hy = h * np.cos(psi), -h * np.sin(psi)
        ux = (1 + d) * hx + chi12 * hy + chi13 * z + bx
        uy = chi21 * hx + (1 - d) * hy + chi23 * z + by
        self.compass_deg = np.degrees(np.arctan2(-uy, ux))
        self.field = hx, hy, z, ux, uy
        self.parameters = d, chi12, chi21

    def slopes(self):
        """Of the deviation, degrees, by the parameters; and of the compass heading
        by the magnetic one."""
        hx, hy, z, ux, uy = self.field
        d, chi12, chi21 = self.parameters
        squared = ux**2 + uy**2
        s, c = -uy / squared, ux / squared
        by_parameters = np.degrees([s, z * s, c, z * c, (hx * s - hy * c) / 2, hy * s, hx * c])
        ux_turning = (1 + d) * hy - chi12 * hx
        uy_turning = chi21 * hy - (1 - d) * hx
        return by_parameters, (uy * ux_turning - ux * uy_turning) / squared


def rows(voyage, nuisances, unknowns, fusion):
    """Rows at `unknowns`, taken at the fused heading (eq. 14)."""
    parameters, constant = unknowns[:7] * POPULATION_SD, unknowns[CONSTANT]

    def needle_at(heading):
        needle = Needle(parameters, heading - constant, voyage.h, voyage.z)
        return needle, wrap(heading - needle.compass_deg)

    by_reference = voyage.compass + voyage.deviation
    _, predicted = needle_at(by_reference)
    apart = wrap(voyage.deviation - predicted)
    apart = np.clip(apart, -FUSION_LIMIT_DEG, FUSION_LIMIT_DEG)
    heading = by_reference - (1 - fusion) * apart
    needle, predicted = needle_at(heading)
    by_parameters, turning = needle.slopes()
    follows = 1 + (1 - fusion) * (1 - turning)
    columns = np.empty((len(voyage), UNKNOWNS))
    columns[:, :7] = (by_parameters * follows).T * POPULATION_SD
    columns[:, CONSTANT] = turning * follows
    northerly = np.cos(np.radians(heading + voyage.variation))
    columns[:, 8] = SPEED_ERROR_SD * nuisances.northerly_error * northerly
    columns[:, 9:] = nuisances.daily.T
    residual = wrap(voyage.deviation - predicted) - columns[:, 8:] @ unknowns[8:]
    return Rows(residual, columns, by_parameters[[0, 2]].T)
