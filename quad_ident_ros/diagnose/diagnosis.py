# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The diagnosis of flights: gap, where, which, how far, and what cannot be told."""

from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros import __version__
from quad_ident_ros.data.clocks import clocks_of, on_one_clock
from quad_ident_ros.data.record import refuse_twice, same_flight
from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose import where
from quad_ident_ros.diagnose.candidates import candidates
from quad_ident_ros.diagnose.doubts import doubts_of
from quad_ident_ros.diagnose.fly_next import fly_next, hidden
from quad_ident_ros.diagnose.leftover import beside_noise, leftovers, REMAINS, unstructured
from quad_ident_ros.diagnose.length import refuse_short
from quad_ident_ros.diagnose.named import believed, named_of, outstanding, Training, without
from quad_ident_ros.diagnose.own import as_data, late_controller, own_of
from quad_ident_ros.diagnose.select import select
from quad_ident_ros.effects.registry import EFFECTS, mapping
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.errors import UNITS
from quad_ident_ros.greybox.flights import highest_voltage, moved, track_of
from quad_ident_ros.greybox.kinematics import measurement_noise
from quad_ident_ros.greybox.near import near_flights
from quad_ident_ros.greybox.noise import near_noise, quick_noise, whole_noise
from quad_ident_ros.greybox.parameters import NAMES, nominal, SPLIT

SCHEMA = 'quad_ident/diagnosis/1'
# Times the noise's gap from which on what is left is unknown without structure, too. Commands that
# were lost and clocks that drift show in rates and attitude first.
BEYOND = {'velocity': 1.25, 'attitude': 1.5}
ASKS = (['none'], ['undetermined'])     # verdicts that ask for another flight


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """
    What was found, as data (`data`: the JSON of the project) and as objects to go on with.

    selection: of the effects; z (Z,): the vehicle with those named; training: the flights that
    were learnt from, with the nominal vehicle; held_out: the Track and held_out_own (Z,) what is
    its own, added to z; whole (12,): all that the best model leaves.
    """

    data: dict
    selection: object
    z: np.ndarray
    training: Training
    held_out: object
    held_out_own: np.ndarray
    whole: np.ndarray

    def effects(self):
        """Return {effect: {parameter: value}} of the effects named."""
        return mapping(self.z[SPLIT:])


def diagnose(records, vehicle, *, hold_out=None, effects=None, on_progress=lambda share: None):
    """
    Return the Diagnosis of flight records against a nominal vehicle.

    Args: hold_out: a record that takes no part in the fit or the choice, by default the last one
    (the second half of a single one); effects: names that may be found, by default all;
    on_progress is called with the share done.
    Raises InputError where the records cannot bear a verdict.
    """
    for name in effects or ():
        if name not in EFFECTS:
            raise InputError(f'{name!r} is not among the effects: {", ".join(EFFECTS)}')
    records = list(records)
    for record in records if hold_out is None else [*records, hold_out]:
        refuse_short(record)
    if hold_out is not None:    # among others it would take part in fit and choice
        records = [record for record in records if not same_flight(record, hold_out)]
    refuse_twice(records)
    training, test = split(records, hold_out)
    records, late, answers = zip(*on_one_clock([*training, test]), strict=True)
    *training, test = records
    voltage = highest_voltage(training)
    clocks = clocks_of(answers[:-1], answers[-1:])
    *tracks, held_out = (track_of(record, vehicle, voltage, clock)
                         for record, clock in zip(records, clocks, strict=True))
    flights = near_flights(tracks, vehicle, nominal(vehicle))
    causes = candidates(flights, vehicle, effects)
    selection = select(flights, vehicle, causes, lambda share: on_progress(0.8 * share))
    prompt = late_controller(selection, flights)
    if prompt:
        *tracks, held_out = (moved(track, prompt) for track in (*tracks, held_out))
        flights = near_flights(tracks, vehicle, nominal(vehicle))
        selection = select(flights, vehicle, causes, lambda share: on_progress(0.8 + 0.05 * share))
    z0, kinds = nominal(vehicle), selection.best.own
    noise = noise_of(selection, flights)
    learnt = Training(tuple(zip(tracks, selection.best.estimate.own.vectors(np.zeros(len(z0))),
                                strict=True)), vehicle, noise)
    whole = np.median([whole_noise(raw, 1.0 - 1.0 / raw.shape[1])
                       for raw in selection.best.estimate.left], axis=0)
    z, named, strength = named_of(selection.best, learnt)
    left = leftovers([where.lacking(one, vehicle, z + own, whole)
                      for one, own in learnt.flights])
    lacks = [where.lacking(one, vehicle, z0 + own, noise) for one, own in learnt.flights]
    on_progress(0.9)
    times = learnt.left_over(z)
    left = [one for one in left if one.remains(times) > REMAINS]
    unknown = bool(left) or any(times[name] > limit for name, limit in BEYOND.items())
    probability = believed(selection.probability, strength,
                           beside_noise(max(times.values())) if unknown else 0.0)
    if unknown:
        z, named = outstanding(z, named, strength, learnt)
        left = left or [unstructured([where.lacking(one, vehicle, z + own, noise)
                                      for one, own in learnt.flights], vehicle)]
    test_own = own_of(held_out, vehicle, z, kinds, noise, flights[0].segment)
    far = _how_far(held_out, test_own, vehicle, z0, z, named, noise)
    doubts = doubts_of(selection, named)
    sure = [cause for cause in named if cause not in doubts]
    known = list(dict.fromkeys(cause.effect for cause in sure))
    verdict = ([*known, 'unknown'] if unknown else ['undetermined'] if doubts else
               known or ['none'])
    open_ones = sorted({cause.effect for cause in doubts})
    unseen = hidden(selection, [cause for cause in causes
                                if cause.effect not in (*open_ones, *known)], sure)
    proposals = None
    if verdict in ASKS:
        proposals = fly_next(selection, flights, vehicle, z, sure, doubts, unseen) or None
    on_progress(1.0)
    data = {
        'schema': SCHEMA, 'version': __version__, 'vehicle': vehicle.name, 'verdict': verdict,
        'ranking': _ranking(selection, causes, z, held_out, test_own, vehicle, probability),
        'where': _where(lacks, vehicle), 'gap': far,
        'unknown': [{'channel': one.channel, 'depends_on': one.depends_on,
                     'share': one.share} for one in left] if unknown else None,
        'undetermined': open_ones or None, 'sure': known if doubts else None,
        'not_shown': unseen, 'fly_next': proposals,
        'nuisances': as_data(kinds, [own for _, own in learnt.flights], test_own,
                             late, clocks, prompt),
        'flights': [record.info.get('name') for record in training],
        'held_out': test.info.get('name')}
    return Diagnosis(data, selection, z, learnt, held_out, test_own, whole)


def split(records, hold_out):
    """Return the records to learn from and the one held out; InputError without a record."""
    if not records:
        raise InputError('no flight to learn from: name at least one flight record beside the one '
                         'that is held out')
    if hold_out is not None:
        return records, hold_out
    if len(records) > 1:
        return records[:-1], records[-1]
    record = records[0]
    half = len(record) // 2
    later = record.slice(half, len(record))
    # The battery goes on emptying from the start of the flight.
    return [record.slice(0, half)], replace(later, info={**later.info, 'began': record.t[0]})


def noise_of(selection, flights):
    """Return the standard deviation of the measurement noise of flights, (12,)."""
    best = selection.best.estimate
    near, white = (np.median([kind(raw) for raw in best.left], axis=0)
                   for kind in (near_noise, quick_noise))
    return measurement_noise(flights, best.vectors, near, white)


def _how_far(test, own, vehicle, z0, z, named, noise):
    """Return the gap on the held-out flight: before, after, noise, intervals, by horizon."""
    out = {}
    for horizon in gaps.HORIZONS:
        before = gaps.ends(test, vehicle, z0 + own, horizon)
        after = gaps.ends(test, vehicle, z + own, horizon)
        out[horizon] = {'before': gaps.gap([before]), 'after': gaps.gap([after]),
                        'noise': gaps.noise_gap(test, vehicle, z, noise, horizon),
                        'before_interval': gaps.interval([before]),
                        'after_interval': gaps.interval([after])}
    head = out[gaps.HEADLINE]
    contributions = {}
    for cause in named:
        contributions[cause.effect] = gaps.gap([gaps.ends(
            test, vehicle, without(z, cause, vehicle) + own, gaps.HEADLINE)])
    return {'horizon': gaps.HEADLINE, 'units': UNITS, **head,
            'closed': gaps.closed(head['before']['velocity'], head['after']['velocity'],
                                  head['noise']['velocity']),
            'without': contributions,
            'horizons': {str(horizon): values for horizon, values in out.items()}}


def _ranking(selection, causes, z, test, own, vehicle, probabilities):
    """Return every effect, the most probable first, with its parameters."""
    z0 = nominal(vehicle)
    errors = dict(zip(selection.best.estimate.columns, selection.errors, strict=True))
    before = gaps.gap([gaps.ends(test, vehicle, z0 + own, gaps.HEADLINE)])
    rows = {}
    for cause in causes:
        row = rows.setdefault(cause.effect, {'effect': cause.effect, 'probability': 0.0,
                                             'parameters': {}, 'gap_after': before})
        row['probability'] = min(1.0, row['probability'] + probabilities[cause])
        if cause in selection.best.causes:
            parameters = EFFECTS[cause.effect].parameters
            units = {parameter.name: parameter.unit for parameter in parameters}
            for column in cause.columns:
                name = NAMES[column].split('.')[1]
                row['parameters'][name] = {'value': float(z[column]) if z[column] != z0[column]
                                           else float(selection.best.estimate.z[column]),
                                           'std': float(errors[column]), 'unit': units[name]}
            alone = z0.copy()
            alone[list(cause.columns)] = selection.best.estimate.z[list(cause.columns)]
            row['gap_after'] = gaps.gap([gaps.ends(test, vehicle, alone + own, gaps.HEADLINE)])
    return sorted(rows.values(), key=lambda row: -row['probability'])


def _where(lacks, vehicle):
    found = []
    for channel, share in where.shares(lacks, vehicle).items():
        text, inside = where.regime(lacks, channel)
        low, high = where.band(lacks, channel)
        values = np.concatenate([one.values for one in lacks])[:, where.CHANNELS.index(channel)]
        errors = np.concatenate([one.errors for one in lacks])[:, where.CHANNELS.index(channel)]
        found.append({'channel': channel, 'share': float(share), 'regime': text,
                      'share_in_regime': inside, 'band': [low, high],
                      'rms': float(np.sqrt(np.mean(values ** 2))),
                      'noise_rms': float(np.sqrt(np.mean(errors ** 2))),
                      'unit': 'N' if channel[0] == 'F' else 'N m'})
    return sorted(found, key=lambda row: -row['share'])
