# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The spread of Levy-distributed steps by Mantegna's algorithm: the paper's eqs. (25), (26)."""

from math import gamma, pi, sin

from quad_ident_ros.errors import InputError

LEAST = 0.1     # below it steps span a hundred decades, which no search can use


def levy_sigma(exponent: float, form: str = 'mantegna') -> float:
    """
    Return the standard deviation of Mantegna's numerator for a Levy exponent lambda.

    The braces of eq. (26) to the power 1/lambda are sigma (R. Mantegna, Phys. Rev. E 49, 1994),
    not sigma squared as printed; 'printed' takes them so all the same. Raises InputError unless
    0.1 <= lambda < 2 (the paper's 1 < lambda <= 3 makes sigma zero at 2 and complex above).
    """
    if not LEAST <= exponent < 2.0:
        raise InputError(f'lambda: {exponent:g} is out of range, expected '
                         f'{LEAST:g} <= lambda < 2')
    braces = (gamma(1 + exponent) * sin(pi * exponent / 2)
              / (gamma((1 + exponent) / 2) * exponent * 2 ** ((exponent - 1) / 2)))
    sigma = braces ** (1 / exponent)
    return sigma ** 0.5 if form == 'printed' else sigma
