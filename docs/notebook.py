# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A Jupyter notebook as a page of Markdown, with the outputs that it was saved with."""

import json
from pathlib import Path


def page_of(path: Path) -> str:
    """Return the cells of a notebook (.ipynb, format 4) and their outputs in Markdown."""
    cells = json.loads(path.read_text(encoding='utf-8'))['cells']
    return '\n\n'.join(part for cell in cells for part in _parts(cell)) + '\n'


def _parts(cell: dict) -> list[str]:
    text = ''.join(cell['source'])
    if cell['cell_type'] != 'code':
        return [text]
    return [f'```python\n{text}\n```', *(_output(output) for output in cell['outputs'])]


def _output(output: dict) -> str:
    data = output.get('data', {})
    if 'image/png' in data:
        return f'![output](data:image/png;base64,{"".join(data["image/png"]).strip()})'
    if 'image/svg+xml' in data:
        return ''.join(data['image/svg+xml'])
    text = ''.join(output.get('text') or data['text/plain'])
    return f'```text\n{text.rstrip()}\n```'
