# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Another plant: bodies in MuJoCo, under the same wrench, controller, sensors and influences.

A case takes `Bodies` where it would take `Reality`, with the same arguments. Rotors with inertia
(`rotor_gyro`) are bodies that really spin and are driven against the vehicle. Beside that it may
have what a single body cannot: a payload on a cable (`mass_offset`; what swings of it may be
called `unknown`), and a hull in MuJoCo's ellipsoid model of fluids (`body_drag` of another law,
with the mass of the air that it moves).

`Identified` are motors with the rise and fall that others identified of Crazyflies (drone-models
on PyPI; `motor_lag` of another law), `IdentifiedThrust` is their thrust (`thrust_scale` of
another law). Both are parts that any plant takes.

States are those of the vehicle's own centre of mass, without the payload.
"""

from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
import tomllib

import mujoco
import numpy as np

from withheld.actuators import Motor
from withheld.constants import GRAVITY, hover_speed, rotation_of
from withheld.fly import Lost
from withheld.influence import Influence
from withheld.plant import Reality

STEP = 0.001            # s, of MuJoCo
AIR_DENSITY = 1.2       # kg/m^3
ROTOR_MASS = 1e-7       # kg: the mass of the rotors is in that of the vehicle
LOAD_RADIUS = 0.01      # m
MODEL = """
<mujoco>
  <compiler inertiafromgeom="false" angle="radian"/>
  <option timestep="{step}" integrator="RK4" gravity="0 0 -{gravity}" density="{density}">
    <flag contact="disable"/>
  </option>
  <worldbody>
    <body name="vehicle">
      <freejoint/>
      <inertial pos="0 0 0" mass="{mass}" fullinertia="{inertia}"/>
      <site name="centre"/>
      {hull}
      {rotors}
    </body>
    {payload}
  </worldbody>
  {cable}
  <actuator>{wrench}</actuator>
</mujoco>
"""
HULL = ('<geom type="ellipsoid" size="{a} {a} {c}" mass="0" fluidshape="ellipsoid" '
        'fluidcoef="{blunt} 0 0 0 0"/>')
# A body without such a geom would have the drag of the box that has its inertia.
SMOOTH = ('<geom type="ellipsoid" size="1e-4 1e-4 1e-4" mass="0" fluidshape="ellipsoid" '
          'fluidcoef="0 0 0 0 0"/>')
ROTOR = ('<body pos="{place}"><joint type="hinge" axis="0 0 {sign}"/>'
         '<inertial pos="0 0 0" mass="{mass}" diaginertia="{half} {half} {inertia}"/>'
         f'{SMOOTH}</body>')
PAYLOAD = ('<body name="payload"><freejoint/><inertial pos="0 0 0" mass="{mass}" '
           'diaginertia="{inertia} {inertia} {inertia}"/><site name="load"/>'
           f'{SMOOTH}</body>')
CABLE = ('<tendon><spatial limited="true" range="0 {length}" solreflimit="0.004 1" '
         'solimplimit="0.99 0.999 0.0001"><site site="centre"/><site site="load"/></spatial>'
         '</tendon>')


@dataclass(frozen=True)
class Payload:
    """A small load that hangs on a cable from the centre of mass: mass kg, length m."""

    mass: float
    length: float


class Bodies(Reality):
    """
    A Reality whose motion is MuJoCo's.

    Args as of Reality, and payload: a Payload or None; hull: as much drag as `body_drag` has with
    the size `hull`, by MuJoCo's law for ellipsoids. Raises Lost where the rotors would have more
    inertia than the vehicle.
    """

    def __init__(self, params, effects, *args, payload=None, hull=0.0, **options):
        """Make the bodies of what Reality makes of the effects."""
        super().__init__(params, effects, *args, **options)
        self.payload = payload
        self.spun = np.broadcast_to(self.rotor_inertia, self.num_rotors).astype(float)
        self.rotor_inertia = 0.0        # of no part of the wrench: they are bodies
        self.spins = slice(6, 6 + self.num_rotors) if self.spun.any() else slice(6, 6)
        self.model = mujoco.MjModel.from_xml_string(self._text(hull))
        self.data = mujoco.MjData(self.model)
        self._begun = False

    def _text(self, hull):
        rest = self.inertia - self.spun.sum() * np.diag([0.5, 0.5, 1.0])
        if np.linalg.eigvalsh(rest)[0] <= 0.0:
            raise Lost
        parts = dict.fromkeys(('hull', 'rotors', 'payload', 'cable'), '')
        if self.spun.any():
            parts['rotors'] = ''.join(
                ROTOR.format(place=_row(place), sign=-int(spin), mass=ROTOR_MASS,
                             half=0.5 * inertia, inertia=inertia)
                for place, spin, inertia in zip(self.rotor_geometry, self.rotor_dir, self.spun,
                                                strict=True))
        if hull:
            a = 0.5 * float(np.linalg.norm(self.rotor_geometry[0]))
            # In a flow along x: density, coefficient, projected area, speed squared.
            blunt = 0.08 * hull * self.mass / (AIR_DENSITY * np.pi * a * 0.5 * a)
            parts['hull'] = HULL.format(a=a, c=0.5 * a, blunt=blunt)
        if self.payload:
            mass = self.payload.mass
            parts['payload'] = PAYLOAD.format(mass=mass, inertia=0.4 * mass * LOAD_RADIUS ** 2)
            parts['cable'] = CABLE.format(length=self.payload.length)
        wrench = ''.join(f'<general site="centre" gear="{_row(row)}"/>' for row in np.eye(6))
        return MODEL.format(
            step=STEP, gravity=GRAVITY, density=AIR_DENSITY if hull else 0.0, wrench=wrench,
            mass=self.mass, inertia=_row([*np.diag(rest), rest[0, 1], rest[0, 2], rest[1, 2]]),
            **parts)

    def advance(self, state, command, step):
        """Return the packed state (16 + n,) after a step (s) with a command held."""
        command = np.clip(command, self.rotor_speed_min, self.rotor_speed_max)
        count = int(np.ceil(step / STEP - 1e-9))
        h = self.model.opt.timestep = step / count
        self.model.body_mass[1] = self.mass         # it may drop something
        self._place_bodies(state)
        speeds = state[16:]
        for _ in range(count):
            speeds = self._step(speeds, command, h)
            self.time += h
        q, v = self.data.qpos, self.data.qvel
        return np.concatenate([q[:3], v[:3], q[[4, 5, 6, 3]], v[3:6], state[13:16], speeds])

    def _place_bodies(self, state):
        q, v = self.data.qpos, self.data.qvel
        q[:3], q[3:7], v[:3], v[3:6] = state[:3], state[[9, 6, 7, 8]], state[3:6], state[10:13]
        if self._begun:
            return
        self._begun = True
        v[self.spins] = state[16:] if self.spun.any() else []
        if self.payload:
            q[-7:] = [*(state[:3] - [0.0, 0.0, self.payload.length]), 1.0, 0.0, 0.0, 0.0]
            v[-6:] = [*state[3:6], 0.0, 0.0, 0.0]

    def _step(self, speeds, command, h):
        q, v = self.data.qpos, self.data.qvel
        if self.spun.any():
            speeds = v[self.spins].copy()
        middle, after = self._turned(speeds, command, h)
        rotation = rotation_of(q[[4, 5, 6, 3]])
        air = self.steady + sum(one.wind(self.time, q[:3]) for one in self.influences)
        self._place = q[:3].copy(), rotation, v[:3].copy()
        force, moment = self.compute_body_wrench(v[3:6].copy(), middle,
                                                 rotation.T @ (v[:3] - air))
        self.data.ctrl[:] = [*force, *moment]
        self.model.opt.wind[:] = air
        if self.spun.any():
            # The torque of the motors, which hold the speeds against the vehicle that turns
            # beneath them; that of the air on the blades is in the wrench.
            turns = (after - speeds) / h
            yaw = (moment[2] + self.rotor_dir @ (self.spun * turns)) / self.inertia[2, 2]
            self.data.qfrc_applied[self.spins] = self.spun * (turns - self.rotor_dir * yaw)
        mujoco.mj_step(self.model, self.data)
        return v[self.spins].copy() if self.spun.any() else after

    def _turned(self, speeds, command, h):
        """Return the speeds of the rotors after half a step and after a step."""
        if self.motor is not None:
            middle = self.motor.turn(speeds, command, 0.5 * h)
            return middle, self.motor.turn(middle, command, 0.5 * h)
        if not self.lag:
            return command, command
        return (command + (speeds - command) * np.exp(-share * h / self.lag)
                for share in (0.5, 1.0))


class _Crazyflie:
    """What was identified of a Crazyflie's rotors, in shares of its speed and thrust in hover."""

    def __init__(self, name):
        # Its file alone: to import drone_models changes how scipy works for all others.
        [folder] = find_spec('drone_models').submodule_search_locations
        text = (Path(folder) / 'data' / 'params.toml').read_text(encoding='utf-8')
        known = tomllib.loads(text)[name]
        offset, linear, square = known['rpm2thrust']
        weight = 0.25 * known['mass'] * GRAVITY
        rpm = (-linear + np.sqrt(linear ** 2 + 4.0 * square * (weight - offset))) / (2.0 * square)
        self.thrust = np.array([offset, linear * rpm, square * rpm ** 2]) / weight
        # Rise, its growth with the speed, fall, and its growth, 1/s.
        self.rates = np.array(known['rotor_dyn_coef']) * [1.0, rpm, 1.0, rpm]
        self.rising = 1.0 / (self.rates[0] + 2.0 * self.rates[1])


class Identified(Motor):
    """
    Motors as identified of a Crazyflie: rise and fall differ, both depend on the speed.

    Args: size, 1 is a time constant of 12 ms where the speed rises in hover; params of the nominal
    vehicle; rng; name of a drone in drone-models.
    """

    def __init__(self, size, params, rng, name='cf21B_500'):
        """Take the rates over, with speeds as shares of that in hover."""
        known = _Crazyflie(name)
        self.hover, self.parameters = hover_speed(params), {'time': 0.012 * size}
        self.rates = known.rates * known.rising / (0.012 * size) if size else None

    def turn(self, speeds, command, step):
        """Return the speeds (n,) after a step, s."""
        if self.rates is None:
            return command
        x, aim = speeds / self.hover, command / self.hover
        up, fast, down, slow = self.rates
        rate = np.where(aim > x, up + fast * (aim + x), down + slow * (aim + x))
        return self.hover * (aim + (x - aim) * np.exp(-step * rate))


class IdentifiedThrust(Influence):
    """
    Thrust as identified of a Crazyflie: a polynomial of the speed, as nominal in hover.

    Args: size of what it differs from the square by, 1 as identified; the others as of Identified.
    """

    def __init__(self, size, params, rng, name='cf2x_P250'):
        """Take the polynomial over, with speeds as shares of that in hover."""
        self.size, self.hover, self.thrust = size, hover_speed(params), _Crazyflie(name).thrust
        self.parameters = {'share': size}

    def gain(self, now):
        """Return the factors (n,) on the thrust."""
        x = np.maximum(now.speeds / self.hover, 0.1)
        return 1.0 + self.size * (self.thrust @ [x ** -2, x ** -1, x ** 0] - 1.0)


def _row(values):
    return ' '.join(f'{value:.17g}' for value in values)
