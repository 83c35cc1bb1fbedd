# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What holds of the repository as a whole: style, shipped files, documents."""

import hashlib
from pathlib import Path
import re
import subprocess
import sys

import pytest
import yaml

from quad_ident_ros import resources
from quad_ident_ros.cli.main import parser
from quad_ident_ros.experiment import load_experiment
from quad_ident_ros.model.vehicle import load_vehicle

ROOT = Path(__file__).resolve().parents[2]


def test_style():
    done = subprocess.run([sys.executable, '-m', 'ruff', 'check', str(ROOT)],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize('path', [*ROOT.glob('*.md'), *ROOT.glob('*.rst'),
                                  *ROOT.glob('docs/**/*.md')], ids=lambda path: path.name)
def test_no_page_has_what_a_merge_left_in_it(path):
    assert not re.search(r'^(<{7}|>{7}) ', path.read_text(encoding='utf-8'), re.MULTILINE)


PARTS = ('benchmarks', 'docs', 'launch', 'quad_ident_ros', 'scripts', 'soak', 'test', 'withheld')


@pytest.mark.parametrize('path', [ROOT / 'setup.py', *sorted(
    path for part in PARTS for path in (ROOT / part).rglob('*')
    if path.suffix == '.py' or part == 'scripts')], ids=lambda path: path.name)
def test_every_source_file_names_its_licence(path):
    lines = path.read_text(encoding='utf-8').splitlines()
    assert lines[lines[0].startswith('#!'):][:2] == [
        '# Copyright 2026 quad_ident_ros contributors', '# SPDX-License-Identifier: Apache-2.0']


@pytest.mark.parametrize('name', resources.names('experiments'))
def test_shipped_experiments_load_under_their_own_name(name):
    experiment = load_experiment(name)
    assert experiment.name == name
    for run in experiment.runs:
        assert len(experiment.input_signals(run)) == len(experiment.sample_times(run))


def test_the_parameters_file_has_parameters_of_the_nodes_only():
    pytest.importorskip('rclpy', reason='there is no ROS 2 here')
    from quad_ident_ros.nodes import diagnoser, identifier, recorder, simulator
    data = yaml.safe_load((ROOT / 'config' / 'parameters.yaml').read_text(encoding='utf-8'))
    for node, module in (('simulator', simulator), ('recorder', recorder),
                         ('identifier', identifier), ('diagnoser', diagnoser)):
        known = {spec.name: spec for spec in module.SPECS}
        for name, value in _flat(data[f'/**/{node}']['ros__parameters']):
            assert value == known[name].default
            known[name].check(value)


def _flat(mapping, prefix=''):
    for key, value in mapping.items():
        if isinstance(value, dict):
            yield from _flat(value, f'{prefix}{key}.')
        else:
            yield prefix + key, value


@pytest.mark.parametrize('name', ['requirements.txt', 'benchmarks/requirements.txt',
                                  'withheld/requirements.txt', '.ci/requirements-ament.txt',
                                  '.ci/requirements-browser.txt',
                                  '.ci/requirements-colcon.txt',
                                  '.ci/requirements-simulators.txt',
                                  '.ci/requirements-site.txt'])
def test_what_is_installed_is_pinned_with_checksums_and_from_no_named_host(name):
    text = re.sub('#.*', '', (ROOT / name).read_text(encoding='utf-8'))
    entries = text.replace('\\\n', ' ').split('\n')
    entries = [entry.split('--hash=') for entry in entries if entry.strip()]
    assert len(entries) > (2 if 'browser' in name else 10)
    for pin, *checksums in entries:
        assert re.fullmatch(r'[a-z0-9-]+==[0-9.]+( ; [a-z_]+ [=!<>]+ .*)? +', pin), pin
        assert checksums and all(re.fullmatch(r'sha256:[0-9a-f]{64} *', one) for one in checksums)
    # pip takes no checksums with packages that have none.
    assert {pin.split('==')[0] for pin, *_ in entries} >= ({'numpy', 'ros-jazzy-rclpy'} if name
                                                           == 'requirements.txt' else set())


def test_what_is_carried_along_is_what_the_document_says():
    text = (ROOT / 'docs' / 'dependencies.md').read_text(encoding='utf-8')
    said = dict(re.findall(r'^\| `(\S+)` \|.*\| `([0-9a-f]{64})` \|$', text, flags=re.MULTILINE))
    carried = (ROOT / 'quad_ident_ros' / 'report' / 'web').glob('uPlot*')
    assert said == {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in carried}


def test_the_readme_calls_commands_that_exist():
    text = (ROOT / 'README.md').read_text(encoding='utf-8')
    calls = re.findall(r'^    \./run (\S+)(.*?)(?:  #.*)?$', text, flags=re.MULTILINE)
    assert {name for name, _ in calls} >= {'demo', 'test', 'diagnose', 'simulate', 'identify'}
    for name, rest in calls:
        if name != 'test':
            parser([name])[0].parse_args([name, *rest.split()])


DOCUMENTS = [ROOT / 'README.md', ROOT / 'CONTRIBUTING.md', *sorted((ROOT / 'docs').rglob('*.md'))]


@pytest.mark.parametrize('document', DOCUMENTS, ids=lambda path: path.name)
def test_links_in_documents_lead_somewhere(document):
    """To files that exist, and to headings in them."""
    for target, _, heading in re.findall(r'\]\(([^)#\s]*)(#([^)\s]+))?\)', _text(document)):
        if not target.startswith('http'):
            path = document.parent / target if target else document
            assert path.exists(), target
            assert not heading or heading in _anchors(path), f'{target}#{heading}'


def _text(document):
    return re.sub(r'^```.*?^```', '', document.read_text(encoding='utf-8'), flags=re.M | re.S)


def _anchors(document):
    """Return the names by which a browser finds the headings of a page."""
    headings = re.findall(r'^#+ (.*)$', _text(document), re.M)
    return {re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-') for heading in headings}


def test_the_readme_leads_to_every_page_and_is_read_in_minutes():
    text = (ROOT / 'README.md').read_text(encoding='utf-8')
    pages = [path.name for path in (ROOT / 'docs').glob('*.md')]
    assert [name for name in pages if f'docs/{name}' not in text] == []
    assert text.count('\n') < 200


@pytest.mark.slow
def test_the_python_of_the_readme_runs_and_names_the_effect(capsys):
    [block] = re.findall(r'^```python\n(.*?)^```', (ROOT / 'README.md').read_text('utf-8'),
                         re.M | re.S)
    exec(block, {})
    assert capsys.readouterr().out.startswith('drag of the rotors (rotor_drag), coefficient 0.')


def test_the_vehicle_file_of_the_readme_is_one(tmp_path):
    [block] = re.findall(r'^```yaml\n(.*?)^```', (ROOT / 'README.md').read_text('utf-8'),
                         re.M | re.S)
    (tmp_path / 'quad.yaml').write_text(block, encoding='utf-8')
    assert load_vehicle(str(tmp_path / 'quad.yaml')).mass == 0.5
