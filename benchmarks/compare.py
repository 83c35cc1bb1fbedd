# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Methods side by side: the same draws of a problem, in turn, on one core."""

from collections.abc import Callable
import contextlib
from dataclasses import dataclass, field
import io
import warnings

import numpy as np

from benchmarks.machine import timed
from benchmarks.reference import best_real, cost_of
from benchmarks.tables import number

FEWEST = 3      # draws that even a slow method gets
FAST, REPEATS = 0.02, 5     # a fit that takes less, in s, is timed so often, for the median


@dataclass(frozen=True)
class Contender:
    """
    A method under test.

    fit: a function of (signals, seed) that returns K, c1, c0 (outputs, 3), with NaN where there
    is no model, and the evaluations it spent, or None; warm_up: the same for a first call that
    is not measured, where one of fit would take too long.
    """

    label: str
    fit: Callable
    warm_up: Callable | None = None


@dataclass
class Score:
    """What a contender reached on a problem: per draw, CPU time s, models and evaluations."""

    seconds: list = field(default_factory=list)
    models: list = field(default_factory=list)
    evaluations: list = field(default_factory=list)
    ratios: np.ndarray | None = None     # J/J_ML per draw
    rmse: float = np.nan                 # over the Cramer-Rao bound
    failure: str = ''

    @property
    def milliseconds(self):
        """Median CPU time, ms."""
        return 1e3 * float(np.median(self.seconds)) if self.seconds else np.nan

    @property
    def ratio(self):
        """Median J/J_ML."""
        return float(np.median(self.ratios)) if self.seconds else np.nan

    def at_best(self, tolerance):
        """Return the share of draws whose cost is the best, to a tolerance."""
        return float(np.mean(self.ratios <= 1 + tolerance)) if self.seconds else np.nan

    @property
    def spent(self):
        """Return the evaluations as text."""
        known = [count for count in self.evaluations if count]
        return number(float(np.median(known)), 4) if known else '–'


def compare(problem, contenders, draws, seconds, advance=lambda: None):
    """
    Return the Score of each contender by label, and the best costs J_ML (draws,).

    Args: draws: how many; seconds: CPU time after which a contender gets no more draws than
    FEWEST; advance: called after each fit.
    """
    scores = {contender.label: Score() for contender in contenders}
    first = problem.draw(draws)
    for contender in contenders:
        _fit(scores[contender.label], contender.warm_up or contender.fit, first, 0, False)
    data = []
    for draw in range(draws):
        data.append(problem.draw(draw))
        for contender in contenders:
            score = scores[contender.label]
            slow = len(score.seconds) >= FEWEST and sum(score.seconds) > seconds
            if not (score.failure or slow):
                _fit(score, contender.fit, data[draw], draw, True)
            advance()
    costs = {label: np.array([[cost_of(signal, model)
                               for signal, model in zip(signals, models, strict=True)]
                              for signals, models in zip(data, score.models, strict=False)])
             for label, score in scores.items()}
    best = np.array([[best_real(signal, truth)[1]
                      for signal, truth in zip(signals, problem.truths, strict=True)]
                     for signals in data])
    for label, score in scores.items():
        for draw, models in enumerate(score.models):
            real = models[:, 1] ** 2 / 4 >= models[:, 2]
            found = np.where(real, costs[label][draw], np.inf)
            best[draw] = np.minimum(best[draw], found)
    for label, score in scores.items():
        if score.models:
            score.ratios = costs[label].sum(axis=1) / best[:len(score.models)].sum(axis=1)
            score.rmse = rmse_over_bound(problem, np.array(score.models))
    return scores, best.sum(axis=1)


def rmse_over_bound(problem, models):
    """
    Return the root mean square of the errors of K, c1, c0 (draws, outputs, 3) over their bounds.

    Fits without a model do not count; NaN where there is none.
    """
    truths = np.array([bound.values[:3] for bound in problem.bounds])
    errors = np.array([bound.errors[:3] for bound in problem.bounds])
    there = np.isfinite(models).all(axis=2)
    return float(np.sqrt(np.mean(((models - truths) / errors)[there] ** 2))) \
        if there.any() else np.nan


def each(fit):
    """Return a function of (signals, seed) that fits one signal after the other."""
    def fit_all(signals, seed):
        found = [fit(signal, seed) for signal in signals]
        return np.array([model for model, _ in found]), sum(count for _, count in found)
    return fit_all


def _fit(score, fit, signals, seed, counts):
    try:
        with quiet():
            (models, spent), seconds = timed(fit, signals, seed)
            if counts and seconds < FAST:
                seconds = np.median([timed(fit, signals, seed)[1] for _ in range(REPEATS)])
    except ImportError as error:
        score.failure = f'not installed ({error.name})'
    except (Exception, SystemExit) as error:     # whatever a peer comes up with
        score.failure = f'fails: {type(error).__name__}'
    else:
        if counts:
            score.seconds.append(float(seconds))
            score.models.append(models)
            score.evaluations.append(spent)


@contextlib.contextmanager
def quiet():
    """Keep what peers print, and what they are warned of, off the screen."""
    with warnings.catch_warnings(), np.errstate(all='ignore'), \
            contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        warnings.simplefilter('ignore')
        yield
