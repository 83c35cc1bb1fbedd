# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Draw docs/watch.svg, the live view of nodes that are running (python docs/watch.py)."""

import asyncio
from pathlib import Path
import re
import sys

from quad_ident_ros.nodes.watching import Watching
from quad_ident_ros.watch.view import WatchApp

PICTURE = Path(__file__).with_name('watch.svg')
SIZE = (100, 30)        # columns and rows
LOOK = 0.5              # s between two looks
FONTS = re.compile(r'@font-face \{.*?\}\s*', re.DOTALL)     # from the network


async def picture(source, size):
    """Return the view (SVG) once there are a fit and a verdict."""
    app = WatchApp(source)
    async with app.run_test(size=size) as pilot:
        while source.state.fit is None or source.state.verdict is None:
            await pilot.pause(LOOK)
        await pilot.pause(4 * LOOK)
        return FONTS.sub('', app.export_screenshot(title='quad_ident watch'))


def main(path=PICTURE, columns=SIZE[0], rows=SIZE[1]):
    """Wait for the nodes of ROS_DOMAIN_ID to have a fit and a verdict, and draw the view."""
    with Watching() as source:
        Path(path).write_text(asyncio.run(picture(source, (int(columns), int(rows)))),
                              encoding='utf-8')
    print(path)


if __name__ == '__main__':
    main(*sys.argv[1:])
