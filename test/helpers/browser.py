# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A page in headless Chromium, as a reader sees it; test/unit/report/test_pages_in_browser.py."""

from contextlib import contextmanager
from importlib.resources import files
import os
from pathlib import Path
import re
import shutil

import pytest

CHROMIUM = shutil.which('chromium')
WIDTHS = 1280, 390      # px, of a desk and of a telephone
# The usual best practices beside what WCAG 2.1 AA asks for: one main, headings in order.
AXE_CHECKS = """() => axe.run({runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa',
                                         'best-practice']})"""
CUT = """() => [...document.querySelectorAll('body *')].filter(one => {
  const box = one.getBoundingClientRect();
  return box.width > 1 && box.right > document.documentElement.clientWidth + 1;
}).map(one => one.tagName + ' ' + one.className + ': ' + one.textContent.slice(0, 60))"""


@contextmanager
def chromium():
    """Give Debian's Chromium, or skip the test where it, or what drives it, is not there."""
    driver = pytest.importorskip('playwright.sync_api', reason='.ci/requirements-browser.txt is '
                                 'not installed, by which .ci/run drives a browser')
    if CHROMIUM is None:
        pytest.skip('no browser: apt-get install chromium')
    # Root, as in a container, has no sandbox of Chromium.
    options = ['--no-sandbox'] if os.geteuid() == 0 else []
    with driver.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=options)
        try:
            yield browser
        finally:
            browser.close()


@contextmanager
def opened(browser, path, width=1280, **options):
    """
    Give a page that is open at a width (px), and what its console said and it asked to load.

    options: those of a context of Playwright, for example color_scheme='dark'.
    """
    context = browser.new_context(viewport={'width': width, 'height': 900}, **options)
    said, asked = [], []
    page = context.new_page()
    page.on('console', lambda message: said.append(message.text))
    page.on('pageerror', lambda error: said.append(str(error)))
    place = Path(path).resolve().as_uri()
    page.on('request', lambda request: asked.append(request.url)
            if request.url != place and not request.url.startswith('data:') else None)
    page.goto(place)
    try:
        yield page, said, asked
    finally:
        context.close()


def violations(page):
    """Return what axe-core objects to on a page: rule and first element of each."""
    script = files('axe_playwright_python').joinpath('axe.min.js').read_text(encoding='utf-8')
    page.evaluate(script)
    found = page.evaluate(AXE_CHECKS)
    assert len(found['passes']) > 10    # it has run
    return [(rule['id'], len(rule['nodes']), rule['nodes'][0]['html'][:200])
            for rule in found['violations']]


def printed(page, path):
    """Print a page to a PDF and return how many sheets it has."""
    page.pdf(path=str(path), format='A4')
    return len(re.findall(rb'/Type\s*/Page\b', path.read_bytes()))


def cut_in_print(page):
    """Return the elements that reach over the edge of a printed sheet of A4."""
    page.emulate_media(media='print')
    page.set_viewport_size({'width': 703, 'height': 1000})     # 210 mm less the margins, 96 dpi
    cut = page.evaluate(CUT)
    page.emulate_media(media='screen')
    return cut
