# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether the linear model holds in a window, and what it leaves out where it does not."""

from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.identify.blocks import blocks_of
from quad_ident_ros.identify.change import LARGEST_SHARE
from quad_ident_ros.identify.signals import Signal


@dataclass(frozen=True)
class Validity:
    """
    Whether K/((s+a)(s+b)) is what an output follows, by the most that it leaves out.

    holds: None where that is unknown; share: of the acceleration that is left out at most; tilt:
    the largest, rad, or None; why: the reason in words.
    """

    holds: bool | None
    share: float | None
    tilt: float | None
    why: str


def validity(signal: Signal) -> Validity:
    """Return the Validity of a Signal: of z the largest block counts, of angles the rms."""
    blocks = blocks_of(signal if signal.start_ns is not None else replace(signal, start_ns=0), 0)
    if not len(blocks):
        return Validity(None, None, None, 'the record is too short to judge')
    limited = np.isinf(blocks.neglected)
    if limited.any():
        return Validity(False, None, None, f'for {100 * limited.mean():.0f} % of the time the '
                        'rotors cannot give the input, which is beyond speed_min or speed_max of '
                        'the vehicle file: the linear model does not hold there')
    if signal.attitude is None:
        return Validity(None, None, None, 'no attitude is recorded: U1 counts as vertical')
    tilt = float(blocks.tilt.max())
    if signal.output == 'z':
        share = float(blocks.neglected.max()) / GRAVITY
        what = f'at a tilt of {np.degrees(tilt):.0f} deg, drag is up to {_of(share)} the thrust'
        if signal.at_rest:
            what += ', including the part of U1 that the tilt takes'
    else:
        usual = float(np.sqrt(np.mean(blocks.target ** 2)))
        share = float(np.sqrt(np.mean(blocks.neglected ** 2))) / usual if usual > 0 else 0.0
        what = (f'at a tilt of {np.degrees(tilt):.0f} deg, coupling with the other axes is up to '
                f'{_of(share)} the angular acceleration')
    holds = share <= LARGEST_SHARE
    return Validity(holds, share, tilt, f'{what}: the linear model '
                    + ('holds' if holds else f'omits more than {100 * LARGEST_SHARE:.0f} % '
                       'and does not hold'))


def _of(share: float) -> str:
    """Return a share as it stands before what it is a share of; a large one is a multiple."""
    return f'{100 * share:.0f} % of' if share < 10 else f'{share:.2g} times'
