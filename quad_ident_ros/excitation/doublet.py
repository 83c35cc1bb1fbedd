# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Doublet: a pulse up and a pulse down of the same width."""

import numpy as np

from quad_ident_ros import schema


def doublet(t, amplitude=1.0, time=0.0, width=0.5):
    """Return +amplitude for `width` s from `time` s on, then -amplitude for as long, then 0."""
    amplitude = schema.number('amplitude', amplitude)
    start = schema.number('time', time)
    width = schema.number('width', width, 0.0, exclusive=True)
    phase = np.floor((t - start) / width + 1e-9)
    return amplitude * ((phase == 0).astype(float) - (phase == 1))
