# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a drogue on a line, and of flaps that fold in the flow."""

import numpy as np

from withheld.forms.air import Drag


class Drogue(Drag):
    """
    A body that tows a light drogue on a line: it pulls where the line is taut, and not otherwise.

    So it is free for a while after each turn back. The drogue stays in the air where it is until
    the line takes it along, as on a curve of pursuit; its drag goes with the square: S. F.
    Hoerner, Fluid-Dynamic Drag, 1965.
    """

    OWN, MORE = 0.3, 1.2            # of the coefficient: the body, the drogue
    LENGTH, SLACK = 0.5, 0.9        # m; of it, below which nothing is passed on

    def begin(self, rng):
        """Start with the drogue close by, and the line slack."""
        self._away, self._flow = np.zeros(3), np.zeros(3)

    def law(self, now):
        """Return what the coefficient is of."""
        self._flow = now.rotation @ now.air
        far = float(np.linalg.norm(self._away))
        onto = self._away / max(far, 1e-9)
        taut = np.clip((far / self.LENGTH - self.SLACK) / (1.0 - self.SLACK), 0.0, 1.0)
        leaves = max(-float(self._flow @ onto), 0.0)
        pull = self.MORE * taut * leaves ** 2 * onto
        return self.OWN * np.linalg.norm(now.air) * now.air - now.rotation.T @ pull

    def after(self, step, rotation, acceleration):
        """Let the line take it along."""
        away = self._away - step * self._flow
        self._away = away * min(self.LENGTH / max(float(np.linalg.norm(away)), 1e-9), 1.0)


class Flaps(Drag):
    """
    A body with flaps on springs all around, which level flow folds back: then they have less drag.

    What presses on a flap goes with the square of what meets it, and a spring with the angle. As
    leaves fold in the wind: S. Vogel, Life in Moving Fluids, 1994.
    """

    OWN, MORE, FOLDS = 0.35, 1.5, 1.8       # of the coefficient, each; m/s, that fold by 1 rad
    TIME = 0.15                             # s

    def begin(self, rng):
        """Start with all of them open."""
        self._angle, self._goal = 0.0, 0.0

    def law(self, now):
        """Return what the coefficient is of."""
        level = now.air - now.rotation[2] @ now.air * now.rotation[2]
        speed = float(np.linalg.norm(level))
        self._goal = folded(min((speed / self.FOLDS) ** 2, 20.0))
        flaps = self.MORE * np.cos(self._angle) ** 2 * speed * level
        return self.OWN * np.linalg.norm(now.air) * now.air + flaps

    def after(self, step, rotation, acceleration):
        """Let them fold or open."""
        self._angle += (1.0 - np.exp(-step / self.TIME)) * (self._goal - self._angle)


def folded(square):
    """Return the angle, rad, that is its cosine times a square: by Newton's steps."""
    angle = square / (1.0 + square)
    for _ in range(8):
        angle -= (angle - square * np.cos(angle)) / (1.0 + square * np.sin(angle))
    return float(angle)
