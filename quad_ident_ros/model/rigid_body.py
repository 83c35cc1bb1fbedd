# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The equations of motion of a multirotor with all effects, many rollouts side by side.

Vehicle vector, (19,) or (19, LANES): mass, Ix, Iy, Iz, gravity, thrust and torque coefficient,
rotor radius, linear drag (3), rotational drag (3), 1 where the linear drag acts along world axes,
sum of the hover speeds, Ixy, Ixz, Iyz as they stand in the matrix of inertia. Where the vehicle
has a residual function, its table follows.
"""


import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.registry import (
    AIR,
    BODY,
    GUST,
    GUSTS,
    mark,
    PLACES,
    ROWS_OF,
    TABLE,
    THRUST,
    WRENCH,
)
from quad_ident_ros.effects.rotor_gyro_by_spin import inertia_of
from quad_ident_ros.model import residual_in_flight
from quad_ident_ros.model.situation import (
    ALONG,
    ARMS_X,
    ARMS_Y,
    AX,
    AY,
    AZ,
    COM_X,
    COM_Y,
    COM_Z,
    FULL,
    FX,
    FY,
    FZ,
    GAIN,
    GUIDE_BEGIN,
    GUIDE_END,
    GUIDED,
    HEIGHT,
    HX,
    HY,
    HZ,
    IX,
    IXY,
    IXZ,
    IY,
    IYZ,
    IZ,
    MASS,
    MX,
    MY,
    MZ,
    PER_HOVER,
    PER_IX,
    PER_IY,
    PER_IZ,
    PER_MASS,
    PER_XX,
    PER_XY,
    PER_XZ,
    PER_YY,
    PER_YZ,
    PER_ZZ,
    PX,
    PZ,
    R00,
    R01,
    R02,
    R10,
    R11,
    R12,
    R20,
    R21,
    R22,
    RADIUS,
    REACTION,
    ROTOR_ROWS,
    RX,
    RY,
    RZ,
    SPEED,
    SPIN,
    SPIN_UP,
    SPINS,
    SPUN,
    STAGE,
    STEADY_X,
    TIME,
    TORQUE,
    TX,
    TY,
    TZ,
    UX,
    UY,
    UZ,
    VOLT_DROP,
    VOLT_SHARE,
    VX,
    VY,
    VZ,
    WIND_X,
    WIND_Y,
    WIND_Z,
    WX,
    WY,
    WZ,
)
from quad_ident_ros.model.vehicle import Vehicle

STATE = 13      # position, velocity (world), quaternion (body to world), rate (body)
# Besides the rotors: force z, moment x, y, z (body), spin sum, fall of the voltage, V and share,
# specific force x, y (body), how far along the flight it is, 0 to 1; for a residual function,
# smoothed commands after these.
INPUT = 10
GUSTY = ROWS_OF[GUSTS.name, GUSTS.forms[0].name]
# Parameters of a rotor's inertia about its axis: of all alike; for those of spin 1, and of -1.
INERTIA = PLACES['rotor_gyro', 'momentum'].start
OF_SPIN = (PLACES['rotor_gyro', 'momentum_by_spin'].start,
           PLACES['rotor_gyro', 'momentum_by_spin'].start + 1)
CONSTANTS = 19
ROUNDING = 2.0 ** -52   # of a moment of inertia: smaller products count as 0


def vehicle_vector(vehicle: Vehicle, drag_in_world: bool = False) -> np.ndarray:
    """Return the constants of the equations of motion, (19,), in the order stated above."""
    return np.array([vehicle.mass, *vehicle.inertia, vehicle.gravity, vehicle.thrust_coefficient,
                     vehicle.torque_coefficient, vehicle.rotor_radius, *vehicle.linear_drag,
                     *vehicle.rotational_drag, float(drag_in_world),
                     len(vehicle.rotors) * vehicle.hover_speed, *vehicle.products])


def with_residual(constants: np.ndarray, vehicle: Vehicle) -> np.ndarray:
    """Return constants (..., 19) with the table of the vehicle's residual function, if any."""
    if vehicle.residual is None:
        return constants
    table = vehicle.residual.table
    return np.concatenate([constants, np.broadcast_to(
        table, (*constants.shape[:-1], len(table)))], axis=-1)


def rotor_table(vehicle: Vehicle) -> np.ndarray:
    """Return the rotors' places (m) and spins, (n, 4)."""
    return np.array([[*rotor.position, rotor.spin] for rotor in vehicle.rotors], float)


@compiled(fused=True, inlined=True)
def prepare(v: np.ndarray, places: np.ndarray, theta: np.ndarray, s: np.ndarray,
            rotors: np.ndarray) -> None:
    """Write what stays the same along a flight: what acts, mass, inertia, centre of mass, arms."""
    for i in range(s.shape[1]):
        s[MASS, i], s[IX, i], s[IY, i], s[IZ, i] = v[0, i], v[1, i], v[2, i], v[3, i]
        s[IXY, i], s[IXZ, i], s[IYZ, i] = v[16, i], v[17, i], v[18, i]
        s[COM_X, i] = s[COM_Y, i] = s[COM_Z, i] = 0.0
        s[RADIUS, i], s[PER_HOVER, i] = v[7, i], 1.0 / v[15, i]
        s[WIND_X, i] = s[WIND_Y, i] = s[WIND_Z, i] = 0.0
        s[ARMS_X, i] = s[ARMS_Y, i] = s[TORQUE, i] = 1.0
    mark(theta, s)
    BODY(theta, s)
    AIR(theta, s)
    for i in range(s.shape[1]):
        for k in range(3):
            s[STEADY_X + k, i] = s[WIND_X + k, i]
        s[PER_MASS, i] = 1.0 / s[MASS, i]
        s[PER_IX, i], s[PER_IY, i], s[PER_IZ, i] = 1.0 / s[IX, i], 1.0 / s[IY, i], 1.0 / s[IZ, i]
    full = 0.0
    for i in range(s.shape[1]):
        if abs(s[IXY, i]) + abs(s[IXZ, i]) + abs(s[IYZ, i]) > ROUNDING * s[IX, i]:
            full = 1.0
    for i in range(s.shape[1]):
        s[FULL, i] = full
    if full != 0.0:
        _invert(s)
    for j in range(places.shape[0]):
        for i in range(s.shape[1]):
            rotors[j, RX, i] = s[ARMS_X, i] * places[j, 0] - s[COM_X, i]
            rotors[j, RY, i] = s[ARMS_Y, i] * places[j, 1] - s[COM_Y, i]
            rotors[j, RZ, i] = places[j, 2] - s[COM_Z, i]
        spin = places[j, 3]
        own = OF_SPIN[0] if spin > 0.0 else OF_SPIN[1]
        other = OF_SPIN[1] if spin > 0.0 else OF_SPIN[0]
        for i in range(s.shape[1]):
            rotors[j, SPIN, i] = spin
            rotors[j, SPUN, i] = spin * (theta[INERTIA, i]
                                         + inertia_of(theta[own, i], theta[other, i]))


@compiled(fused=True)
def _invert(s: np.ndarray) -> None:
    """Write the inverse of the matrix of inertia, its moments as they are in s."""
    for i in range(s.shape[1]):
        ix, iy, iz = s[IX, i], s[IY, i], s[IZ, i]
        xy, xz, yz = s[IXY, i], s[IXZ, i], s[IYZ, i]
        s[PER_XX, i], s[PER_XY, i] = iy * iz - yz * yz, xz * yz - xy * iz
        s[PER_YY, i], s[PER_XZ, i] = ix * iz - xz * xz, xy * yz - xz * iy
        s[PER_ZZ, i], s[PER_YZ, i] = ix * iy - xy * xy, xy * xz - yz * ix
        per = 1.0 / (ix * s[PER_XX, i] + xy * s[PER_XY, i] + xz * s[PER_XZ, i])
        for row in (PER_XX, PER_YY, PER_ZZ, PER_XY, PER_XZ, PER_YZ):
            s[row, i] *= per


@compiled(fused=True)
def _turn_with_products(s: np.ndarray, dx: np.ndarray) -> None:
    """Write how the rate changes by I w' = M - w x I w where the inertia has products."""
    for i in range(s.shape[1]):
        wx, wy, wz = s[WX, i], s[WY, i], s[WZ, i]
        hx = s[IX, i] * wx + s[IXY, i] * wy + s[IXZ, i] * wz
        hy = s[IXY, i] * wx + s[IY, i] * wy + s[IYZ, i] * wz
        hz = s[IXZ, i] * wx + s[IYZ, i] * wy + s[IZ, i] * wz
        mx = s[MX, i] - (wy * hz - wz * hy)
        my = s[MY, i] - (wz * hx - wx * hz)
        mz = s[MZ, i] - (wx * hy - wy * hx)
        dx[10, i] = s[PER_XX, i] * mx + s[PER_XY, i] * my + s[PER_XZ, i] * mz
        dx[11, i] = s[PER_XY, i] * mx + s[PER_YY, i] * my + s[PER_YZ, i] * mz
        dx[12, i] = s[PER_XZ, i] * mx + s[PER_YZ, i] * my + s[PER_ZZ, i] * mz


@compiled(fused=True, inlined=True)
def _place(x: np.ndarray, s: np.ndarray) -> None:
    """
    Write position, velocity, rotation, rates and air velocity of the states x (13, LANES).

    A guided lane has its rotation, and the rate of its rotors against the air, from the guide.
    """
    for i in range(s.shape[1]):
        for k in range(6):
            s[PX + k, i] = x[k, i]
        if s[GUIDED, i] != 0.0:
            share = s[STAGE, i]
            w = (1.0 - share) * s[GUIDE_BEGIN, i] + share * s[GUIDE_END, i]
            a = (1.0 - share) * s[GUIDE_BEGIN + 1, i] + share * s[GUIDE_END + 1, i]
            b = (1.0 - share) * s[GUIDE_BEGIN + 2, i] + share * s[GUIDE_END + 2, i]
            c = (1.0 - share) * s[GUIDE_BEGIN + 3, i] + share * s[GUIDE_END + 3, i]
            for k in range(3):
                s[TX + k, i] = ((1.0 - share) * s[GUIDE_BEGIN + 4 + k, i]
                                + share * s[GUIDE_END + 4 + k, i])
        else:
            w, a, b, c = x[6, i], x[7, i], x[8, i], x[9, i]
            s[TX, i], s[TY, i], s[TZ, i] = x[10, i], x[11, i], x[12, i]
        # Within a step a quaternion is not of unit length; its rotation is one all the same, or
        # the error of a step would depend on where the world's axes point.
        two = 2.0 / (w * w + a * a + b * b + c * c)
        s[R00, i] = 1.0 - two * (b * b + c * c)
        s[R01, i] = two * (a * b - w * c)
        s[R02, i] = two * (a * c + w * b)
        s[R10, i] = two * (a * b + w * c)
        s[R11, i] = 1.0 - two * (a * a + c * c)
        s[R12, i] = two * (b * c - w * a)
        s[R20, i] = two * (a * c - w * b)
        s[R21, i] = two * (b * c + w * a)
        s[R22, i] = 1.0 - two * (a * a + b * b)
        s[WX, i], s[WY, i], s[WZ, i] = x[10, i], x[11, i], x[12, i]
    for i in range(s.shape[1]):
        dx, dy = s[VX, i] - s[WIND_X, i], s[VY, i] - s[WIND_Y, i]
        dz = s[VZ, i] - s[WIND_Z, i]
        s[AX, i] = s[R00, i] * dx + s[R10, i] * dy + s[R20, i] * dz
        s[AY, i] = s[R01, i] * dx + s[R11, i] * dy + s[R21, i] * dz
        s[AZ, i] = s[R02, i] * dx + s[R12, i] * dy + s[R22, i] * dz


@compiled(fused=True, inlined=True)
def _rotors(s: np.ndarray, rotors: np.ndarray, places: np.ndarray) -> None:
    """Write the rotors' air velocities and heights, and the sum of their spins."""
    # A loop for each row: of more in one, LLVM does not see that they are apart, and takes lane
    # after lane instead of several at a time.
    for j in range(rotors.shape[0]):
        spin = places[j, 3]
        for i in range(s.shape[1]):
            rotors[j, UX, i] = s[AX, i] + s[TY, i] * rotors[j, RZ, i] - s[TZ, i] * rotors[j, RY, i]
        for i in range(s.shape[1]):
            rotors[j, UY, i] = s[AY, i] + s[TZ, i] * rotors[j, RX, i] - s[TX, i] * rotors[j, RZ, i]
        for i in range(s.shape[1]):
            rotors[j, UZ, i] = s[AZ, i] + s[TX, i] * rotors[j, RY, i] - s[TY, i] * rotors[j, RX, i]
        for i in range(s.shape[1]):
            rotors[j, HEIGHT, i] = (s[PZ, i] + s[R20, i] * rotors[j, RX, i]
                                    + s[R21, i] * rotors[j, RY, i]
                                    + s[R22, i] * rotors[j, RZ, i])
        for i in range(s.shape[1]):
            rotors[j, GAIN, i] = rotors[j, REACTION, i] = 1.0
        for i in range(s.shape[1]):
            s[SPINS, i] += spin * rotors[j, SPEED, i]


@compiled(fused=True, inlined=True)
def wrench(v: np.ndarray, places: np.ndarray, theta: np.ndarray, s: np.ndarray,
           rotors: np.ndarray) -> None:
    """Write force and moment (body) on the centre of mass, without gravity."""
    _rotors(s, rotors, places)
    THRUST(theta, s, rotors)
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            rotors[j, HX, i] = rotors[j, HY, i] = 0.0
            rotors[j, HZ, i] = v[5, i] * rotors[j, SPEED, i] ** 2 * rotors[j, GAIN, i]
    WRENCH(theta, s, rotors)
    for j in range(rotors.shape[0]):
        spin = places[j, 3]
        for i in range(s.shape[1]):
            s[FX, i] += rotors[j, HX, i]
            s[FY, i] += rotors[j, HY, i]
            s[FZ, i] += rotors[j, HZ, i]
        for i in range(s.shape[1]):     # a loop for each row: see _rotors
            s[MX, i] += rotors[j, RY, i] * rotors[j, HZ, i] - rotors[j, RZ, i] * rotors[j, HY, i]
        for i in range(s.shape[1]):
            s[MY, i] += rotors[j, RZ, i] * rotors[j, HX, i] - rotors[j, RX, i] * rotors[j, HZ, i]
        for i in range(s.shape[1]):
            torque = (s[TORQUE, i] * v[6, i] * rotors[j, SPEED, i] ** 2
                      * rotors[j, REACTION, i])
            s[MZ, i] += (rotors[j, RX, i] * rotors[j, HY, i] - rotors[j, RY, i] * rotors[j, HX, i]
                         + spin * torque)


@compiled(fused=True, inlined=True)
def derivative(x: np.ndarray, u: np.ndarray, v: np.ndarray, places: np.ndarray,
               theta: np.ndarray, s: np.ndarray, rotors: np.ndarray, dx: np.ndarray) -> None:
    """
    Write the derivative of the states x (13, LANES) into dx; the rotors' speeds are in `rotors`.

    Newton-Euler with a quaternion and the body rate, so that there is no singular attitude.
    u (INPUT, LANES) what acts besides the rotors, with smoothed commands for a residual function.
    """
    if s[GUSTY, 0] != 0.0:
        for i in range(s.shape[1]):
            s[ALONG, i] = u[9, i]
            for k in range(3):
                s[WIND_X + k, i] = s[STEADY_X + k, i]
        GUST(theta, s, rotors)
    _place(x, s)
    for i in range(s.shape[1]):
        s[FX, i] = s[FY, i] = s[FZ, i] = 0.0
        if v[14, i] == 0.0:
            s[FX, i] = -v[8, i] * s[AX, i]
            s[FY, i] = -v[9, i] * s[AY, i]
            s[FZ, i] = -v[10, i] * s[AZ, i]
        s[FX, i] += s[MASS, i] * u[7, i]
        s[FY, i] += s[MASS, i] * u[8, i]
        s[FZ, i] += u[0, i]
        wx, wy, wz = s[WX, i], s[WY, i], s[WZ, i]
        s[MX, i] = u[1, i] - v[11, i] * wx * abs(wx)
        s[MY, i] = u[2, i] - v[12, i] * wy * abs(wy)
        s[MZ, i] = u[3, i] - v[13, i] * wz * abs(wz) + s[SPIN_UP, i]
        s[SPINS, i] = u[4, i]
    wrench(v, places, theta, s, rotors)
    if v.shape[0] > CONSTANTS:
        residual_in_flight.add(u, INPUT, v, CONSTANTS, places, s, rotors)
    for i in range(s.shape[1]):
        per_mass = s[PER_MASS, i]
        fx, fy, fz = s[FX, i] * per_mass, s[FY, i] * per_mass, s[FZ, i] * per_mass
        for k in range(3):
            dx[k, i] = s[VX + k, i]
        dx[3, i] = s[R00, i] * fx + s[R01, i] * fy + s[R02, i] * fz
        dx[4, i] = s[R10, i] * fx + s[R11, i] * fy + s[R12, i] * fz
        dx[5, i] = s[R20, i] * fx + s[R21, i] * fy + s[R22, i] * fz - v[4, i]
        if v[14, i] != 0.0:
            dx[3, i] -= v[8, i] * (s[VX, i] - s[WIND_X, i]) * per_mass
            dx[4, i] -= v[9, i] * (s[VY, i] - s[WIND_Y, i]) * per_mass
            dx[5, i] -= v[10, i] * (s[VZ, i] - s[WIND_Z, i]) * per_mass
        w, a, b, c = x[6, i], x[7, i], x[8, i], x[9, i]
        wx, wy, wz = s[WX, i], s[WY, i], s[WZ, i]
        dx[6, i] = 0.5 * (-a * wx - b * wy - c * wz)
        dx[7, i] = 0.5 * (w * wx + b * wz - c * wy)
        dx[8, i] = 0.5 * (w * wy - a * wz + c * wx)
        dx[9, i] = 0.5 * (w * wz + a * wy - b * wx)
        ix, iy, iz = s[IX, i], s[IY, i], s[IZ, i]
        dx[10, i] = (s[MX, i] + (iy - iz) * wy * wz) * s[PER_IX, i]
        dx[11, i] = (s[MY, i] + (iz - ix) * wz * wx) * s[PER_IY, i]
        dx[12, i] = (s[MZ, i] + (ix - iy) * wx * wy) * s[PER_IZ, i]
    if s[FULL, 0] != 0.0:
        _turn_with_products(s, dx)


@compiled(fused=True)
def derivatives(v: np.ndarray, places: np.ndarray, theta: np.ndarray, t: np.ndarray,
                states: np.ndarray, speeds: np.ndarray, accelerations: np.ndarray,
                inputs: np.ndarray, out: np.ndarray) -> None:
    """
    Write the derivatives of given states, each by itself, into out (N, 13).

    Args: v (19, 1), places: the vehicle; theta (P,); t (N,) s; states (N, 13) of the centre of
    mass; speeds (N, n) rad/s of the rotors and accelerations (N, n) rad/s^2; inputs (N, INPUT).
    """
    x, dx = np.empty((STATE, 1)), np.empty((STATE, 1))
    s, rotors = np.zeros((TABLE, 1)), np.zeros((places.shape[0], ROTOR_ROWS, 1))
    parameters, u = np.empty((len(theta), 1)), np.empty((inputs.shape[1], 1))
    for k in range(len(theta)):
        parameters[k, 0] = theta[k]
    prepare(v, places, parameters, s, rotors)
    for n in range(len(t)):
        for k in range(STATE):
            x[k, 0] = states[n, k]
        for k in range(inputs.shape[1]):
            u[k, 0] = inputs[n, k]
        s[TIME, 0], s[VOLT_DROP, 0], s[SPIN_UP, 0] = t[n], inputs[n, 5], 0.0
        s[VOLT_SHARE, 0] = inputs[n, 6]
        for j in range(places.shape[0]):
            rotors[j, SPEED, 0] = speeds[n, j]
            s[SPIN_UP, 0] += rotors[j, SPUN, 0] * accelerations[n, j]
        derivative(x, u, v, places, parameters, s, rotors, dx)
        for k in range(STATE):
            out[n, k] = dx[k, 0]
