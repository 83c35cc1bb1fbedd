# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How far the gap shrinks on the flight held out, and where it lies."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose import residual_wrench as wrenches
from quad_ident_ros.diagnose.bench import Bench
from quad_ident_ros.diagnose.judgement import Judgement
from quad_ident_ros.diagnose.residual_wrench import ResidualWrench
from quad_ident_ros.diagnose.result import (
    Channel,
    Gap,
    GapGivenAttitude,
    Pictures,
    Unexplained,
)
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.errors import UNITS
from quad_ident_ros.greybox.flights import Track
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.model.vehicle import Vehicle

TRANSLATION = ('position', 'velocity')
ROTATION = ('attitude', 'rate')


def open_loop_gap(bench: Bench, judged: Judgement) -> Gap:
    """Return the Gap of full open-loop predictions."""
    track = replace(bench.tracks[-1], guide=None)
    head = _gap(track, bench, judged, bench.horizon)
    horizons = {bench.horizon: head}
    for horizon in {*gaps.HORIZONS} - {bench.horizon}:
        with suppress(InputError):  # between the gaps of a lossy log no stretch may be as long
            horizons[horizon] = _gap(track, bench, judged, horizon)
    return Gap(horizon=bench.horizon, units=UNITS, **head,
               closed=gaps.closed(*(head[stage]['velocity']
                                    for stage in ('before_own', 'after', 'noise'))),
               horizons={str(horizon): values for horizon, values in sorted(horizons.items())},
               without={cause.effect: gaps.gap([gaps.ends(
                   track, bench.vehicle, judged.without[cause].vectors[-1], bench.horizon)])
                        for cause in judged.material})


def gap_given_attitude(bench: Bench, judged: Judgement) -> GapGivenAttitude:
    """Return the gap of position and velocity, attitude and rate taken from the record."""
    head = _gap(bench.tracks[-1], bench, judged, bench.horizon)
    parts = {stage: {name: head[stage][name] for name in TRANSLATION}
             for stage in ('before', 'before_own', 'after', 'noise')}
    return GapGivenAttitude(horizon=bench.horizon, **parts, closed=gaps.closed(
        *(parts[stage]['velocity'] for stage in ('before_own', 'after', 'noise'))))


def _gap(track: Track, bench: Bench, judged: Judgement, horizon: float) -> dict:
    """Return {stage: {group: gap}} of a Track of the flight held out, with intervals."""
    z0 = nominal(bench.vehicle)
    after_z = judged.model.vectors[-1]
    before, nuisance, after = (gaps.ends(track, bench.vehicle, z, horizon) for z in (
        z0, z0 + after_z - judged.model.z, after_z))
    return {'before': gaps.gap([before]), 'before_own': gaps.gap([nuisance]),
            'after': gaps.gap([after]),
            'noise': gaps.noise_gap(track, bench.vehicle, after_z, judged.noises[-1], horizon),
            'before_interval': gaps.interval([before], bench.rules),
            'after_interval': gaps.interval([after], bench.rules)}


def residual_wrenches(bench: Bench, vectors: Sequence[np.ndarray], noise: np.ndarray
                      ) -> tuple[ResidualWrench, ...]:
    """Return the ResidualWrench of each flight learnt from with its vector (Z,)."""
    return tuple(wrenches.residual_wrench(track, bench.vehicle, z, noise)
                 for track, z in zip(bench.tracks[:-1], vectors, strict=False))


def channels(found: tuple[ResidualWrench, ...], vehicle: Vehicle, rules: Rules
             ) -> tuple[Channel, ...]:
    """Return the Channels of residual wrenches, the one with the largest share first."""
    rows = []
    for channel, share in wrenches.shares(found, vehicle).items():
        column = wrenches.CHANNELS.index(channel)
        regime, inside = wrenches.regime(found, channel, rules.regime)
        values, errors = (np.concatenate([getattr(one, name)[:, column] for one in found])
                          for name in ('values', 'errors'))
        rows.append(Channel(channel, float(share), regime, float(inside),
                            wrenches.band(found, channel), float(np.sqrt(np.mean(values ** 2))),
                            float(np.sqrt(np.mean(errors ** 2))),
                            'N' if channel[0] == 'F' else 'N m'))
    return tuple(sorted(rows, key=lambda row: -row.share))


def unexplained(groups: Sequence[str], after: tuple[Channel, ...]) -> tuple[Unexplained, ...]:
    """Return the channels of what remains in groups of outputs, the largest share first."""
    kinds = {'F' if group in TRANSLATION else 'M' for group in groups}
    rows = [row for row in after if row.channel[0] in kinds]
    rows = [row for row in rows if row.rms > row.noise_rms] or rows
    return tuple(Unexplained(row.channel, row.regime, row.share_in_regime, row.band,
                             float(np.sqrt(max(0.0, row.rms ** 2 - row.noise_rms ** 2))),
                             row.unit) for row in rows)


def pictures(bench: Bench, judged: Judgement, before: tuple, after: tuple) -> Pictures:
    """Return what the pictures are drawn from."""
    track, z0 = replace(bench.tracks[-1], guide=None), nominal(bench.vehicle)
    ends = [gaps.ends(track, bench.vehicle, z, bench.horizon)
            for z in (z0, judged.model.vectors[-1])]
    t = ends[0].t + bench.horizon
    states = np.stack([np.interp(t, track.course.t, column) for column in track.states.T], axis=1)
    return Pictures(t, states, ends[0], ends[1], before, after)
