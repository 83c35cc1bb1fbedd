# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The low pass of a gyro."""

import numpy as np
from scipy.signal import butter


class LowPass:
    """A Butterworth low pass of samples (3,): cutoff Hz, order, rate Hz; begins at `value`."""

    def __init__(self, cutoff, order, rate, value):
        """Begin at rest at a value."""
        self.b, self.a = butter(order, cutoff, fs=rate)
        self.held = [value * (np.sum(self.b[i:]) - np.sum(self.a[i:]))
                     for i in range(1, order + 1)]

    def __call__(self, value):
        """Return the output for the next sample."""
        out = self.b[0] * value + self.held[0]
        after = [*self.held[1:], np.zeros_like(value)]
        self.held = [self.b[i + 1] * value - self.a[i + 1] * out + after[i]
                     for i in range(len(after))]
        return out
