# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The verdict of a diagnosis in sentences: what causes the gap, how large it is, what to do."""

from collections.abc import Sequence

import numpy as np

from quad_ident_ros.diagnose.result import (
    BLOCKS,
    Diagnosis,
    Gap,
    GapGivenAttitude,
    GapInSimulator,
    Ranked,
    Value,
)
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.effects.registry import GUSTS, titled
from quad_ident_ros.greybox.nuisances import CLOCK

NOTHING_TO_CLOSE = 'the velocity gap is not above the noise, so there is nothing to close'


def verdict_line(found: Diagnosis) -> str:
    """Return the verdict as a sentence without its full stop."""
    if found.verdict == ('none',):
        names = ', '.join(_needed(found))
        beside = f', with {names} estimated for each flight,' if names else ''
        return (f'none: the nominal vehicle{beside} explains the flights to within noise and '
                'tolerance, so no effect is named')
    doubts = (f'the flights cannot distinguish between {_listed(found.undetermined)}'
              if found.undetermined else '')
    if 'undetermined' in found.verdict:
        return f'undetermined: {doubts}{_others(found)}'
    named = _named(found)
    if not named:
        return f'unknown: no known effect explains the gap{_gusts_of(found)}'
    unknown = 'unknown' in found.verdict
    share = (f'{100 * max(found.gap.closed, 0.0):.0f} % of the velocity gap above the noise'
             if above_noise(found.gap) else 'part of the gap' if unknown else 'the gap')
    contradiction = ''
    if held_out_contradicts(found):
        share = f'{"part of the gap" if unknown else "the gap"} of the flights that were fitted'
        contradiction = (f'; the velocity of {found.held_out}, which was not used for fitting, is '
                         f'predicted better without {"it" if len(named) == 1 else "them"}')
    if unknown:
        share += (', and the rest is unknown: another cause, or '
                  f'{"this effect" if len(named) == 1 else "one of these effects"} by a law that '
                  'is none of its forms')
    beside = doubts and f'; beside {"it" if len(named) == 1 else "them"}, {doubts}'
    gusts = _gusts_of(found) if unknown else ''
    if is_uncertain(found):
        best = '; '.join(f'{titled(row.effect)}{_law_of(found, row)}, {values_of(row)}, '
                         f'probability {row.probability:.2g}' for row in named)
        return (f'uncertain: the best known explanation of {share} is less likely than '
                f'something else that acts alike: {best}{contradiction}{gusts}')
    if len(named) == 1:
        row, = named
        return (f'{titled(row.effect)}{_law_of(found, row)}, {values_of(row)}, explains {share}'
                f'{beside}{contradiction}{gusts}')
    return f'{len(named)} effects explain {share}: ' + '; '.join(
        f'{titled(row.effect)}{_law_of(found, row)}, {values_of(row)}, contribution '
        f'{contribution_of(row)}' for row in named) + beside + contradiction + gusts


def _gusts_of(found: Diagnosis) -> str:
    """Return in words that a force that is unknown may be gusts, where flights have some."""
    one = (found.nuisances or {}).get(GUSTS.name)
    if one is None or not any(row.channel[0] == 'F' for row in found.unknown):
        return ''
    values = np.array([*one['values'], one['held_out']])
    return (f'; a wind that changes by {np.sqrt(np.mean(values ** 2)):.2g} m/s along each flight '
            'would fit what is unknown, but no simulation predicts it')


def _others(found: Diagnosis) -> str:
    """Return what a verdict names beside effects that cannot be told apart, in words."""
    rows = [row for row in found.ranking if row.effect in found.sure]
    likely = [row.effect for row in rows if row.probability >= RULES.present]
    certain = f'; certain: {_listed(likely)}' if likely else ''
    return certain + ''.join(
        f'; {titled(row.effect)}, uncertain (probability {row.probability:.2g})'
        for row in rows if row.effect not in likely)


def size_line(found: Diagnosis) -> str:
    """Return the velocity gap before and after, on the flight held out, as sentences."""
    gap = found.gap
    before, after, noise = (stage['velocity'] for stage in (gap.before, gap.after, gap.noise))
    where = f'on {found.held_out}, which was not used for fitting'
    if not gap.without:
        return (f'The velocity error of the nominal vehicle after {gap.horizon:g} s is '
                f'{before:.3g} m/s {where}; noise alone gives {noise:.3g} m/s.')
    said = (f'With {_them(found)}, the velocity error after {gap.horizon:g} s '
            f'{"falls" if after <= before else "rises"} from {before:.3g} m/s to {after:.3g} m/s '
            f'{where}; noise alone gives {noise:.3g} m/s.')
    return said if above_noise(gap) else f'{said} {sentence(NOTHING_TO_CLOSE)}'


def next_step(found: Diagnosis, written: str | None = None) -> str:
    """Return what to do with the verdict, as a sentence; written: the file of --out-vehicle."""
    if any(one['code'] == 'other_vehicle' for one in found.findings):
        return ('Next: check the vehicle file, which seems to be that of another vehicle, as the '
                'warning "vehicle file" says, and diagnose again.')
    if held_out_contradicts(found):
        return (f'Next: see whether {found.held_out} was flown with the same payload and '
                'propellers as the flights that were fitted. If so, hold out another one '
                '(--hold-out FLIGHT); if not, diagnose them apart.')
    if 'unknown' in found.verdict:
        rest = ('Next: the lines "unexplained" and "differs" say in which channel, regime and '
                'flight the rest occurs.')
        # What calm flights hardly show, a brisk one that is predicted needs.
        alone = [one.flight for one in found.flight_checks if one.differs] == [found.held_out]
        return (f'{rest} Only {found.held_out} differs, which was not used for fitting: if it '
                'moves more than the others, hold out one of them instead (--hold-out FLIGHT); if '
                'its payload or propellers differ, diagnose it alone.'
                if alone and len(found.flight_checks) > 2 else rest)
    if found.form_unknown:
        where = 'Next: the lines "unexplained" say where its law differs from the nearest one'
        # Without a function that is shown to help, nothing would be added.
        return (f'{where}; "--out-vehicle FILE --residual" adds to the vehicle what the flights '
                'show of it.' if found.ceiling.shown else f'{where}.')
    if found.fly_next:
        return ('Next: fly what the table "what to fly next" proposes, and diagnose again with '
                'the new flights.')
    if is_uncertain(found):
        return ('Next: fly again, longer and with more motion, and diagnose all flights: these '
                'do not show what it is, which may be nothing that has a name here.')
    if _named(found) and written:
        return (f'Next: "quad_ident export {written} --to SIMULATOR -o FILE" puts these effects '
                'into your simulator.')
    if _named(found):
        return ('Next: "--out-vehicle FILE" writes the vehicle with these effects, and '
                '"quad_ident export FILE" puts them into your simulator.')
    if _needed(found):
        return _mend_flights(found)
    if any((one['code'], one['where']) == ('input_errors', 'commands') for one in found.findings):
        return ('Next: log the commands at the rate of the controller, and the gyro unfiltered. '
                'What this log lacks of them counts as noise here, so that smaller effects may be '
                'present.')
    if found.not_shown:
        return ('Next: nothing; the simulation matches these flights, but the effects in the line '
                '"would not show" may be present.')
    return 'Next: nothing; the simulation matches these flights.'


def is_uncertain(found: Diagnosis) -> bool:
    """Whether each effect that a verdict names is less likely present than not."""
    named = _named(found)
    return bool(named) and all(row.probability < RULES.present for row in named)


def held_out_contradicts(found: Diagnosis) -> bool:
    """
    Whether the velocity of the held-out flight is clearly predicted better without what is named.

    Beyond chance and tolerance, and where nothing else is predicted better with it. The held-out
    half of a single flight is of the same vehicle.
    """
    gap, single = found.gap, any(one['code'] == BLOCKS for one in found.findings)
    low, _ = gap.after_interval['velocity']
    if single or not _named(found) or low <= gap.before_own['velocity']:
        return False

    def differ(name: str, less: dict, more: dict) -> bool:
        return more[name] ** 2 - less[name] ** 2 > found.tolerance[name] ** 2

    return differ('velocity', gap.before_own, gap.after) and not any(
        differ(name, gap.after, gap.before_own) for name in found.tolerance)


def above_noise(gap: Gap | GapGivenAttitude | GapInSimulator) -> bool:
    """Whether the nominal vehicle, nuisances taken out, is farther off than the noise is."""
    return gap.before_own['velocity'] > gap.noise['velocity']


def closed_of(gap: Gap | GapGivenAttitude | GapInSimulator) -> str:
    """Return how much of a velocity gap is closed, in words."""
    return (f'{100 * gap.closed:.0f} % of the velocity gap above the noise is closed'
            if above_noise(gap) else NOTHING_TO_CLOSE)


def values_of(row: Ranked) -> str:
    """Return the parameters of an effect with their standard errors, in words."""
    return ', '.join(
        f'{name} {one.value:.4g} ± {one.std:.2g} {one.unit}'.removesuffix(' 1')
        + change_of(one)
        for name, one in row.parameters.items())


def change_of(parameter: Value) -> str:
    """Return by how much a parameter exceeds its value in the vehicle file, where it has one."""
    return '' if parameter.change is None else f' ({parameter.change:+.3g} against the file)'


def contribution_of(row: Ranked) -> str:
    """Return in words the share of the closable gap that is lost without an effect."""
    return '' if row.contribution is None else f'{100 * row.contribution:.0f} %'


def sentence(text: str) -> str:
    """Return a text with a full stop, and a capital letter unless it begins with a name."""
    is_word = text.split(maxsplit=1)[0].rstrip(',:;').isalpha()
    return f'{text[0].upper() if is_word else text[0]}{text[1:]}.'


def _named(found: Diagnosis) -> list[Ranked]:
    rows = {row.effect: row for row in found.ranking}
    return [rows[name] for name in found.verdict if name in rows]


def _needed(found: Diagnosis) -> tuple[str, ...]:
    """Return the nuisances without which the nominal vehicle is off by more than the tolerance."""
    gap = found.gap
    off = any(gap.before[name] ** 2 - gap.before_own[name] ** 2 > tolerance ** 2
              for name, tolerance in found.tolerance.items())
    # Gusts are in neither gap: nothing is nearer by them.
    return tuple(name for name in found.nuisances or () if name != GUSTS.name) if off else ()


def _mend_flights(found: Diagnosis) -> str:
    """Return what to do where the nominal vehicle needs nuisances to explain the flights."""
    hidden = (found.nuisances or {}).get(CLOCK, {}).get('hidden_delay')
    delay = (f'; a delay of the commands of up to {1e3 * hidden:.0f} ms may be among them'
             if hidden else '')
    return (f'Next: mend {", ".join(_needed(found))} of the flights: without the estimates, which '
            f'"--verbose" shows, the simulation does not match them{delay}.')


def _them(found: Diagnosis) -> str:
    if 'undetermined' in found.verdict:
        return 'the most probable choice'
    words = {0: 'the effects of the model', 1: 'this effect'}
    return words.get(len(_named(found)), 'these effects')


def form_of(found: Diagnosis, row: Ranked) -> str:
    """Return the form of an effect and how much of the effect it explains, in words."""
    if row.form is None:
        return ''
    explained = '' if row.explained is None else f', {100 * row.explained:.0f} %'
    unknown = 'unknown; nearest: ' if row.effect in found.form_unknown else ''
    return f'{unknown}{row.form}{explained}'


def _law_of(found: Diagnosis, row: Ranked) -> str:
    """Return what to say of the form of an effect after its name where no form fits."""
    if row.effect not in found.form_unknown:
        return ''
    return f', form unknown: {100 * (row.explained or 0.0):.0f} % of it explained by {row.form}'


def _listed(names: Sequence[str]) -> str:
    *most, last = map(titled, names)
    return f'{", ".join(most)} and {last}' if most else last
