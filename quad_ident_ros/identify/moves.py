# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The inner loops of the swarm methods: from random numbers to the next points, (N, D) each."""

import numpy as np

from quad_ident_ros.compiled import compiled


@compiled
def levy_step(u: float, v: float, sigma: float, exponent: float) -> float:
    """Return the Levy-distributed step of two standard normal numbers, eq. (25)."""
    return sigma * u * np.abs(v) ** (-1.0 / exponent)


@compiled
def fly(points: np.ndarray, best: np.ndarray, normals: np.ndarray, pulls: np.ndarray, sigma: float,
        exponent: float, size: float, pull: float, limit: float, new: np.ndarray) -> None:
    """
    Write the points after a Levy flight, eq. (27), and a pull to the best, eq. (29).

    normals (2, N, D) standard normal, pulls (2, N, D) in [0, 1]; sigma and exponent as in
    levy.levy_sigma; size of the flights; pull, the largest share of the way to the best; limit of
    the box.
    """
    for i in range(points.shape[0]):
        for d in range(points.shape[1]):
            step = size * levy_step(normals[0, i, d], normals[1, i, d], sigma, exponent)
            step += pulls[0, i, d] * pulls[1, i, d] * pull * (best[d] - points[i, d])
            new[i, d] = min(max(points[i, d] + step, 0.0), limit)


@compiled
def exchange(points: np.ndarray, found: np.ndarray, shares: np.ndarray, orders: np.ndarray,
             probability: float, limit: float, new: np.ndarray) -> None:
    """
    Write the points after R H(Pa - r) (Xj - Xk), eq. (28) put right.

    found (N, D) is r, shares (N, D) is R, both in [0, 1], orders (2, N) are the places j and k.
    """
    for i in range(points.shape[0]):
        j, k = orders[0, i], orders[1, i]
        for d in range(points.shape[1]):
            step = 0.0
            if found[i, d] < probability:
                step = shares[i, d] * (points[j, d] - points[k, d])
            new[i, d] = min(max(points[i, d] + step, 0.0), limit)


@compiled
def shuffle(uniforms: np.ndarray, orders: np.ndarray) -> None:
    """Write permutations (n, N) from numbers in [0, 1), by Fisher and Yates."""
    for row in range(orders.shape[0]):
        for i in range(orders.shape[1]):
            orders[row, i] = i
        for i in range(orders.shape[1] - 1, 0, -1):
            j = int(uniforms[row, i] * (i + 1))
            orders[row, i], orders[row, j] = orders[row, j], orders[row, i]


@compiled
def swarm(points: np.ndarray, velocity: np.ndarray, own_best: np.ndarray, best: np.ndarray,
          pulls: np.ndarray, inertia: float, c1: float, c2: float, limit: float) -> None:
    """Move particles in place: eqs. (21), (22); pulls (4, N, D) in [0, 1]."""
    for i in range(points.shape[0]):
        for d in range(points.shape[1]):
            velocity[i, d] = (
                inertia * velocity[i, d]
                + c1 * pulls[0, i, d] * pulls[1, i, d] * (own_best[i, d] - points[i, d])
                + c2 * pulls[2, i, d] * pulls[3, i, d] * (best[d] - points[i, d]))
            points[i, d] = min(max(points[i, d] + velocity[i, d], 0.0), limit)


@compiled
def keep_better(points: np.ndarray, costs: np.ndarray, new: np.ndarray, new_costs: np.ndarray
                ) -> None:
    """Replace, in place, the points that new ones improve."""
    for i in range(points.shape[0]):
        if new_costs[i] < costs[i]:
            costs[i] = new_costs[i]
            for d in range(points.shape[1]):
                points[i, d] = new[i, d]
