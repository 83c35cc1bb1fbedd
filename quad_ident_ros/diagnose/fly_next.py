# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What to fly next: the manoeuvre that separates what the flights did not, by its information.

Each standard manoeuvre is flown in simulation with what was found, and its information on the
parameters is added to that of the flights (Fedorov, Theory of Optimal Experiments, 1972). Half the
square of a distance in standard errors is the expected logarithm of the Bayes factor.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.evidence import occam, Quadratic
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.selection import Selection
from quad_ident_ros.effects.registry import mapping
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop, FULL_VOLTAGE, RATES
from quad_ident_ros.flight.trajectories import TRAJECTORIES
from quad_ident_ros.greybox.flights import Flight, flight_of, RATE, track_of
from quad_ident_ros.greybox.linear import linearise
from quad_ident_ros.greybox.normal import marginal, normal_of
from quad_ident_ros.greybox.nuisances import Layout, NuisanceValues
from quad_ident_ros.greybox.parameters import nominal, SPLIT
from quad_ident_ros.model.vehicle import Vehicle

# What is flown and proposed; no verdict is a matter of these.
DURATION = 20.0     # s of a manoeuvre
SEED = 0            # of its trajectory
ROLLOUTS = 12       # of a manoeuvre that are looked at, for all of them
MOST = 3            # manoeuvres that are proposed to show what was not


@dataclass(frozen=True, eq=False)
class Manoeuvre:
    """
    A trajectory as it would be flown, and what it would say of the columns that flights share.

    information (C, C), over the scatter; span (3,) m along x, y and z; height (2,) m, the lowest
    and the highest; speed m/s, the highest.
    """

    trajectory: str
    information: np.ndarray
    span: tuple
    height: tuple
    speed: float

    def data(self) -> dict:
        """Return what is to be flown, as data."""
        return {'trajectory': self.trajectory, 'duration': DURATION, 'seed': SEED,
                'span': list(self.span), 'height': list(self.height), 'speed': self.speed}


def manoeuvres(selection: Selection, flights: Sequence[Flight], vehicle: Vehicle, z: np.ndarray
               ) -> list[Manoeuvre]:
    """
    Return the Manoeuvres that a vehicle with a parameter vector z (Z,) can fly.

    Rate and noise are those of the flights that the Selection is of.
    """
    scatter, noise = selection.quadratic.scatter, np.median(selection.noise, axis=0)
    nuisances, columns = NuisanceValues.of(selection.best.nuisances, 1), _columns(selection)
    layout = Layout(columns, nuisances.columns, 1)
    precision = scipy.linalg.block_diag(np.zeros((len(columns), len(columns))),
                                        nuisances.precision)
    rate = float(np.clip(1.0 / np.median([flight.period for flight in flights]), RATES[0], RATE))
    found = []
    for name in TRAJECTORIES:
        try:
            record = fly_closed_loop(vehicle, mapping(z[SPLIT:]), name, duration=DURATION,
                                     rate=rate, seed=SEED)
        except InputError:      # it leaves its course: not one to propose
            continue
        flight = flight_of(track_of(record, vehicle, FULL_VOLTAGE))
        few = np.linspace(0, len(flight.first) - 1, ROLLOUTS).round().astype(int)
        part = replace(flight, first=flight.first[few])
        normal = normal_of([linearise(part, vehicle, z, part.states[part.first], layout.wanted,
                                      noise)], [part], layout)
        share = len(flight.first) / len(few) / scatter
        normal = marginal(replace(normal, information=normal.information * share), len(columns),
                          precision)
        place, speed = flight.states[:, :3], np.linalg.norm(flight.states[:, 3:6], axis=1)
        found.append(Manoeuvre(
            name, normal.information,
            tuple(float(value) for value in np.ptp(place, axis=0)),
            (float(place[:, 2].min()), float(place[:, 2].max())), float(speed.max())))
    return found


def separation(information: np.ndarray, selection: Selection, sets: dict, rules: Rules) -> float:
    """
    Return how far apart the two closest of sets of causes are, standard errors.

    From each set as it was found to the nearest point of each other one, or of that one with any
    further cause, which costs what it does in the choice among sets; inf where there is but one.
    Args: information (C, C); sets {causes: distances (C,) from no effect}.
    """
    least = np.inf
    for one, distances in sets.items():
        for other in sets:
            if not set(one) <= set(other):
                least = min(least, *(
                    cost + _distance(information, selection, one, distances, others)
                    for cost, others in _with_another(information, selection, one, other, rules)))
    return float(np.sqrt(max(least, 0.0)))


def _with_another(information: np.ndarray, selection: Selection, one: tuple, other: tuple,
                  rules: Rules) -> list[tuple[float, tuple]]:
    """Return [(cost, causes)]: a set and with it each cause that neither it nor `one` has."""
    found, known = [(0.0, other)], _places(selection, other)
    effects = {cause.effect for cause in (*one, *other)}
    for cause in _causes(selection):
        if cause.effect not in effects:
            places = _places(selection, [cause])
            block = _left(information, places, known, selection.quadratic)
            prior = selection.quadratic.prior[np.ix_(places, places)]
            cost = -2.0 * occam(block, prior, 1.0, [cause], rules)
            found.append((cost, (*other, cause)))
    return found


def _distance(information: np.ndarray, selection: Selection, one: tuple, distances: np.ndarray,
              other: tuple) -> float:
    """Return the square of the distance from a set as it was found to the nearest of another."""
    away = _places(selection, [cause for cause in one if cause not in other])
    block = _left(information, away, _places(selection, other), selection.quadratic)
    return distances[away] @ block @ distances[away]


def visibility(information: np.ndarray, selection: Selection, causes: Sequence[Candidate],
               present: Sequence[Candidate], rules: Rules) -> dict[str, float]:
    """
    Return, per effect, how far from none it would be at its usual size, standard errors.

    Args: information (C, C); causes looked at; present: those that are known to be there.
    """
    size = np.diag(selection.quadratic.prior) ** -0.5 / rules.prior_width
    found: dict[str, float] = {}
    for cause in causes:
        places = _places(selection, [cause])
        known = _places(selection, [one for one in present if one.effect != cause.effect])
        for k in range(len(places)):
            others = np.concatenate([known, np.delete(places, k)])
            block = _left(information, places[k:k + 1], others, selection.quadratic)
            away = size[places[k]] * np.sqrt(max(block[0, 0], 0.0))
            found[cause.effect] = max(found.get(cause.effect, 0.0), float(away))
    return found


def hidden(selection: Selection, causes: Sequence[Candidate], present: Sequence[Candidate],
           rules: Rules) -> list[str]:
    """Return the names of effects that the flights would not show at their usual size."""
    seen = visibility(_of_record(selection), selection, causes, present, rules)
    return [name for name, away in seen.items() if away < rules.hidden]


def fly_next(selection: Selection, flights: Sequence[Flight], vehicle: Vehicle, z: np.ndarray,
             sure: Sequence[Candidate], doubts: dict, unseen: Sequence[str],
             rules: Rules) -> list[dict]:
    """
    Return what to fly next, as data: [{purpose, effects, the manoeuvre, now, after, manoeuvres}].

    First what separates the doubtful causes, then what shows the effects that were not seen; of
    each manoeuvre how far, in standard errors, now and after it. Args: z (Z,): what was found;
    sure: causes; doubts {cause: Fitted}, see doubts; unseen: names of effects.
    """
    if not doubts and not unseen:
        return []
    options = manoeuvres(selection, flights, vehicle, z)
    return (_to_separate(selection, options, vehicle, doubts, rules)
            + _to_show(selection, options, unseen, sure, rules))


def _to_separate(selection: Selection, options: list[Manoeuvre], vehicle: Vehicle, doubts: dict,
                 rules: Rules) -> list[dict]:
    """Return at most one proposal: the manoeuvre that separates doubtful causes best."""
    columns = _columns(selection)
    sets = {fit.causes: (fit.estimate.z - nominal(vehicle))[columns] for fit in doubts.values()}
    if len(sets) < 2 or not options:
        return []
    record = _of_record(selection)
    after = {option.trajectory: separation(record + option.information, selection, sets, rules)
             for option in options}
    return [_proposal('separate', [cause.effect for cause in doubts], options,
                      separation(record, selection, sets, rules), after)]


def _to_show(selection: Selection, options: list[Manoeuvre], names: Sequence[str],
             present: Sequence[Candidate], rules: Rules) -> list[dict]:
    """Return the proposals of a few manoeuvres that together show effects by name."""
    record, left = _of_record(selection), list(names)
    found: list[dict] = []
    causes = [cause for cause in _causes(selection) if cause.effect in left]
    now = visibility(record, selection, causes, present, rules)
    seen = {option.trajectory: visibility(record + option.information, selection, causes, present,
                                          rules)
            for option in options}
    while left and len(found) < MOST:
        shown = {name: [one for one in left if away[one] >= rules.shown]
                 for name, away in seen.items()}
        best = max(shown, default=None, key=lambda name: (len(shown[name]), sum(
            np.log(seen[name][one]) for one in shown[name])))
        if best is None or not shown[best]:
            break
        these = shown[best]
        found.append(_proposal('show', these, options, min(now[one] for one in these), {
            name: min(away[one] for one in these) for name, away in seen.items()}))
        left = [one for one in left if one not in these]
    return found


def _proposal(purpose: str, effects: Iterable[str], options: list[Manoeuvre], now: float,
              after: dict[str, float]) -> dict:
    """Return the manoeuvre that reaches most, and what each would, as data."""
    ranked = sorted(after, key=lambda name: -after[name])
    best = next(option for option in options if option.trajectory == ranked[0])
    return {'purpose': purpose, 'effects': sorted(set(effects)), **best.data(), 'now': now,
            'after': after[ranked[0]], 'manoeuvres': {name: after[name] for name in ranked}}


def _causes(selection: Selection) -> list[Candidate]:
    """Return the causes that are effects."""
    return [cause for cause in selection.rows if cause.nuisance is None]


def _columns(selection: Selection) -> list[int]:
    """Return the places in z that flights share."""
    return sorted({column for cause in _causes(selection) for column in cause.columns})


def _of_record(selection: Selection) -> np.ndarray:
    """Return the information (C, C) of the flights, with their nuisances free."""
    nuisances = _places(selection, [cause for cause in selection.best.chosen if cause.nuisance])
    return _left(selection.quadratic.information / selection.quadratic.scatter,
                 np.arange(len(_columns(selection))), nuisances, selection.quadratic)


def _places(selection: Selection, causes: Iterable[Candidate]) -> np.ndarray:
    return np.array([row for cause in causes for row in selection.rows[cause]], int)


def _left(information: np.ndarray, places: np.ndarray, free: np.ndarray, quadratic: Quadratic
          ) -> np.ndarray:
    """Return the information (K, K) on places that is left where others are free."""
    block = information[np.ix_(places, places)]
    if not len(free):
        return block
    ties = information[np.ix_(free, places)]
    others = np.ix_(free, free)
    return block - ties.T @ np.linalg.solve(information[others] + quadratic.prior[others], ties)
