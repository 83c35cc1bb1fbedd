# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Which terms a regression of values with standard errors needs, and how probable each one is.

A value is normal about the sum of the terms, with its standard error and, beside it, a scatter
that is the same for all values and is not known: standard errors that are too small make nothing
sure. The evidence of a set of terms is a closed form at each scatter and width, and is summed over
both (Bayesian model choice with conjugate priors; J. M. Bernardo and A. F. M. Smith, Bayesian
Theory, 1994, section 6.1).
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

SCATTERS = 40
"""
Scatters that are summed over. Before looking all are as probable up to the most: one that is even
in the logarithm would prefer none (A. Gelman, Bayesian Analysis 1, 2006).
"""
LEAST, MOST = 0.05, 10.0
"""Standard errors, the least and the most scatter: less cannot be seen, more is a wrong error."""
WIDTHS = (3.0, 30.0, 300.0)
"""
Prior standard deviations of a term, in errors of one value: what concerns anybody is more than
that error, and a wrong log may be off by hundreds.
"""
ALWAYS = 30.0
"""The same of the terms that are always in: covariates."""
LEVEL = 1e4
"""The same for the level, which has no prior value. All sets have it alike."""
FARTHEST = 5.0      # standard deviations of the values, up to which the scatter is looked for
NORMAL = 1.4826     # times the median absolute deviation is the standard deviation
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


@dataclass(frozen=True)
class Term:
    """One of the Terms with one of the WIDTHS, by their numbers."""

    number: int
    width: int


@dataclass(frozen=True, eq=False)
class Posterior:
    """
    What is known of the coefficients of a set of terms: mean (M,), covariance (M, M).

    In the order: level, terms that are always in, terms of the set. scatter: its posterior mean,
    beside the standard errors.
    """

    mean: np.ndarray
    covariance: np.ndarray
    scatter: float


class Regression:
    """Values (N,) with standard errors (N,), columns (N, A) that are always in, and Terms."""

    def __init__(self, values: np.ndarray, errors: np.ndarray, always: np.ndarray,
                 terms: Terms) -> None:
        self.terms = terms
        self._level = float(np.median(values))
        self._values = values - self._level
        usual = float(np.median(errors))
        most = max(MOST * usual, FARTHEST * NORMAL * float(np.median(np.abs(self._values))))
        self.scatters = np.geomspace(LEAST * usual, most, SCATTERS)
        self._prior = np.log(self.scatters / self.scatters.sum())   # even, on a grid that is not
        self._weights = 1.0 / (errors ** 2 + self.scatters[:, None] ** 2)
        self._unit = np.mean(self._weights, axis=1) ** -0.5     # error of one value, (G,)
        self._always = np.column_stack([np.ones(len(values)), always])
        self._known: dict[frozenset, float] = {}

    def score(self, chosen: Collection[Term]) -> float:
        """Return the log of the posterior of a set of terms, up to a constant of the values."""
        key = frozenset(chosen)
        if key not in self._known:
            self._known[key] = float(logsumexp(self._evidence(chosen)[0])) + self._odds(chosen)
        return self._known[key]

    def gains(self, chosen: Collection[Term]) -> np.ndarray:
        """Return by how much each term in each width, (K, W), raises the score of a set."""
        evidence, design, factor, cross = self._evidence(chosen)
        columns, weights = self.terms.columns, self._weights
        power = weights @ columns ** 2
        shared = np.einsum('gn,nm,nk->gmk', weights, design, columns, optimize=True)
        along = (weights * self._values) @ columns
        solved = np.linalg.solve(factor, np.concatenate([shared, cross[..., None]], axis=2))
        power = power - np.sum(solved[..., :-1] ** 2, axis=1)
        along = along - np.einsum('gmk,gm->gk', solved[..., :-1], solved[..., -1])
        widths = (np.array(WIDTHS) * self._unit[:, None])[:, None, :] ** 2      # (G, 1, W)
        spread = 1.0 + widths * np.maximum(power, 0.0)[..., None]
        gain = -0.5 * np.log(spread) + 0.5 * widths * along[..., None] ** 2 / spread
        told = logsumexp(evidence[:, None, None] + gain, axis=0) - logsumexp(evidence)
        return told + self.terms.log_odds[:, None] - np.log(len(WIDTHS))

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
        while idle < PATIENCE and len(fixed) + len(chosen) < len(self._values) // 2:
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
        """Return the shares (G,) of the scatters, means (G, M) and covariances (G, M, M)."""
        evidence, _, factor, cross = self._evidence(chosen)
        inverse = np.linalg.inv(factor)
        covariances = np.swapaxes(inverse, 1, 2) @ inverse
        means = (covariances @ cross[..., None])[..., 0]
        means[:, 0] += self._level
        return np.exp(evidence - logsumexp(evidence)), means, covariances

    def probability(self, numbers: np.ndarray, chosen: Collection[Term], term: Term,
                    without: float) -> float:
        """
        Return the probability that one of some terms is present.

        Args: numbers of these terms; chosen: the best set, and a term of it that they could take
        the place of; without: the score of the best set that has none of them.
        """
        rest = tuple(one for one in chosen if one != term)
        there = self.score(rest) + float(logsumexp(self.gains(rest)[numbers]))
        return float(1.0 / (1.0 + np.exp(np.clip(without - there, -700.0, 700.0))))

    def posterior(self, chosen: Collection[Term]) -> Posterior:
        """Return the posterior of the coefficients of a set, over all scatters."""
        shares, means, covariances = self.coefficients(chosen)
        mean = shares @ means
        apart = means - mean
        whole = (np.einsum('g,gij->ij', shares, covariances)
                 + np.einsum('g,gi,gj->ij', shares, apart, apart))
        return Posterior(mean, whole, float(shares @ self.scatters))

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

    def _evidence(self, chosen: Collection[Term]) -> tuple:
        """
        Return the log-evidence (G,) at each scatter, the design and what solves it.

        Design (N, M); factor (G, M, M): Cholesky's of the precision; cross (G, M).
        """
        design = self.design(chosen)
        given = np.array([LEVEL, *np.full(self._always.shape[1] - 1, ALWAYS),
                          *(WIDTHS[term.width] for term in chosen)])
        prior = (given * self._unit[:, None]) ** -2.0
        weighted = self._weights[:, :, None] * design
        precision = np.swapaxes(weighted, 1, 2) @ design
        precision = precision + prior[:, :, None] * np.eye(design.shape[1])
        factor = np.linalg.cholesky(precision)
        cross = np.einsum('gnm,n->gm', weighted, self._values)
        solved = np.linalg.solve(factor, cross[..., None])[..., 0]
        power = self._weights @ self._values ** 2
        logs = 2.0 * np.sum(np.log(np.einsum('gii->gi', factor)), axis=1)
        evidence = self._prior + 0.5 * (np.sum(np.log(self._weights), axis=1)
                                        + np.sum(np.log(prior), axis=1)
                                        - logs - power + np.sum(solved ** 2, axis=1))
        return evidence, design, factor, cross
