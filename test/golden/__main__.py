# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`python test/golden record` keeps the verdicts of today, `compare` prints what has changed."""

import argparse

import verdicts

parser = argparse.ArgumentParser(prog='python test/golden', description=__doc__)
parser.add_argument('command', choices=('record', 'compare'))
getattr(verdicts, parser.parse_args().command)()
