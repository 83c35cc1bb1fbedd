# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The page of a diagnosis: the verdict first, then pictures and numbers."""

from pathlib import Path
import tempfile

from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose import where
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.report import gap_pictures
from quad_ident_ros.report.diagnosis import (
    band_of,
    caution_lines,
    NEXT,
    next_row,
    not_shown_line,
    own_lines,
    verdict_line,
)
from quad_ident_ros.report.html import figure, join, Markup, table, tag, write_page

WIDE = 1.96     # standard errors to the ends of a 95 % interval
SHOWN = 0.02    # probability from which on an effect has a row among the parameters
KINDS = {'none': 'yes', 'unknown': 'no', 'undetermined': 'part'}


def write(path, found):
    """
    Write the page of a diagnosis; raises InputError where the file cannot be written.

    Args: found: diagnose.diagnosis.Diagnosis.
    """
    data = found.data
    with tempfile.TemporaryDirectory() as folder:
        captions = save_pictures(found, Path(folder))
        pictures = {name: figure(Path(folder) / f'{name}.png', caption)
                    for name, caption in captions.items()}
        body = [*_verdict(data), *_where(data, pictures), *_which(data, pictures),
                *_far(data, pictures), *_open(data), *_provenance(data)]
    write_page(path, f'What {data["vehicle"]} lacks', join(body))


def save_pictures(found, folder):
    """
    Save the pictures of a diagnosis as NAME.png in a folder, a Path; return {name: caption}.

    Args: found as that of `write`.
    """
    training, held_out, z = found.training, found.held_out, found.z
    vehicle, z0 = training.vehicle, nominal(training.vehicle)
    gap, horizon = found.data['gap'], found.data['gap']['horizon']
    before, after = (gaps.ends(held_out, vehicle, each + found.held_out_own, horizon)
                     for each in (z0, z))
    lacks = [[where.lacking(track, vehicle, each + own, noise)
              for track, own in training.flights]
             for each, noise in ((z0, training.noise), (z, found.whole))]
    made = {}
    for name, draw, caption in (
            ('predictions',
             lambda path: gap_pictures.save_predictions(held_out, before, after, gap, path),
             f'Velocity (world) and rates (body) of {found.data["held_out"]}: open-loop '
             f'predictions from recorded states, each shown at its end, {horizon:g} s later. '
             'Predictions beyond the frame are cut off.'),
            ('horizons', lambda path: gap_pictures.save_horizons(gap, path),
             'Root mean square error of the predictions over the horizon, with 95 % intervals '
             '(bootstrap of blocks of time).'),
            ('map', lambda path: gap_pictures.save_map(*lacks, vehicle, path),
             'Force and moment that the model lacks, by channel and regime: each feature is cut '
             'into three thirds of the flight time. As the velocity that it makes in half a '
             'second, noise taken off; one scale for both.'),
            ('probabilities',
             lambda path: gap_pictures.save_probabilities(found.data['ranking'], path),
             'Probability of each effect of being present.')):
        draw(folder / f'{name}.png')
        made[name] = caption
    return made


def _verdict(data):
    words = join((tag('span', name, f'tag {KINDS.get(name, "part")}')
                  for name in data['verdict']), ' ')
    gap = data['gap']
    return [tag('p', join([tag('strong', 'Verdict: '), words], '')),
            tag('p', f'{_explained(data)}On {data["held_out"]}, which took no part, '
                     f'{100 * gap["closed"]:.0f} % of the velocity gap above the noise is closed '
                     f'({gap["horizon"]:g} s ahead: {gap["before"]["velocity"]:.3g} m/s before, '
                     f'{gap["after"]["velocity"]:.3g} after, {gap["noise"]["velocity"]:.3g} from '
                     'noise alone).')]


def _explained(data):
    """Return what the verdict means, where it is more than names, as a sentence."""
    _, colon, text = verdict_line(data).partition(': ')
    return f'{text[0].upper()}{text[1:]}. ' if colon else ''


def _far(data, pictures):
    gap = data['gap']
    rows = [[f'{name}, {unit}', *(f'{gap[stage][name]:.3g}{_between(gap, stage, name)}'
                                  for stage in ('before', 'after')), f'{gap["noise"][name]:.3g}']
            for name, unit in gap['units'].items()]
    rows += [[f'velocity, all but {name}', '', f'{values["velocity"]:.3g}', '']
             for name, values in gap['without'].items()]
    return [tag('h2', 'How far'), table(['', 'before', 'after', 'noise alone'], rows),
            pictures['horizons'], pictures['predictions']]


def _between(gap, stage, name):
    low, high = gap[f'{stage}_interval'][name]
    return f' ({low:.3g} to {high:.3g})'


def _where(data, pictures):
    rows = [[row['channel'], f'{100 * row["share"]:.0f} %', f'{row["rms"]:.3g} {row["unit"]}',
             f'{row["noise_rms"]:.3g}', row['regime'], band_of(row)] for row in data['where']]
    return [tag('h2', 'Where'), pictures['map'],
            table(['channel', 'share', 'rms', 'noise alone', 'where most of it is', 'Hz'], rows,
                  kinds=('text', '', '', '', 'text', ''))]


def _which(data, pictures):
    rows = []
    for row in data['ranking']:
        if row['probability'] < SHOWN:
            continue
        first = [row['effect'], f'{row["probability"]:.2f}']
        for name, one in row['parameters'].items():
            spread = WIDE * one['std']
            rows.append([*first, name, f'{one["value"]:.4g}', f'{one["value"] - spread:.4g} to '
                         f'{one["value"] + spread:.4g}', one['unit']])
            first = ['', '']
        if not row['parameters']:
            rows.append([*first, '', '', '', ''])
    estimates = ([table(['effect', 'probability', 'parameter', 'estimate', '95 % interval',
                         'unit'], rows, kinds=('text', '', 'text', '', '', 'text'))]
                 if rows else [tag('p', 'No effect is probable.')])
    return [tag('h2', 'Which'), pictures['probabilities'], *estimates]


def _open(data):
    """Return what the flights do not tell, and what would."""
    lines = [f'{row["channel"]} depends on {row["depends_on"]}: {100 * row["share"]:.0f} % of '
             'what is left there, and no known effect explains it.'
             for row in data['unknown'] or ()]
    if data['undetermined']:
        lines.append(f'The flights cannot tell between {", ".join(data["undetermined"])}.')
    said = [*own_lines(data), *([not_shown_line(data)] if data['not_shown'] else []),
            *caution_lines(data)]
    lines += [f'{line[0].upper()}{line[1:]}.' for line in said]
    parts = []
    if lines:
        items = join(tag('li', line) for line in lines)
        parts += [tag('h2', 'What cannot be told'), Markup(f'<ul>{items}</ul>')]
    if data['fly_next']:
        parts += [tag('h2', 'What to fly next'),
                  table(NEXT, [next_row(one) for one in data['fly_next']],
                        kinds=('text', 'text', '', '', '', '', ''))]
    return parts


def _provenance(data):
    return [tag('h2', 'From what'),
            tag('p', f'Fitted to {", ".join(map(str, data["flights"]))}; held out: '
                     f'{data["held_out"]}; quad_ident_ros {data["version"]}.')]
