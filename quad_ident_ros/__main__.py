# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Run `python -m quad_ident_ros`: the same as `quad_ident`."""

import sys

if __name__ == '__main__':
    try:
        from quad_ident_ros.cli.main import main
        sys.exit(main())
    except KeyboardInterrupt:   # while the libraries are still being loaded
        sys.exit(130)
