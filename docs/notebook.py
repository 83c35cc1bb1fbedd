# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Run the notebook of the tutorials and save its outputs: `.venv/bin/python -m docs.notebook`."""

import base64
import contextlib
import io
import json
from pathlib import Path

NOTEBOOK = Path(__file__).parent / 'tutorials' / 'notebook.ipynb'


def run(notebook: dict) -> dict:
    """Return a notebook (format 4) with the outputs that its cells give: text, then pictures."""
    names: dict = {}
    return {**notebook, 'cells': [
        {**cell, 'outputs': _outputs(''.join(cell['source']), names)}
        if cell['cell_type'] == 'code' else cell for cell in notebook['cells']]}


def page_of(notebook: dict) -> str:
    """Return the cells of a notebook and their outputs in Markdown."""
    return '\n\n'.join(part for cell in notebook['cells'] for part in _parts(cell)) + '\n'


def _outputs(source: str, names: dict) -> list[dict]:
    import matplotlib
    matplotlib.use('agg')
    from matplotlib import pyplot
    with contextlib.redirect_stdout(io.StringIO()) as said:
        exec(source, names)
    outputs: list[dict] = []
    if said.getvalue():
        outputs.append({'output_type': 'stream', 'name': 'stdout',
                        'text': said.getvalue().splitlines(keepends=True)})
    for number in pyplot.get_fignums():
        file = io.BytesIO()
        pyplot.figure(number).savefig(file, format='png', dpi=80, metadata={'Software': None})
        outputs.append({'output_type': 'display_data', 'metadata': {},
                        'data': {'image/png': base64.b64encode(file.getvalue()).decode()}})
    pyplot.close('all')
    return outputs


def _parts(cell: dict) -> list[str]:
    text = ''.join(cell['source'])
    if cell['cell_type'] != 'code':
        return [text]
    return [f'```python\n{text}\n```', *(_shown(output) for output in cell['outputs'])]


def _shown(output: dict) -> str:
    if output['output_type'] == 'stream':
        return f'```text\n{"".join(output["text"]).rstrip()}\n```'
    return f'![picture](data:image/png;base64,{output["data"]["image/png"]})'


if __name__ == '__main__':
    done = run(json.loads(NOTEBOOK.read_text(encoding='utf-8')))
    NOTEBOOK.write_text(json.dumps(done, indent=1, ensure_ascii=False) + '\n', encoding='utf-8')
