# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Hooks of mkdocs.yml: pages that are made when the site is built, links, no network."""

from collections.abc import Iterator
import json
from pathlib import Path
import re

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from docs.command_line import reference
from docs.notebook import NOTEBOOK, page_of
from docs.offline import loaded

ROOT = Path(__file__).resolve().parents[1]
SOURCE = 'source'   # folder of the site with the files of the repository that pages refer to
FRONT = {'index.md': 'README.md', 'contributing.md': 'CONTRIBUTING.md'}
SIGNATURES = '\n## Signatures\n\n::: quad_ident_ros.api\n'
LINK = re.compile(r'(\[[^\]]*\])\(([^)#\s]+)(#[^)\s]*)?\)')
FENCED = re.compile(r'(^```.*?^```$)', re.M | re.S)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the front page, the command line, the notebook, and the files that links lead to."""
    for name, path in FRONT.items():
        text = (ROOT / path).read_text(encoding='utf-8')
        files.append(File.generated(config, name, content=_moved(text)))
    files.append(File.generated(config, 'command_line.md', content=reference()))
    notebook = json.loads(NOTEBOOK.read_text(encoding='utf-8'))
    files.append(File.generated(config, 'tutorials/notebook.md', content=page_of(notebook)))
    wanted = {target for page in files.documentation_pages()
              for target in _outside(page.content_string, page.src_uri)}
    for target in sorted(wanted):
        if (ROOT / target).is_file():
            files.append(File.generated(config, f'{SOURCE}/{target}',
                                        abs_src_path=str(ROOT / target)))
    return files


def on_page_markdown(markdown: str, page: Page, **_: object) -> str:
    """Return a page as MkDocs reads it: its Markdown is written for a Git host."""
    if page.file.src_uri == 'python.md':
        markdown += SIGNATURES
    up = '../' * page.file.src_uri.count('/')

    def led(link: re.Match[str]) -> str:
        target = _target(link[2], page.file.src_uri)
        if target is None:
            return link[0]
        return f'{link[1]}({up}{SOURCE}/{target})' if (ROOT / target).is_file() else link[1][1:-1]

    parts = FENCED.split(markdown)
    parts[::2] = [_lists(LINK.sub(led, part)) for part in parts[::2]]
    return ''.join(parts)


def on_post_build(config: MkDocsConfig) -> None:
    """Refuse a site that loads anything from a network."""
    for path in sorted(Path(config.site_dir).rglob('*.html')):
        if addresses := loaded(path.read_text(encoding='utf-8')):
            raise PluginError(f'{path.relative_to(config.site_dir)} loads {addresses[0]}: the '
                              'site has to work without a network; put the file into docs/')


def _moved(text: str) -> str:
    """Return a page of the root of the repository with the links that it has in docs/."""
    text = text.replace('](docs/', '](').replace('](CONTRIBUTING.md', '](contributing.md')
    return re.sub(r'\]\((LICENSE|CHANGELOG\.rst)\)', r'](../\1)', text)


def _target(link: str, page: str) -> str | None:
    """Return the path in the repository of a link that leads out of docs/, or None."""
    if link.startswith(('http', 'mailto')):
        return None
    path = ((ROOT / 'docs' / page).parent / link).resolve()
    outside = path.is_relative_to(ROOT) and not path.is_relative_to(ROOT / 'docs')
    return str(path.relative_to(ROOT)) if outside else None


def _outside(markdown: str, page: str) -> Iterator[str]:
    for part in FENCED.split(markdown)[::2]:
        for link in LINK.finditer(part):
            if target := _target(link[2], page):
                yield target


def _lists(text: str) -> str:
    """Return Markdown whose lists Python-Markdown reads as a Git host does."""
    text = re.sub(r'^  (?=- )', '    ', text, flags=re.M)
    return re.sub(r'^(?!- |[ \n|#>])(.+)\n(?=- )', r'\1\n\n', text, flags=re.M)
