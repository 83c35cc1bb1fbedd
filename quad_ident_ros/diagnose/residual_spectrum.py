# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""At which frequencies the residual acceleration lies."""

from collections.abc import Sequence

import numpy as np
import scipy

from quad_ident_ros.diagnose.residual_wrench import ResidualWrench, WINDOW
from quad_ident_ros.model.vehicle import Vehicle

SEGMENT = 5.0           # s: 0.2 Hz apart, and a flight of 24 s has eight such segments
HIGHEST = 0.5 / WINDOW  # Hz: a mean over WINDOW keeps 64 % of a sine there, and less above


def residual_spectrum(flights: Sequence[ResidualWrench], vehicle: Vehicle
                      ) -> tuple[np.ndarray, np.ndarray]:
    """
    Return frequencies (F,) Hz and the power density (F, 6) of the residual acceleration.

    In (m/s^2)^2/Hz of x, y, z, then in (rad/s^2)^2/Hz about them, of the ResidualWrench of
    flights: by Welch's method (IEEE Transactions on Audio and Electroacoustics 15, 1967), over
    their unbroken stretches, the mean of each segment taken off. Stretches that are too short
    for half a segment do not count; a segment is no longer than the longest stretch.
    """
    per = np.array([vehicle.mass] * 3 + list(vehicle.inertia))
    step = float(np.median(np.concatenate([np.diff(flight.t) for flight in flights])))
    parts = [flight.values[flight.stretch == number] / per for flight in flights
             for number in range(flight.stretch[-1] + 1)]
    length = min(round(SEGMENT / step), max(map(len, parts)))
    parts = [part for part in parts if 2 * len(part) >= length]
    densities = [scipy.signal.welch(part, 1.0 / step, nperseg=min(length, len(part)),
                                    nfft=length, axis=0)[1] for part in parts]
    density = np.average(densities, axis=0, weights=[len(part) for part in parts])
    frequency = np.fft.rfftfreq(length, step)
    shown = (frequency > 0.0) & (frequency <= HIGHEST * (1.0 + 1e-9))
    return frequency[shown], density[shown]
