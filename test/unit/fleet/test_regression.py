# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The evidence of terms of a regression, against the normal density it stands for."""

import numpy as np
import pytest
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

from quad_ident_ros.fleet.regression import ALWAYS, LEVEL, Regression, Term, Terms, WIDTHS

COUNT = 7


def model(seed=3, always=1):
    """Return a Regression on noise, with its values, errors and columns."""
    rng = np.random.default_rng(seed)
    values, errors = rng.normal(2.0, 1.0, COUNT), rng.uniform(0.2, 0.6, COUNT)
    given, columns = rng.normal(size=(COUNT, always)), rng.normal(size=(COUNT, 4))
    terms = Terms(columns, np.log([0.1, 0.2, 0.3, 0.05]), np.array(['a', 'a', 'b', 'b']),
                  np.arange(4))
    return Regression(values, errors, given, terms), values, errors, given, columns


def by_density(one, values, errors, given, columns, chosen):
    """Return the log of the normal density of the values, summed over the scatters."""
    logs, grid = [], one.scatters / one.scatters.sum()
    for share, scatter in zip(grid, one.scatters, strict=True):
        noise = errors ** 2 + scatter ** 2
        unit = np.mean(1.0 / noise) ** -0.5
        cover = np.diag(noise) + (LEVEL * unit) ** 2 * np.ones((COUNT, COUNT))
        cover += (ALWAYS * unit) ** 2 * given @ given.T
        for term in chosen:
            column = columns[:, term.number]
            cover += (WIDTHS[term.width] * unit) ** 2 * np.outer(column, column)
        logs.append(multivariate_normal(np.full(COUNT, np.median(values)), cover).logpdf(values)
                    + np.log(share))
    return logsumexp(logs)


@pytest.mark.parametrize('chosen', [(Term(0, 0),), (Term(1, 2), Term(3, 1))])
def test_the_evidence_is_the_normal_density_summed_over_scatters(chosen):
    """Differences of scores are those of the density that is written out, and of the prior."""
    one, *data = model()
    odds = sum(one.terms.log_odds[term.number] - np.log(len(WIDTHS)) for term in chosen)
    assert one.score(chosen) - one.score(()) == pytest.approx(
        by_density(one, *data, chosen) - by_density(one, *data, ()) + odds, abs=1e-5)


def test_gains_of_all_terms_at_once_are_those_one_by_one():
    """What gains() says of each term is what its score is more than that of the set."""
    one, *_ = model()
    chosen = (Term(2, 1),)
    gains = one.gains(chosen)
    for number in (0, 1, 3):
        for width in range(len(WIDTHS)):
            assert gains[number, width] == pytest.approx(
                one.score((*chosen, Term(number, width))) - one.score(chosen), abs=1e-6)


def test_coefficients_of_exact_values_are_recovered():
    """Values that a level and a term make up without noise give these back."""
    rng = np.random.default_rng(0)
    columns = rng.normal(size=(20, 3))
    one = Regression(4.0 + 2.5 * columns[:, 1] + 1e-6 * rng.normal(size=20), np.full(20, 1e-4),
                     np.zeros((20, 0)), Terms(columns, np.full(3, -3.0), np.array(['a'] * 3),
                                              np.arange(3)))
    score, chosen = one.search()
    assert [term.number for term in chosen] == [1]
    assert score == one.score(chosen)
    assert one.posterior(chosen).mean == pytest.approx([4.0, 2.5], abs=1e-3)


def test_the_evidence_with_days_is_the_normal_density_summed_over_both_scatters():
    """Values of one day are correlated; the score is that of the density that is written out."""
    rng = np.random.default_rng(4)
    days = np.array([3.0, 3.0, 5.0, 8.0, 8.0, 8.0, 9.0])
    values, errors = rng.normal(2.0, 1.0, COUNT), rng.uniform(0.2, 0.6, COUNT)
    columns = rng.normal(size=(COUNT, 4))
    terms = Terms(columns, np.full(4, -2.0), np.array(['a'] * 4), np.arange(4))
    one = Regression(values, errors, np.zeros((COUNT, 0)), terms, days)
    together = (days[:, None] == days).astype(float)

    def density(chosen):
        logs = []
        for scatter, apart in zip(one.scatters, one.day_scatters, strict=True):
            cover = np.diag(errors ** 2 + scatter ** 2) + apart ** 2 * together
            unit = np.mean(1.0 / np.diag(cover)) ** -0.5
            cover += (LEVEL * unit) ** 2
            for term in chosen:
                column = columns[:, term.number]
                cover += (WIDTHS[term.width] * unit) ** 2 * np.outer(column, column)
            away = values - np.median(values)
            # Half of Cauchy's distribution for days, as wide as single values scatter: of all that
            # there are beside one scatter of these the shares sum to 1.
            wide = np.median(errors) ** 2 + scatter ** 2
            beside = one.day_scatters[one.scatters == scatter]
            share = apart / (1.0 + apart ** 2 / wide) / np.sum(beside / (1.0 + beside ** 2 / wide))
            logs.append(np.log(scatter * share) - 0.5 * (
                np.linalg.slogdet(cover)[1] + away @ np.linalg.solve(cover, away)))
        return logsumexp(logs)

    chosen = (Term(1, 0), Term(2, 1))
    odds = 2 * (-2.0 - np.log(len(WIDTHS)))
    assert one.score(chosen) - one.score(()) == pytest.approx(
        density(chosen) - density(()) + odds, abs=1e-5)
    gains = one.gains(chosen[:1])
    assert gains[2, 1] == pytest.approx(one.score(chosen) - one.score(chosen[:1]), abs=1e-6)
