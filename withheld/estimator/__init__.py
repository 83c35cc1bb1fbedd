# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
States as real logs have them: out of an estimator, which the controller flies on, too.

A case takes one of the `SETUPS` (setups.py) of its part and flies an `EstimatedWorld` (flight.py)
where other cases fly a `World`: the same arguments, and `setup=SETUPS['development'][0]`. Its
Flown has the estimates as `measured`; `exact` is what sensors without noise would have shown, so
that the strength of an effect is measured against what the estimator makes of it
(realities.size_of), as everywhere.

An inertial measurement unit (IMU) at 500 Hz gives the mean rate and specific force of each step,
with bias, white noise and the vibration of the rotors; position, and velocity or attitude or
heading, come more seldom and late (sensors.py). The filter integrates the former and is corrected
by the latter (kalman.py, complementary.py, both of an estimate.py). What is recorded: its
position, velocity and attitude, and the gyro behind a low pass and without the estimated bias.
"""
