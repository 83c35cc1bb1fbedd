# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The vehicle model with all effects in plain NumPy, over a batch of rollouts at once.

Written from the formulas of docs/effects.md, to compare the compiled one with.
"""

import numpy as np

from quad_ident_ros.effects.registry import mapping


def roll_out(vehicle, theta, x0, t, followed, speeds, added, volt_drop, first, count):
    """
    Return the states of rollouts by Runge-Kutta, (B, count + 1, 13), one step per sample.

    Args: theta (P,) one parameter set; x0 (B, 13); t (N,) s; followed, speeds (N, n),
    added (N, 3, n) rad/s; volt_drop (N,) V; first (B,) samples; all as
    quad_ident_ros.model.rollout takes them.
    """
    model = _Model(vehicle, theta)
    out = np.empty((len(x0), count + 1, 13))
    out[:, 0] = x = x0.copy()
    speed = speeds[first]
    for k in range(count):
        row = first + k
        h = (t[row + 1] - t[row])[:, None]
        command, now, drop = followed[row], t[row][:, None], volt_drop[row][:, None]
        extra = added[row]
        half = np.exp(-h / (2 * model.lag))
        full = half ** 2
        begin = 6 * (1 - full) * model.lag / h - 4 * half - full
        gap = speed - command
        k1 = model.derivative(x, command, gap * begin, extra[:, 0], now, drop)
        k2 = model.derivative(x + h / 2 * k1, command, gap * half, extra[:, 1], now + h / 2, drop)
        k3 = model.derivative(x + h / 2 * k2, command, gap * half, extra[:, 1], now + h / 2, drop)
        k4 = model.derivative(x + h * k3, command, gap * full, extra[:, 2], now + h, drop)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        x[:, 6:10] /= np.linalg.norm(x[:, 6:10], axis=1, keepdims=True)
        speed = command + gap * full
        out[:, k + 1] = x
    return out


class _Model:
    """The constants of a vehicle with all effects that act in a rollout."""

    def __init__(self, vehicle, theta):
        effects = mapping(theta)

        def of(name):
            return np.array(list(effects[name].values()))

        self.lag = of('motor_lag')[0]
        self.rotor_drag, self.body_drag = of('rotor_drag')[0], of('body_drag')[[0, 0, 1]]
        self.wind, (self.axial, self.lift) = of('wind'), of('inflow')
        self.ground, (self.per_volt, self.per_second) = of('ground_effect')[0], of('battery_sag')
        self.gyro, self.flapping = of('rotor_gyro')[0], of('blade_flapping')[0]
        self.mass = vehicle.mass + of('mass_offset')[0]
        self.inertia = vehicle.inertia * of('inertia_mismatch')
        self.arms = np.array([rotor.position for rotor in vehicle.rotors]) - of('com_offset')
        self.spins = np.array([rotor.spin for rotor in vehicle.rotors])
        self.gains = np.full(len(self.spins), of('thrust_scale')[0])
        for key, loss in effects['rotor_fault'].items():
            self.gains[int(key.rpartition('_')[2]) - 1] *= 1 - loss
        self.vehicle = vehicle
        self.hover = len(self.spins) * np.sqrt(
            vehicle.mass * vehicle.gravity / (len(self.spins) * vehicle.thrust_coefficient))

    def derivative(self, x, command, gap, extra, t, drop):
        """Return the derivatives of states x (B, 13)."""
        vehicle, rate = self.vehicle, x[:, 10:]
        rotation = _rotation(x[:, 6:10])
        air = np.einsum('bij,bi->bj', rotation, x[:, 3:6] - self.wind)
        speed = command + gap + extra
        local = air[:, None] + np.cross(rate[:, None], self.arms)
        height = x[:, 2:3] + rotation[:, 2] @ self.arms.T
        radius = vehicle.rotor_radius
        ratio = radius / (4 * np.maximum(height, radius / 2 + 1e-9))
        gain = self.gains * (1 - self.per_volt * drop) * (1 - self.per_second * t)
        gain = gain / (1 - np.minimum(self.ground * ratio ** 2, 0.75))
        share = speed / self.hover
        force = np.empty((*speed.shape, 3))
        force[..., :2] = -(self.rotor_drag * share)[..., None] * local[..., :2]
        force[..., 2] = (vehicle.thrust_coefficient * speed ** 2 * gain
                         + self.lift / len(self.spins) * (local[..., :2] ** 2).sum(axis=-1)
                         - self.axial * share * local[..., 2])
        moment = np.cross(self.arms, force).sum(axis=1)
        moment[:, 2] += vehicle.torque_coefficient * speed ** 2 @ self.spins
        moment[:, 0] -= self.flapping * (share * local[..., 1]).sum(axis=1)
        moment[:, 1] += self.flapping * (share * local[..., 0]).sum(axis=1)
        spin = self.gyro * (speed @ self.spins)
        moment[:, 0] += spin * rate[:, 1]
        moment[:, 1] -= spin * rate[:, 0]
        moment[:, 2] -= self.gyro / self.lag * (gap @ self.spins)
        moment -= vehicle.rotational_drag * rate * np.abs(rate)
        total = force.sum(axis=1) - vehicle.linear_drag * air
        total -= self.body_drag * np.linalg.norm(air, axis=1, keepdims=True) * air
        change = np.empty_like(x)
        change[:, :3] = x[:, 3:6]
        change[:, 3:6] = np.einsum('bij,bj->bi', rotation, total) / self.mass
        change[:, 5] -= vehicle.gravity
        change[:, 6] = -(x[:, 7:10] * rate).sum(axis=1) / 2
        change[:, 7:10] = (x[:, 6:7] * rate + np.cross(x[:, 7:10], rate)) / 2
        change[:, 10:] = (moment - np.cross(rate, self.inertia * rate)) / self.inertia
        return change


def _rotation(quaternion):
    w, x, y, z = (quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)).T
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x),
                      1 - 2 * (x * x + y * y)]]).transpose(2, 0, 1)
