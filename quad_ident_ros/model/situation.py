# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What the parts of the vehicle model see of one another: rows of a table, one column per lane.

A lane is one rollout of the batch. `s` (ROWS, LANES) holds the vehicle, the rows named here;
`rotors` (n, ROTOR_ROWS, LANES) holds each rotor. SI units, world ENU, body FLU.
"""


# State: position and velocity (of the centre of mass, world), rotation matrix body to world by
# rows, body rate.
(PX, PY, PZ, VX, VY, VZ, R00, R01, R02, R10, R11, R12, R20, R21, R22, WX, WY, WZ,
 # What acts on the centre of mass, besides the rotors: force and moment, body.
 FX, FY, FZ, MX, MY, MZ,
 # Velocity of the vehicle against the air, body; wind, world, and what of it is steady.
 AX, AY, AZ, WIND_X, WIND_Y, WIND_Z, STEADY_X, STEADY_Y, STEADY_Z,
 # Sums over the rotors: spin * speed, and the moment about body z by which their speeds change.
 SPINS, SPIN_UP,
 # Rate of the body with which its rotors meet the air: the state's, or a record's.
 TX, TY, TZ,
 # Constants of the vehicle and of its flight, moments and products of inertia, the time and how
 # far along the flight that is, 0 to 1, the fall of the voltage in V and as a share of that of
 # reference; reciprocals of mass, of inertia, and of the sum of the hover speeds.
 MASS, IX, IY, IZ, IXY, IXZ, IYZ, COM_X, COM_Y, COM_Z, RADIUS, TIME, ALONG, VOLT_DROP,
 VOLT_SHARE,
 PER_MASS, PER_IX, PER_IY, PER_IZ, PER_HOVER,
 # Factors on the rotors' arms along body x and y, and on their reaction torque.
 ARMS_X, ARMS_Y, TORQUE,
 # 1 where a moment of inertia has products beside it, and then the inverse of the matrix.
 FULL, PER_XX, PER_YY, PER_ZZ, PER_XY, PER_XZ, PER_YZ,
 # 1 where a record gives attitude and rate for the motion of the centre of mass, see
 # rollout.roll_out; how far the integration is in its step, 0 to 1.
 GUIDED, STAGE) = range(70)

# The quaternion and the rate that the record gives, at the begin and at the end of a step.
GUIDE = 7
GUIDE_BEGIN, GUIDE_END = 70, 70 + GUIDE
ROWS = GUIDE_END + GUIDE

# A rotor: speed; its velocity against the air, body; factors on its thrust and on its reaction
# torque; its force, body; its place from the centre of mass, body; its height over ground; its
# spin, and its inertia about its axis times that.
(SPEED, UX, UY, UZ, GAIN, REACTION, HX, HY, HZ, RX, RY, RZ, HEIGHT, SPIN, SPUN,
 ROTOR_ROWS) = range(16)
