# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The regression gives the weights that its rows were drawn with, whatever the features."""

import json

import numpy as np
import pytest

from withheld import calibrate
from withheld.__main__ import main


def constant_of(weights):
    """Return the constant with which two standard errors of all that there is are even odds."""
    return -(weights.get('explained', 0.0) + weights.get('distance', 0.0) * np.log(3.0))


def drawn(weights, count=20000, seed=1):
    """Return Rows whose effects are present as often as the weights say."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(count, len(weights)))
    z = constant_of(weights) + x @ np.array(list(weights.values()))
    present = (rng.random(count) < 1.0 / (1.0 + np.exp(-z))).astype(float)
    groups = tuple(np.where(rng.random(count) < 0.5, 'ours', 'faulty').tolist())
    return calibrate.Rows(tuple(weights), x, present, groups)


@pytest.mark.parametrize('weights', [
    {'explained': 2.0, 'distance': 0.3},
    {'explained': 1.7, 'distance': -0.8, 'lesser': 0.1}])
def test_known_weights_come_out(weights):
    made = calibrate.fit(drawn(weights))
    for (value, error), true in zip([made.constant, *made.weights.values()],
                                    [constant_of(weights), *weights.values()], strict=True):
        assert value == pytest.approx(true, abs=4.0 * error) and 0.01 < error < 0.1
    assert list(made.weights) == list(weights)
    assert made.loss < made.loss_of_base_rate


def test_probabilities_are_frequencies_in_every_group():
    made = calibrate.fit(drawn({'distance': 0.5, 'explained': 1.0}))
    assert set(made.tables) == {'all', 'ours', 'faulty'}
    for table in made.tables.values():
        for row in table:
            spread = np.sqrt(row['given'] * (1.0 - row['given']) / row['count'])
            assert row['present'] == pytest.approx(row['given'], abs=4.0 * spread)
    assert sum(row['count'] for row in made.tables['all']) == 20000


def test_effects_that_tell_themselves_apart_have_finite_weights():
    rows = calibrate.Rows(('distance',), np.array([[-2.0], [-1.0], [1.0], [2.0]]),
                          np.array([0.0, 0.0, 1.0, 1.0]), ('ours',) * 4)
    (value, _), = calibrate.fit(rows).weights.values()
    assert 1.0 < value < 20.0


def test_nothing_can_be_fitted_where_all_is_there():
    with pytest.raises(ValueError, match='nothing to fit'):
        calibrate.fit(calibrate.Rows(('distance',), np.ones((3, 1)), np.ones(3), ('ours',) * 3))


def label(*effects, **options):
    return {'kind': 'single', 'faulty': False, 'effects': dict.fromkeys(effects, {})} | options


def ranked(*effects, contribution=0.5):
    return {'ranking': [{'effect': name, 'contribution': contribution,
                         'distance': 9.0, 'explained': 0.7, 'companions': 2}
                        for name in effects]}


def test_rows_are_those_of_the_best_set_with_the_librarys_limits():
    found = ranked('wind', 'inflow')
    found['ranking'].append({'effect': 'body_drag', 'contribution': None})
    rows = calibrate.rows_of([(label('wind'), found)])
    assert rows.names == ('explained', 'distance', 'lesser', 'companions')
    assert rows.x == pytest.approx(np.array([[0.7, np.log(10.0), 0.0, 2.0]] * 2))
    assert rows.present.tolist() == [1.0, 0.0] and rows.groups == ('ours', 'ours')


def test_an_effect_counts_by_its_size_beside_the_greatest():
    found = {'ranking': ranked('wind')['ranking'] + ranked('inflow', contribution=0.18)['ranking']}
    rows = calibrate.rows_of([(label('wind'), found)])
    assert rows.x[:, 2] == pytest.approx([0.0, 0.4 * np.log(10.0)])


@pytest.mark.parametrize(('truth', 'named'), [
    (label('wind', beside=['inflow']), 'inflow'), (label('mass_offset'), 'thrust_scale'),
    (label('wind', instead=['inflow']), 'inflow')])
def test_what_is_neither_there_nor_not_is_left_out(truth, named):
    assert not len(calibrate.rows_of([(truth, ranked(named))]).present)


def test_another_feature_is_another_line():
    features = {'contribution': lambda row: row['contribution'],
                'distance': lambda row: row['distance'] ** 2}
    rows = calibrate.rows_of([(label('wind'), ranked('wind'))], features)
    assert rows.names == ('contribution', 'distance')
    assert rows.x[0] == pytest.approx([0.5, 81.0])


def kept(folder, name, rows, part='development'):
    (folder / 'found').mkdir(parents=True)
    labels = {}
    for k, (there, distance, contribution) in enumerate(rows):
        labels[f'{name}{k}'] = label('wind' if there else 'inflow')
        found = {'ranking': [{'effect': 'wind', 'contribution': contribution,
                              'distance': distance}]}
        (folder / 'found' / f'{name}{k}.json').write_text(json.dumps(found))
    (folder / 'labels.json').write_text(json.dumps({'set': part, 'labels': labels}))


def test_the_command_reads_kept_runs_and_prints_the_weights(tmp_path, capsys):
    rng = np.random.default_rng(4)
    logs = np.abs(rng.normal(2.0, 2.0, 200))
    kept(tmp_path / 'a', 'a', [(bool(x + rng.normal() > 2.0), float(np.expm1(x)), 0.3)
                               for x in logs])
    assert main(['calibrate', str(tmp_path / 'a')]) == 0
    said = capsys.readouterr().out
    assert 'calibration = (' in said and 'forms as ours:' in said and '200 effects' in said


def test_the_command_takes_no_run_of_the_evaluation(tmp_path, capsys):
    kept(tmp_path / 'a', 'a', [(True, 1.0, 0.5)], part='evaluation')
    for arguments in (['calibrate', str(tmp_path / 'a')], ['calibrate', '--set', 'evaluation']):
        with pytest.raises(SystemExit):
            main(arguments)
        assert 'evaluation' in capsys.readouterr().err
