# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The process that looks at a data set: it is given a folder and knows nothing else of it."""

import json
from pathlib import Path
import sys

from quad_ident_ros.fleet.insight import insight
from quad_ident_ros.report.data import finite


def main(out: str, target: str) -> None:
    """Write the insight of the data set in a folder as JSON."""
    Path(target).write_text(json.dumps(finite(insight(out).as_data())), encoding='utf-8')


if __name__ == '__main__':
    main(*sys.argv[1:])
