# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Optimisers of other libraries, each on the joint problem of the paper as its users would call it.

A peer is a function of (tracker, seed) that searches the unit box until the tracker raises Spent.
Populations are the paper's; coefficients are those of the library, its defaults or, for pyswarms,
which has none, its documentation's: with the paper's they all end at a higher cost.
"""

import numpy as np

POPULATION = 200


def pyswarms_pso(tracker, seed):
    """Search by pyswarms' global-best PSO, which takes whole populations."""
    from pyswarms.single import GlobalBestPSO
    np.random.seed(seed)    # it has no seed of its own
    dimension = tracker.joint.dimension
    swarm = GlobalBestPSO(POPULATION, dimension, {'c1': 0.5, 'c2': 0.3, 'w': 0.9},
                          bounds=(np.zeros(dimension), np.ones(dimension)))
    swarm.optimize(tracker.many, tracker.budget // POPULATION + 1, verbose=False)


def mealpy_pso(tracker, seed):
    """Search by mealpy's PSO, one candidate at a time: it refuses populations."""
    from mealpy import PSO
    _mealpy(PSO.OriginalPSO(tracker.budget // POPULATION + 1, POPULATION), tracker, seed)


def mealpy_cuckoo(tracker, seed):
    """Search by mealpy's cuckoo search."""
    from mealpy import CSA
    _mealpy(CSA.OriginalCSA(tracker.budget // POPULATION + 1, POPULATION), tracker, seed)


def _mealpy(optimizer, tracker, seed):
    from mealpy import FloatVar
    dimension = tracker.joint.dimension
    optimizer.solve({'obj_func': tracker.one, 'minmax': 'min', 'log_to': None,
                     'bounds': FloatVar([0.0] * dimension, [1.0] * dimension)}, seed=seed)


def nevergrad_pso(tracker, seed):
    """Search by nevergrad's PSO."""
    _nevergrad('PSO', tracker, seed)


def nevergrad_ngopt(tracker, seed):
    """Search by the method that nevergrad chooses by itself."""
    _nevergrad('NGOpt', tracker, seed)


def _nevergrad(name, tracker, seed):
    import nevergrad
    box = nevergrad.p.Array(init=np.full(tracker.joint.dimension, 0.5)).set_bounds(0.0, 1.0)
    box.random_state.seed(seed)
    optimizer = nevergrad.optimizers.registry[name](box, budget=tracker.budget)
    optimizer.minimize(tracker.one)


def pycma(tracker, seed):
    """Search by pycma's CMA-ES, restarted until the budget is spent."""
    import cma
    while True:
        seed += 1
        search = cma.CMAEvolutionStrategy(
            tracker.joint.dimension * [0.5], 0.25,
            {'bounds': [0.0, 1.0], 'seed': seed, 'verbose': -9})
        while not search.stop():
            points = search.ask()
            search.tell(points, tracker.many(np.array(points)))


def pymoo_cmaes(tracker, seed):
    """Search by pymoo's CMA-ES."""
    from pymoo.algorithms.soo.nonconvex.cmaes import CMAES
    _pymoo(CMAES(x0=np.full(tracker.joint.dimension, 0.5), sigma=0.25), tracker, seed)


def pymoo_pso(tracker, seed):
    """Search by pymoo's PSO."""
    from pymoo.algorithms.soo.nonconvex.pso import PSO
    _pymoo(PSO(pop_size=POPULATION), tracker, seed)


def pymoo_de(tracker, seed):
    """Search by pymoo's differential evolution."""
    from pymoo.algorithms.soo.nonconvex.de import DE
    _pymoo(DE(pop_size=POPULATION), tracker, seed)


def _pymoo(algorithm, tracker, seed):
    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize

    class Box(Problem):

        def __init__(self):
            super().__init__(n_var=tracker.joint.dimension, n_obj=1, xl=0.0, xu=1.0)

        def _evaluate(self, x, out, *args, **kwargs):
            out['F'] = tracker.many(x)

    minimize(Box(), algorithm, ('n_eval', 2 * tracker.budget), seed=seed, verbose=False)


def scipy_de(tracker, seed):
    """Search by scipy's differential evolution on whole populations, without its polishing."""
    from scipy.optimize import differential_evolution
    dimension = tracker.joint.dimension
    differential_evolution(lambda points: tracker.many(points.T), [(0.0, 1.0)] * dimension,
                           maxiter=tracker.budget, popsize=POPULATION // dimension, tol=0.0,
                           polish=False, rng=seed, vectorized=True, updating='deferred')


PEERS = (
    ('pyswarms PSO', pyswarms_pso),
    ('mealpy PSO', mealpy_pso),
    ('mealpy cuckoo search', mealpy_cuckoo),
    ('nevergrad PSO', nevergrad_pso),
    ('nevergrad NGOpt', nevergrad_ngopt),
    ('pycma CMA-ES', pycma),
    ('pymoo CMA-ES', pymoo_cmaes),
    ('pymoo PSO', pymoo_pso),
    ('pymoo DE', pymoo_de),
    ('scipy differential_evolution', scipy_de),
)
