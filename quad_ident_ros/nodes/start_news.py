# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a node logs of its start: how far it compiles, and when it is ready."""

import time

from quad_ident_ros.compiling import CompilationWatch

BRIEF = 1.0     # s of compilation that nobody needs to hear of
NEWS = 5.0      # s between two lines on how far it is
COMPILING = 'compil'     # what the lines on it begin with


class StartNews:
    """
    Logs that a node is ready, and how far a compilation is whenever there is one.

    A simulator compiles what a flight needs while it is ready; a node that works on records does
    before. Only compiling is reported, not loading what was compiled before.
    Args: node PackageNode.
    """

    def __init__(self, node):
        self._node, self._watch = node, CompilationWatch()
        self._ready = False
        self._told = None

    def tell(self):
        """Log what there is to say now."""
        self._tell_of_compilation()
        if not self._ready and self._node.is_ready:
            self._ready = True
            self._node.get_logger().info(f'ready: {self._node.ready()}')

    def _tell_of_compilation(self):
        state, now = self._watch.state(), time.monotonic()
        logger = self._node.get_logger()
        if not state.under_way:
            if self._told is not None and self._node.is_ready:
                logger.info(f'compiled in {state.seconds:.0f} s')
                self._told = None
                self._watch.close()
                self._watch = CompilationWatch()
        elif self._told is None and state.seconds > BRIEF:
            logger.info(f'{COMPILING}es its inner loops, which takes one to two minutes once '
                        'after each change, more on a busy machine; messages are kept meanwhile')
            self._told = now
        elif self._told is not None and now - self._told >= NEWS:
            logger.info(f'{COMPILING}ing: {state.ready} of at most {state.all} functions, '
                        f'{state.seconds:.0f} s')
            self._told = now
