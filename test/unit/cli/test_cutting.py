# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Advice to leave samples out names the options that do it, and these do it."""

from pathlib import Path
import re

from flightmaker import changed, flight, VEHICLE
import numpy as np
import pytest

import quad_ident_ros
from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import read_csv, write_csv
from quad_ident_ros.data.cutting import keeping, options, without
from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.selection import selected, Selection
from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.signals import _check_size, _even_grid
from quad_ident_ros.model.dynamics import states_of

PACKAGE = Path(quad_ident_ros.__file__).parent
WHOLE = flight(seconds=20.0)
EARLY = WHOLE.t < 2.5
MIDDLE = (WHOLE.t > 9.0) & (WHOLE.t < 10.5)
CMD = ('cmd1', 'cmd2', 'cmd3', 'cmd4')


def selection_in(text):
    """Return the Selection whose options a message names."""
    found = dict(re.findall(r'--(from|to) (-?[0-9.]*[0-9])', text))
    assert found, text
    return Selection(begin=float(found['from']) if 'from' in found else None,
                     end=float(found['to']) if 'to' in found else None)


def with_values(where, value, *names):
    return changed(WHOLE, **{name: np.where(where, value, WHOLE.columns[name])
                             for name in names})


def stuck():
    """Return the flight with an attitude that stands still for a while."""
    k = np.where(MIDDLE, np.argmax(MIDDLE), np.arange(len(WHOLE)))
    return changed(WHOLE, **{name: WHOLE.columns[name][k] for name in ('qw', 'qx', 'qy', 'qz')})


FAULTS = {
    'quaternion_zero': with_values(EARLY, 0.0, 'qw', 'qx', 'qy', 'qz'),
    'impossible': with_values(MIDDLE, 1e12, 'vx'),
    'saturation': with_values(MIDDLE, 1700.0, *CMD),
    'thrust': with_values(EARLY, 110.0, *CMD),
    'stale': stuck(),
    'stale_marked': changed(WHOLE, stale=1.0 * MIDDLE),
}


@pytest.mark.slow
@pytest.mark.parametrize('code', FAULTS)
def test_what_a_finding_says_to_type_removes_it(code):
    [finding] = [one for one in findings(FAULTS[code], VEHICLE) if one.code == code]
    assert 'leave them out: --' in finding.remedy
    [kept] = selected('f', [FAULTS[code]], selection_in(finding.remedy))
    assert len(kept) > 0.4 * len(WHOLE)
    assert code not in {one.code for one in findings(kept, VEHICLE)}


def test_the_longest_stretch_is_kept():
    t = np.arange(20.0)
    assert keeping(t, (t != 5.0) & (t != 14.0)) == '--from 6 --to 13'
    assert keeping(t, t < 12.0) == '--to 11' and keeping(t, t > 3.0) == '--from 4'
    assert keeping(t, t < 3.0) == '' and keeping(t, t < 0.0) == ''
    assert options(t + 0.0004, 3, 5) == '--from 3.001 --to 5'   # never a sample beyond
    assert without(t, t < 3.0, 'one', 'two', 'three') == (
        'leave them out: --from 3, one, two, or three')
    assert without(t, t > -1.0, 'one', 'two') == 'one, or two'
    assert without(t, t > -1.0, 'one') == 'one'


def test_a_time_since_1970_is_written_out():
    t = 1.7e9 + np.arange(0.0, 10.0, 0.125)
    assert keeping(t, t > t[8]) == '--from 1700000001.125'


def test_errors_name_the_options_too():
    with pytest.raises(InputError) as caught:
        states_of(FAULTS['quaternion_zero'])
    [kept] = selected('f', [FAULTS['quaternion_zero']], selection_in(str(caught.value)))
    assert np.isfinite(states_of(kept)).all()
    with pytest.raises(InputError) as caught:
        FAULTS['quaternion_zero'].euler()
    assert selection_in(str(caught.value)) == Selection(begin=2.5)
    inputs = np.where(WHOLE.t[:, None] > 15.0, 1e200, 1.0) * np.ones((1, 4))
    with pytest.raises(InputError) as caught:
        _check_size(WHOLE.t, inputs, inputs)
    assert selection_in(str(caught.value)) == Selection(end=15.0)
    keep = (WHOLE.t < 8.0) | (WHOLE.t > 11.0)
    with pytest.raises(InputError, match=r'--to 7\.99, or before it, --from 11\.01'):
        _even_grid(WHOLE.t[keep], np.zeros((keep.sum(), 4)), np.zeros((keep.sum(), 4)))


@pytest.mark.slow
def test_the_command_line_does_what_a_finding_says(tmp_path, capsys):
    write_csv(tmp_path / 'f.csv', FAULTS['impossible'])
    assert main(['info', str(tmp_path / 'f.csv')]) == 3
    said = re.search(r'leave them out: (--[^,]*),', capsys.readouterr().out)[1]
    assert main(['info', str(tmp_path / 'f.csv'), *said.split()]) == 0
    assert main(['convert', str(tmp_path / 'f.csv'), str(tmp_path / 'g.csv'), *said.split()]) == 0
    assert np.abs(read_csv(tmp_path / 'g.csv').columns['vx']).max() < 10.0


@pytest.mark.slow
def test_no_message_says_to_cut_samples_without_the_options():
    """They all come from `without`, which names them."""
    advice = re.compile(r"'[^']*\b(cut|leave|remove) (out )?(the|these|those) samples[^']*'")
    for path in sorted(PACKAGE.rglob('*.py')):
        assert not advice.search(path.read_text()), path
