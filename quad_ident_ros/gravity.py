# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The acceleration of gravity where no vehicle file says it."""

GRAVITY = 9.80665
"""
m/s^2: the unit g of accelerometers, by definition (3rd General Conference on Weights and Measures,
1901). On the ground of the Earth it is 9.78 to 9.83.
"""
