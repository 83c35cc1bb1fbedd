# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a function of state and command closes of a gap, in words."""

from quad_ident_ros.diagnose.gap import closed as gap_closed
from quad_ident_ros.diagnose.result import Diagnosis, ShareClosed


def ceiling_line(found: Diagnosis) -> str:
    """Return how much of the velocity gap a function of state and command closes, in words."""
    one = found.ceiling
    if not one.shown:
        return ('the ceiling: no function of state and command, learnt without the held-out '
                'flight, is shown to close more of its gap')
    closed = share_of(one.open_loop)
    closed += (f', {share_of(one.given_attitude)} given the recorded attitude'
               if one.open_loop.group == 'velocity' else f' of the {one.open_loop.group} gap')
    return (f'the ceiling: a {" and ".join(one.shown)} as a function of state and command, learnt '
            f'without the held-out flight and added to the effects, would close {closed}')


def residual_line(found: Diagnosis) -> str:
    """Return what the residual function closes beside the effects, in words."""
    one = found.ceiling
    if not one.shown:
        what = ('none is written' if found.vehicle.residual is None
                else 'that of the vehicle file stays')
        return (f'residual: {what}, because no function of state and command is shown to '
                f'close more of the gap on {found.held_out} than the effects do')
    gap, group = found.gap, one.open_loop.group
    by_effects = gap_closed(gap.before_own[group], gap.after[group], gap.noise[group])
    return (f'residual ({" and ".join(one.shown)}): the effects close '
            f'{100 * by_effects:.0f} % of the {group} gap on {found.held_out} (held out), '
            f'with it {share_of(one.open_loop)}; it is not a cause, and outside the range of '
            'these flights it stays constant')


def share_of(one: ShareClosed) -> str:
    """Return a share with its standard error, in words."""
    error = '' if one.std is None else f' ± {float(f"{100 * one.std:.1g}"):g}'
    return f'{100 * one.closed:.0f}{error} %'
