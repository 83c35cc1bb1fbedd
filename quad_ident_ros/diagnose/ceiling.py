# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How much of the gap any function of state and command closes on a flight it has not seen."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose.bench import Bench
from quad_ident_ros.diagnose.gap import Ends
from quad_ident_ros.diagnose.judgement import Judgement, stability
from quad_ident_ros.diagnose.measure import residual_wrenches
from quad_ident_ros.diagnose.residual_fit import residual_fit, windows_of
from quad_ident_ros.diagnose.residual_wrench import ResidualWrench
from quad_ident_ros.diagnose.result import Ceiling, Gap, GapGivenAttitude, ShareClosed
from quad_ident_ros.greybox.errors import GROUPS
from quad_ident_ros.greybox.flights import Track
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.model.residual_function import CHANNELS, ResidualFunction

PARTS = {'force': (('position', 'velocity'), range(3)),
         'moment': (('attitude', 'rate'), range(3, CHANNELS))}
"""What of a function counts by itself: groups of outputs, given the attitude, and channels."""


def ceiling_of(bench: Bench, judged: Judgement, wrenches: Sequence[ResidualWrench],
               noise: np.ndarray, gap: Gap, given_attitude: GapGivenAttitude
               ) -> tuple[Ceiling, ResidualFunction | None]:
    """
    Return the Ceiling and the function of state and command that reaches it, None where none does.

    Args: wrenches: what the model does not explain of the flights learnt from, and noise (12,):
    that of their states; gap and given_attitude of the flight held out, which say what noise makes
    of them. A function that the vehicle file has is put aside, for the new one learns what it
    does, too.
    """
    model, rules = judged.model, bench.rules
    bare = replace(bench.vehicle, residual=None)
    if bench.vehicle.residual is not None:
        wrenches = residual_wrenches(replace(bench, vehicle=bare), model.vectors, noise)
    learnt = residual_fit(windows_of(bench.tracks[:-1], bare, model.vectors[:-1], wrenches, rules),
                          rules)
    gain, residual, vehicle = dict.fromkeys(PARTS, 0.0), None, bench.vehicle
    if learnt is not None:
        ends = gaps.ends(bench.tracks[-1], replace(bare, residual=learnt), model.vectors[-1],
                         bench.horizon)
        gain = {name: stability((_only(ends, groups),), (_only(model.ends[-1], groups),),
                                judged.noise[-1], rules) for name, (groups, _) in PARTS.items()}
    shown = tuple(name for name, value in gain.items() if value > rules.shown)
    if learnt is not None and shown:
        residual = learnt.of([channel for name in shown for channel in PARTS[name][1]])
        vehicle = replace(bare, residual=residual)
    given = bench.tracks[-1]
    # A moment alone says nothing of the velocity where that is not measured, and little at once.
    told = 'rate' if shown == ('moment',) else 'velocity'
    free, led = (_share(bench, judged, track, gaps.ends(
        track, vehicle, model.vectors[-1], bench.horizon), group, of_noise[group])
        for track, group, of_noise in ((replace(given, guide=None), told, gap.noise),
                                       (given, 'velocity', given_attitude.noise)))
    return Ceiling(free, led, gain, shown), residual


def _only(ends: Ends, groups: Sequence[str]) -> Ends:
    """Return Ends with errors in some groups of outputs alone."""
    errors = np.zeros_like(ends.errors)
    for name in groups:
        errors[:, GROUPS[name]] = ends.errors[:, GROUPS[name]]
    return Ends(errors, ends.t)


def _share(bench: Bench, judged: Judgement, track: Track, after: Ends, group: str, noise: float
           ) -> ShareClosed:
    """
    Return what is closed of the gap of a group, with a standard error by the jackknife.

    noise: the gap of the group that noise alone makes.
    """
    model, part = judged.model, GROUPS[group]
    z = model.vectors[-1]
    before = gaps.ends(track, bench.vehicle, nominal(bench.vehicle) + z - model.z, bench.horizon)
    block = np.unique((before.t // bench.rules.steady_block).astype(int), return_inverse=True)[1]
    sums = [np.bincount(block, np.sum(one.errors[:, part] ** 2, axis=1))
            for one in (before, after)]
    counts = np.bincount(block)

    def closed(kept: np.ndarray) -> float:
        first, last = (float(np.sqrt(one[kept].sum() / counts[kept].sum())) for one in sums)
        return gaps.closed(first, last, noise)

    every = np.arange(len(counts))
    without = [closed(every != k) for k in every if len(every) > 1]
    std = float(np.sqrt(len(without) - 1) * np.std(without)) if without else None
    return ShareClosed(gaps.gap([after]), closed(every >= 0), std, group)
