# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
From flights to the user's simulator and back: whether the gap in MuJoCo falls as promised.

The nominal vehicle of each case becomes an MJCF model, which stands for the user's. The flights
are diagnosed against what is read of it, the corrected vehicle is written into it again, and both
models fly in MuJoCo along the flight held out, from the same starts. No label is needed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import mujoco
import numpy as np

from quad_ident_ros.cluster import cluster, results
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.effects.registry import NULL
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.flights import Track
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.model.dynamics import steps_within
from quad_ident_ros.model.vehicle import load_vehicle, Vehicle
from quad_ident_ros.user_simulator.plan import plan_of
from quad_ident_ros.vehicle_files.export import Export, export, mean_left
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.written import read_back, with_code

STEP = 0.002        # s, at most: MuJoCo's usual step
BEFORE = 0.3        # s of commands before a start, in which actuators and delays settle
LEAST = 0.05        # of the nominal model's gap: what is promised to fall less is not judged
KEPT = 0.95         # of what is promised must come true


@dataclass(frozen=True)
class Fall:
    """
    Velocity gaps, m/s, on the flight held out of a case.

    verdict: what is named; before, after: in MuJoCo with the model of the user and the exported
    one; promised_before, promised: by our own equations, with what the files and code carry.
    """

    name: str
    verdict: tuple[str, ...]
    before: float
    after: float
    promised_before: float
    promised: float

    @property
    def judged(self) -> bool:
        """Whether enough is promised to judge it."""
        return self.promised_before - self.promised > LEAST * self.promised_before

    @property
    def share(self) -> float:
        """Return the share of the promised fall that came true."""
        return (self.before - self.after) / (self.promised_before - self.promised)


class InMujoco:
    """A model of MuJoCo, and the code beside it, as a Predictor."""

    def __init__(self, text: str, code: str | None, vehicle: Vehicle) -> None:
        """Compile; vehicle: the nominal one, whose thrust at a rotor speed is the control."""
        self.model = mujoco.MjModel.from_xml_string(text)
        self.vehicle = replace(vehicle, effects={})
        self.code: dict = {}
        if code is not None:
            exec(code, self.code)

    def __call__(self, track: Track, vehicle: Vehicle, z: np.ndarray, starts: np.ndarray,
                 first: np.ndarray, count: int) -> np.ndarray:
        """Return the states (B, count + 1, 13) of rollouts, as a Predictor; z has no effects."""
        course = track.course
        steps, last = steps_within(course.t), len(course.t) - 1
        plan = plan_of(self.vehicle, NULL, course, track.states[:1], np.array([0]), last)
        controls = self.vehicle.thrust_coefficient * plan.sent[0] ** 2
        out = np.empty((len(first), count + 1, 13))
        mujoco.set_mjcb_passive(None)
        if self.code:
            self.code['install'](self.model)
        try:
            for row, (begin, start) in enumerate(zip(np.asarray(first), starts, strict=True)):
                now = steps * int(begin)
                out[row] = self._fly(start, controls, plan.dt[0], now, steps, count)
        finally:
            mujoco.set_mjcb_passive(None)
        return out

    def _fly(self, start: np.ndarray, controls: np.ndarray, dt: np.ndarray, now: int, steps: int,
             count: int) -> np.ndarray:
        """Return the states (count + 1, 13) from step `now` on, the body held until then."""
        data = mujoco.MjData(self.model)
        line = self.code['Commands']() if 'Commands' in self.code else None
        early = now - int(np.searchsorted(np.cumsum(dt[:now][::-1]), BEFORE))
        early = max(early, 0)
        data.ctrl[:] = controls[early]
        data.act[:] = controls[early][:len(data.act)]
        states = [start]
        for k in range(early, now + steps * count):
            if k <= now:
                self._put(data, start)
            if line is None:
                data.ctrl[:] = controls[k]
            parts = int(np.ceil(dt[k] / STEP - 1e-9))
            self.model.opt.timestep = dt[k] / parts
            for _ in range(parts):
                if line is not None:
                    line.command(self.model, data, controls[k])
                mujoco.mj_step(self.model, data)
            if k >= now and (k + 1 - now) % steps == 0:
                states.append(np.concatenate([data.qpos[:3], data.qvel[:3], data.qpos[3:7],
                                              data.qvel[3:6]]))
        return np.array(states)

    @staticmethod
    def _put(data: mujoco.MjData, state: np.ndarray) -> None:
        """Put the body where a state has it: MuJoCo's rate of a free body is in its axes, too."""
        data.qpos[:7] = [*state[:3], *state[6:10]]
        data.qvel[:6] = [*state[3:6], *state[10:13]]


def fall_of(folder: Path) -> Fall:
    """Diagnose the flights of a case against MuJoCo's model; raises InputError where refused."""
    ours = load_vehicle(folder / 'vehicle.yaml')
    theirs = export(ours, 'mujoco')
    source = Source('quad.xml', theirs.text)
    user = read_back(theirs, source, ours)
    if theirs.code is not None:
        user = with_code(theirs, user, ours)
    records = [read_csv(path) for path in sorted(folder.glob('flight_*.csv'))]
    found = diagnose(records, user)
    corrected = found.corrected(user)
    made = export(corrected, 'mujoco', source, mean_left(corrected, records))
    carried = read_back(made, replace(source, text=made.text), corrected)
    if made.code is not None:
        carried = with_code(made, carried, corrected)
    track = _held_out(records, user)
    falls = [_velocity_gap(track, *one) for one in (
        (user, InMujoco(theirs.text, _code(theirs), user)),
        (user, InMujoco(made.text, _code(made), user)), (user,), (carried,))]
    return Fall(folder.name, found.verdict, *falls)


def falls_of(folders: Sequence[Path], jobs: int) -> list[Fall | str]:
    """Return the Fall of each case, or why it is refused, as they come."""
    found: list[Fall | str] = []
    with cluster(workers=jobs) as client:
        for done in results(client, _fall_in, folders):
            if done.error is not None:
                raise done.error
            found.append(done.value)
            print(_line(found[-1]), flush=True)
    return found


def _fall_in(folder: Path) -> Fall | str:
    try:
        return fall_of(folder)
    except InputError as error:
        return f'{folder.name}: refused: {error}'


def _line(one: Fall | str) -> str:
    if isinstance(one, str):
        return one
    said = f'{100 * one.share:.1f} %' if one.judged else 'too little is promised'
    return (f'{one.name}: {", ".join(one.verdict)}: in MuJoCo {one.before:.4f} to {one.after:.4f} '
            f'm/s, promised {one.promised_before:.4f} to {one.promised:.4f} m/s: {said}')


def summary(results: Sequence[Fall | str]) -> tuple[str, bool]:
    """Return how many of the Falls came true, in words, and whether one did not."""
    judged = [one for one in results if isinstance(one, Fall) and one.judged]
    true = [one for one in judged if one.share >= KEPT]
    least = f', the least {100 * min(one.share for one in judged):.1f} %' if judged else ''
    said = (f'{len(true)} of {len(judged)} gaps fall in MuJoCo by at least {100 * KEPT:.0f} % of '
            f'what was promised{least}; {len(results) - len(judged)} cases had nothing to judge')
    return said, len(true) < len(judged)


def page(results: Sequence[Fall | str], command: str, version: str) -> str:
    """Return the Falls of a run as a page in Markdown, with the command that made it."""
    lines = ['# From flights into MuJoCo', '', f'`{command}`, version {version}:', '',
             f'{summary(results)[0]}.', '',
             'Velocity gaps in m/s along the flight held out; what was promised is by our own '
             'equations, with what the written', 'model and its code carry.', '',
             '| case | named | in MuJoCo | after | promised from | to | share come true |',
             '| --- | --- | --: | --: | --: | --: | --: |']
    for one in sorted(results, key=lambda one: one.name if isinstance(one, Fall) else one):
        if isinstance(one, str):
            lines.append(f'| {one.replace("|", "/")} | | | | | | - |')
            continue
        gaps_there = (one.before, one.after, one.promised_before, one.promised)
        share = f'{100 * one.share:.1f} %' if one.judged else '-'
        lines.append('| ' + ' | '.join([one.name, ', '.join(one.verdict),
                                        *(f'{gap:.4f}' for gap in gaps_there), share]) + ' |')
    return '\n'.join(lines) + '\n'


def _held_out(records: Sequence[FlightRecord], vehicle: Vehicle) -> Track:
    return replace(take_in(records, vehicle, None, RULES).held_out, guide=None)


def _velocity_gap(track: Track, vehicle: Vehicle, *predictor: InMujoco) -> float:
    horizon = gaps.horizon_of([track], RULES)
    return gaps.gap([gaps.ends(track, vehicle, nominal(vehicle), horizon, *predictor)])['velocity']


def _code(found: Export) -> str | None:
    return None if found.code is None else found.code.text
