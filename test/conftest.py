# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What holds for all tests: the same examples in every run, so that a failure can be run again."""

from hypothesis import settings

settings.register_profile('same', derandomize=True)
settings.register_profile('explore', print_blob=True)   # pytest --hypothesis-profile=explore
settings.load_profile('same')
