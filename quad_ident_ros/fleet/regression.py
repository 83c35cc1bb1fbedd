# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Which terms a regression of values with standard errors needs, and how probable each one is.

A value is normal about the sum of the terms, with its standard error and, beside it, scatters
that are the same for all values and are not known (see Scatter): standard errors that are too
small make nothing sure. The evidence of a set of terms is a closed form at each scatter, at each
width and at each alternative of what is known of coefficients, and is summed over all of them
(Bayesian model choice with conjugate priors; J. M. Bernardo and A. F. M. Smith, Bayesian Theory,
1994, section 6.1).
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass

import numpy as np
import scipy

from quad_ident_ros.fleet.scatter import Scatter

WIDTHS = (3.0, 30.0, 300.0)
"""
Prior standard deviations of a term, in errors of one value: what concerns anybody is more than
that error, and a wrong log may be off by hundreds.
"""
ALWAYS = 30.0
"""The same of the terms that are always in, covariates, where nothing better is known."""
LEVEL = 1e4
"""The same for the level, which has no prior value. All sets have it alike."""
NEGLIGIBLE = -40.0  # log: what is less than this share of a sum changes none of its 16 digits
PATIENCE = 2        # terms that a search adds without a gain: a change and the way back are two


@dataclass(frozen=True, eq=False)
class Terms:
    """
    Terms that may be added: columns (N, K), log_odds (K,) before looking, kind (K,).

    place (K,): which value or time each belongs to.
    """

    columns: np.ndarray
    log_odds: np.ndarray
    kind: np.ndarray
    place: np.ndarray


@dataclass(frozen=True, eq=False)
class Known:
    """
    What is known beforehand of the coefficients of terms that are always in: C alternatives.

    mean, std (C, A): normal, the standard deviation no more than ALWAYS; log_share (C,): log of
    the probability of each alternative.
    """

    mean: np.ndarray
    std: np.ndarray
    log_share: np.ndarray


@dataclass(frozen=True)
class Term:
    """One of the Terms with one of the WIDTHS, by their numbers."""

    number: int
    width: int


@dataclass(frozen=True, eq=False)
class Posterior:
    """
    What is known of the coefficients of a set of terms: mean (M,), covariance (M, M).

    In the order: level, terms that are always in, terms of the set. scatter, day_scatter: the
    posterior means of those of single values and of days, beside the standard errors.
    """

    mean: np.ndarray
    covariance: np.ndarray
    scatter: float
    day_scatter: float


class Regression:
    """
    Values (N,) with standard errors (N,), columns (N, A) that are always in, and Terms.

    days (N,): which day each value is of, see Scatter; known: of the coefficients of `always`, by
    default nothing. Its C alternatives times the G points of the grid of Scatter are the P points
    that are summed over; scatters, day_scatters (P,): of single values and of days, at them.
    """

    def __init__(self, values: np.ndarray, errors: np.ndarray, always: np.ndarray,
                 terms: Terms, days: np.ndarray | None = None, known: Known | None = None
                 ) -> None:
        self.terms = terms
        self._scatter = Scatter(values, errors, days)
        self._always = np.column_stack([np.ones(len(values)), always])
        self._columns = np.column_stack([self._always, terms.columns])
        if known is None:
            known = Known(np.zeros((1, always.shape[1])), np.full((1, always.shape[1]), np.inf),
                          np.zeros(1))
        self._alternatives = count = len(known.log_share)
        self.scatters = np.tile(self._scatter.singles, count)
        self.day_scatters = np.tile(self._scatter.days, count)
        grid = len(self._scatter.prior)
        self._error = np.tile(self._scatter.error, count)
        self._prior = (known.log_share[:, None] + self._scatter.prior).ravel()
        level = np.full((count, 1), float(np.median(values)))
        self._start = np.repeat(np.column_stack([level, known.mean]), grid, axis=0)
        self._given = np.column_stack([
            LEVEL * self._error, np.minimum(ALWAYS * self._error[:, None],
                                            np.repeat(known.std, grid, axis=0))])
        centred = values[:, None] - self._always @ np.column_stack([level, known.mean]).T
        self._along = np.concatenate([self._scatter.products(one, self._columns)
                                      for one in centred.T])
        self._squares = self._scatter.squares(self._columns)
        self._whole = self._scatter.squares(centred).T.ravel()
        # What is worked out once: a search asks for the same again and again.
        self._rows: dict[int, np.ndarray] = {}
        self._scores: dict[frozenset, float] = {}
        self._gained: dict[frozenset, np.ndarray] = {}

    def score(self, chosen: Collection[Term]) -> float:
        """Return the log of the posterior of a set of terms, up to a constant of the values."""
        key = frozenset(chosen)
        if key not in self._scores:
            self._scores[key] = self._odds(chosen) + float(
                scipy.special.logsumexp(self._evidence(chosen)[0]))
        return self._scores[key]

    def gains(self, chosen: Collection[Term]) -> np.ndarray:
        """Return by how much each term in each width, (K, W), raises the score of a set."""
        key = frozenset(chosen)
        if key not in self._gained:
            self._gained[key] = self._gains(chosen)
        return self._gained[key]

    def search(self, start: Iterable[Term] = (), among: Collection[str] = ()
               ) -> tuple[float, tuple[Term, ...]]:
        """
        Return (score, terms) of the best set that is found by adding, exchanging, leaving out.

        Args: start: terms that stay; among: the kinds that may be added, by default all.
        """
        fixed = tuple(start)
        allowed = np.isin(self.terms.kind, list(among)) if among else np.ones(
            len(self.terms.kind), bool)
        chosen: tuple[Term, ...] = ()
        best = (self.score(fixed), fixed)
        idle = 0
        while idle < PATIENCE and len(fixed) + len(chosen) < len(self._columns) // 2:
            chosen = self._settled(fixed, (*chosen, self._top((*fixed, *chosen), allowed)),
                                   allowed)
            value = self.score((*fixed, *chosen))
            idle = 0 if value > best[0] else idle + 1
            best = max(best, (value, (*fixed, *chosen)), key=lambda one: one[0])
        kept = best[1]
        while True:
            smaller = [tuple(one for one in kept if one != term) for term in kept
                       if term not in fixed]
            top = max(smaller, key=self.score, default=kept)
            if not smaller or self.score(top) <= self.score(kept):
                return self.score(kept), kept
            kept = top

    def coefficients(self, chosen: Collection[Term]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the shares (P,) of the grid, means (P, M) and covariances (P, M, M)."""
        evidence, inverse, solved = self._evidence(chosen)
        covariances = np.swapaxes(inverse, 1, 2) @ inverse
        means = (solved[:, None] @ inverse)[:, 0]
        means[:, :self._start.shape[1]] += self._start
        return np.exp(evidence - scipy.special.logsumexp(evidence)), means, covariances

    def probability(self, numbers: np.ndarray, chosen: Collection[Term], term: Term,
                    without: float) -> float:
        """
        Return the probability that one of some terms is present.

        Args: numbers of these terms; chosen: the best set, and a term of it that they could take
        the place of; without: the score of the best set that has none of them.
        """
        rest = tuple(one for one in chosen if one != term)
        there = self.score(rest) + float(scipy.special.logsumexp(self.gains(rest)[numbers]))
        return float(1.0 / (1.0 + np.exp(np.clip(without - there, -700.0, 700.0))))

    def posterior(self, chosen: Collection[Term]) -> Posterior:
        """Return the posterior of the coefficients of a set, over all scatters."""
        shares, means, covariances = self.coefficients(chosen)
        mean = shares @ means
        apart = means - mean
        whole = (np.einsum('g,gij->ij', shares, covariances)
                 + np.einsum('g,gi,gj->ij', shares, apart, apart))
        return Posterior(mean, whole, float(shares @ self.scatters),
                         float(shares @ self.day_scatters))

    def design(self, chosen: Collection[Term]) -> np.ndarray:
        """Return the columns (N, M) of the coefficients of a set: level, always, terms."""
        return np.column_stack([self._always,
                                self.terms.columns[:, [term.number for term in chosen]]])

    def _top(self, chosen: tuple[Term, ...], allowed: np.ndarray) -> Term:
        gains = np.where(allowed[:, None], self.gains(chosen), -np.inf)
        for term in chosen:
            gains[term.number] = -np.inf
        number, width = np.unravel_index(int(np.argmax(gains)), gains.shape)
        return Term(int(number), int(width))

    def _settled(self, fixed: tuple[Term, ...], chosen: tuple[Term, ...], allowed: np.ndarray
                 ) -> tuple[Term, ...]:
        """Return the set with each term in turn moved to where it helps most, until none moves."""
        while True:
            before = chosen
            for term in before:
                others = tuple(one for one in chosen if one != term)
                moved = (*others, self._top((*fixed, *others), allowed))
                if self.score((*fixed, *moved)) > self.score((*fixed, *chosen)) + 1e-9:
                    chosen = moved
            if chosen == before:
                return chosen

    def _odds(self, chosen: Collection[Term]) -> float:
        return float(sum(self.terms.log_odds[term.number] - np.log(len(WIDTHS))
                         for term in chosen))

    def _evidence(self, chosen: Collection[Term]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """
        Return the log-evidence (P,) at each point of the grid, and what solves a set.

        The inverse (P, M, M) of Cholesky's factor of the precision; it times the values (P, M).
        """
        numbers = self._numbers(chosen)
        widths = np.array([WIDTHS[term.width] for term in chosen])
        prior = np.column_stack([self._given, widths * self._error[:, None]]) ** -2.0
        precision = np.stack([self._row(number)[:, numbers] for number in numbers], axis=1)
        precision = (np.tile(precision, (self._alternatives, 1, 1))
                     + prior[:, :, None] * np.eye(len(numbers)))
        factor = np.linalg.cholesky(precision)
        inverse = np.linalg.inv(factor)
        solved = (inverse @ self._along[:, numbers, None])[..., 0]
        logs = 2.0 * np.sum(np.log(np.einsum('gii->gi', factor)), axis=1)
        evidence = self._prior + 0.5 * (
            np.tile(self._scatter.determinant, self._alternatives)
            + np.sum(np.log(prior), axis=1) - logs - self._whole + np.sum(solved ** 2, axis=1))
        return evidence, inverse, solved

    def _gains(self, chosen: Collection[Term]) -> np.ndarray:
        evidence, inverse, solved = self._evidence(chosen)
        always = self._always.shape[1]
        shared = np.stack([self._row(number)[:, always:] for number in self._numbers(chosen)],
                          axis=1)
        each = inverse.reshape(self._alternatives, -1, *inverse.shape[1:])
        shared = (each @ shared).reshape(len(inverse), *shared.shape[1:])
        power = (np.tile(self._squares[:, always:], (self._alternatives, 1))
                 - np.einsum('pmk,pmk->pk', shared, shared))
        power = np.maximum(power, 0.0)
        along = self._along[:, always:] - (solved[:, None] @ shared)[:, 0]
        evidence = (evidence - scipy.special.logsumexp(evidence))[:, None]
        widths = (np.array(WIDTHS) * self._error[:, None]) ** 2      # (P, W)
        # A term raises a point by no more than this, and is worth what it is at the best one.
        most = evidence + 0.5 * along ** 2 / (1.0 / widths[:, -1:] + power)
        best = [int(np.argmax(evidence))]
        least = np.min(_gain(widths[best], power[best], along[best]), axis=(0, 2)) + evidence[best]
        kept = np.flatnonzero(np.max(most - least, axis=1) > NEGLIGIBLE)
        gain = _gain(widths[kept], power[kept], along[kept]) + evidence[kept][..., None]
        top = np.max(gain, axis=0)      # by hand, for it is most of the work
        told = top + np.log(np.sum(np.exp(gain - top), axis=0))
        return told + self.terms.log_odds[:, None] - np.log(len(WIDTHS))

    def _numbers(self, chosen: Collection[Term]) -> list[int]:
        """Return which columns a set has: those that are always in, and those of its terms."""
        always = self._always.shape[1]
        return [*range(always), *(always + term.number for term in chosen)]

    def _row(self, number: int) -> np.ndarray:
        """Return the products (G, A + K) of a column with all columns."""
        if number not in self._rows:
            self._rows[number] = self._scatter.products(
                self._columns[:, number], self._columns)
        return self._rows[number]


def _gain(widths: np.ndarray, power: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Return the gains (P, K, W) of terms by widths (P, W), their power and along (P, K)."""
    squares = widths[:, None, :]
    spread = 1.0 + squares * power[..., None]
    return 0.5 * (squares * along[..., None] ** 2 / spread - np.log(spread))
