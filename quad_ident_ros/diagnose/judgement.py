# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What each effect contributes, which effects matter, and whether something unknown remains."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose.bench import Bench, Model, standard_errors_from_none, tie
from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.gap import Noise
from quad_ident_ros.diagnose.input_errors import answers, gains
from quad_ident_ros.diagnose.noise import noise_of
from quad_ident_ros.diagnose.probability import beside_others, presence, probabilities, Support
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.greybox.errors import ERRORS, GROUPS
from quad_ident_ros.greybox.parameters import NAMES, nominal


@dataclass(frozen=True, eq=False)
class Judgement:
    """
    What was judged of a Selection.

    model: all effects that are present; material: those of them that matter; stand_ins: those that
    would, but have most of their parameters at bounds, or where errors of the commands may have
    put them, in the model or in `essential`, which the elimination left; fitted: the model with
    the gusts of each flight in its vectors, which `model` and `without` leave out; by_commands
    {column: (least, most)}: where errors of the commands alone may have put a parameter; supports
    {candidate: Support} and probability {effect: of being present}; without {candidate: Model
    without it}; before: the Ends of the nominal vehicle with the nuisances of each flight;
    left_out: those of each flight by the fitted model of the
    others; noises: the Noise of each flight, noise: its {group: gap}; remaining: {group: gap
    beyond tolerance}; unexplained: those of them beyond the error of form that the effects named
    may have.
    """

    model: Model
    material: tuple
    stand_ins: tuple
    essential: Model
    fitted: Model
    by_commands: dict[int, tuple[float, float]]
    supports: dict
    probability: dict
    without: dict
    before: tuple
    left_out: tuple
    noises: tuple[Noise, ...]
    noise: list
    remaining: dict
    unexplained: dict

    @property
    def open_groups(self) -> tuple[str, ...]:
        """Return the groups in which something is unexplained, or else remains, if any."""
        return tuple(self.unexplained or self.remaining)


def judge(bench: Bench) -> Judgement:
    """
    Return the Judgement of the best set of a Selection on the flights of a Bench.

    Effects without which nothing that matters is lost are taken out one group after the other;
    those that are present all the same stay in the model.
    """
    best, rules = bench.selection.best, bench.rules
    full = bench.model(best.chosen, best.estimate)
    noises = bench.noises(full)
    noise_gaps = bench.noise_gaps(full, noises)
    before, noise = gaps.gap(_nominal_ends(bench, full)), pooled(noise_gaps)
    model, supports, without = _eliminated(bench, full, before, noise)
    # Where forms gave way to the usual ones, these stand for their effects.
    there = {cause.effect: cause for cause in (*full.effects, *model.effects)}
    supports = {cause: support for cause, support in supports.items()
                if there.get(cause.effect) is cause}
    present = probabilities(bench.selection.posterior, supports, rules)
    absent = tuple(cause for cause in there.values() if present[cause.effect] < rules.present)
    # What errors of the commands may have done names no effect, however much of a gap it closes.
    doubtful = {cause for cause in absent if cause in without
                and _by_instruments(bench, cause, without[cause]) < rules.shown}
    aside = tuple(cause for cause in model.effects if cause in doubtful)
    rest = bench.without(model, aside) if aside else model
    if set(model.effects) <= set(absent) and closes_half(rest.gap, before, noise, rules):
        model = _fewest(bench, rest, before, noise, present)
        absent = tuple(cause for cause in absent if cause not in model.effects)
    material = tuple(cause for cause in model.effects if cause not in absent)
    if set(model.effects) <= set(full.effects):
        improbable = in_any_form(full.effects, absent)
        final = full if not improbable else bench.absent(full, improbable)
    else:
        # Where a form gave way, the best set is no model of them: what is present, but does not
        # matter, comes back beside the forms that there are.
        elsewhere = in_any_form(full.effects, (*model.effects, *absent))
        small = tuple(cause for cause in full.effects if cause not in elsewhere)
        final = bench.beside(model, small, full.z) if small else model
        improbable = in_any_form(final.effects, absent)
        final = bench.absent(final, improbable) if improbable else final
    # What did something only beside effects that are not there does nothing without them.
    while improbable and (gone := _idle(bench, final, material, supports, before, noise)):
        final = bench.absent(final, in_any_form(final.effects, (gone,)))
        material = tuple(cause for cause in material if cause is not gone)
        present[gone.effect] = rules.prior_of(gone.effect)
    held, by_commands = _held(bench, final, model)
    named = in_forms_of(final.effects, material)
    stand_ins = tuple(cause for cause in named if cause.effect in held)
    present |= {cause.effect: rules.prior_of(cause.effect) for cause in stand_ins}
    material = tuple(cause for cause in named if cause not in stand_ins)
    if doubtful:
        # Without an effect that stood for them, more of what remains is by errors of the commands.
        bench = replace(bench, noise=noise_of(final.estimate, bench.flights, bench.vehicle, rules,
                                              bench.noise.command_errors))
        noises = bench.noises(final)
        noise_gaps = bench.noise_gaps(final, noises)
        noise = pooled(noise_gaps)
    fitted, final = final, bench.without_gusts(final)
    without = {cause: bench.without_gusts(one) for cause, one in without.items()}
    ends = _nominal_ends(bench, final)
    return Judgement(final, material, stand_ins, model, fitted, by_commands,
                     _by_form(final, supports), present, _by_form(final, without),
                     ends, bench.left_out(fitted), noises, noise_gaps,
                     remaining(final.gap, noise, rules),
                     unexplained(final.gap, gaps.gap(ends), noise, bool(material), rules))


def _eliminated(bench: Bench, model: Model, before: dict, noise: dict
                ) -> tuple[Model, dict[Candidate, Support], dict[Candidate, Model]]:
    """
    Return a Model less all effects without which nothing that matters is lost.

    Beside it the Support of each effect in the round in which it is most probable, and the Model
    without it of the last round.
    """
    rules = bench.rules
    supports: dict[Candidate, Support] = {}
    without: dict[Candidate, Model] = {}
    while model.effects:
        slopes = bench.slopes(model)
        alone = {cause: bench.without(model, (cause,), slopes) for cause in model.effects}
        without |= alone
        for cause, support in beside_others(
                {cause: _support(model, one, before, noise,
                                 min(bench.distance(model, (cause,)),
                                     _by_instruments(bench, cause, one)), rules)
                 for cause, one in alone.items()}, rules).items():
            # Beside effects that do not matter it may show more clearly, or less.
            supports[cause] = max(supports.get(cause, support), support,
                                  key=lambda each: presence(each, rules))
        # The fewest first: of two that stand in for one another, one may stay.
        smaller = {(cause,): one for cause, one in alone.items()}
        idle = _idle_sets(bench, model, smaller, supports, before, noise)
        if not idle:
            smaller = {removed: bench.without(model, removed, slopes)
                       for removed in _groups(model, rules)}
            idle = _idle_sets(bench, model, smaller, supports, before, noise)
        if not idle:
            break
        # Where either does and their gaps hardly differ, the likelihood decides.
        first = min(idle, key=lambda removed: (len(removed), smaller[removed].estimate.cost))
        model = smaller[first]
    return model, supports, without


def _held(bench: Bench, final: Model, essential: Model) -> tuple[set[str], dict]:
    """
    Return the effects that stand in for something else, and the ranges by errors of the commands.

    What needs values that no vehicle has does the work of something else, in the Model that is
    reported or in that without the effects that do not matter.
    """
    ranges = bench.by_commands(essential)
    held = {cause.effect for cause in essential.effects
            if bench.stands_in(essential, cause, ranges)}
    ranges = bench.by_commands(final) | {column: ends for column, ends in ranges.items()
                                         if NAMES[column].split('.')[0] in held}
    return held | {cause.effect for cause in final.effects
                   if bench.stands_in(final, cause, ranges)}, ranges


def _idle_sets(bench: Bench, model: Model, smaller: Mapping[tuple, Model], supports: dict,
               before: dict, noise: dict) -> list:
    """Return the sets of effects without which a Model, as in {set: Model}, loses nothing."""
    rules = bench.rules
    return [removed for removed, one in smaller.items()
            if not matters(model.gap, one.gap, before, noise, rules,
                           clear({cause: supports[cause] for cause in removed},
                                 bench.distance(model, removed), rules),
                           form_error_beside(model.effects, removed, rules))]


def _by_instruments(bench: Bench, cause: Candidate, without: Model) -> float:
    """
    Return by how many standard errors an effect that answers to commands show differs from none.

    By instruments, where the commands have errors: those by which the answer of the Model without
    it differs from the vehicle's. inf for other effects, and where the commands show no errors.
    """
    told = (answers(without.estimate, bench.flights, bench.vehicle, bench.rules)
            if gains(list(cause.columns)) and bench.noise.command_errors else None)
    return np.inf if told is None else standard_errors_from_none(
        told.gain - 1.0, np.diag(told.error ** 2))


def _by_form(model: Model, values: dict) -> dict:
    """Return {candidate: value} by the candidates of a Model, which may have other forms."""
    return dict(zip(in_forms_of(model.effects, values), values.values(), strict=True))


def _idle(bench: Bench, model: Model, causes: tuple, supports: dict, before: dict, noise: dict
          ) -> Candidate | None:
    """Return the least likely one of some effects that do not matter in a Model, if any."""
    slopes, rules, costs = bench.slopes(model), bench.rules, {}
    for cause, here in zip(causes, in_forms_of(model.effects, causes), strict=True):
        without = bench.without(model, (here,), slopes)
        apart = clear({cause: supports[cause]}, bench.distance(model, (here,)), rules)
        if not matters(model.gap, without.gap, before, noise, rules, apart,
                       form_error_beside(model.effects, (here,), rules)):
            costs[cause] = without.estimate.cost
    return min(costs, key=lambda cause: costs[cause], default=None)


def in_forms_of(effects: Iterable[Candidate], causes: Iterable[Candidate]
                ) -> tuple[Candidate, ...]:
    """
    Return causes in the forms that some effects have, and as they are where these have them not.

    A form may leave its bounds once another effect is taken out; the usual one takes its place.
    """
    there = {cause.effect: cause for cause in effects}
    return tuple(there.get(cause.effect, cause) for cause in causes)


def in_any_form(effects: Iterable[Candidate], causes: Iterable[Candidate]
                ) -> tuple[Candidate, ...]:
    """Return those of some effects that are among causes, in whichever form these have them."""
    names = {cause.effect for cause in causes}
    return tuple(cause for cause in effects if cause.effect in names)


def _nominal_ends(bench: Bench, model: Model) -> tuple:
    """Return the Ends of the nominal vehicle with the nuisances of each flight in a Model."""
    null = nominal(bench.vehicle)
    return bench.ends(tuple(null + vector - model.z for vector in model.vectors))


def _support(model: Model, without: Model, before: dict, noise: dict, distance: float,
             rules: Rules) -> Support:
    """Return the Support of what a Model has more than another, so far from no effect."""
    shares = lost_shares(model.gap, without.gap, before, noise, rules)
    explained = {name: explained_share(model.gap[name], without.gap[name], noise[name],
                                       rules.least(name, noise[name])) for name in shares}
    # Where it does most: a small share of one group may be all that is explained in another.
    name = max(shares, key=lambda group: shares[group] * explained[group])
    return Support(max(shares.values()), stability(model.ends, without.ends, noise, rules),
                   explained[name], without.gap, distance)


def explained_share(after: float, without: float, noise: float, least: float) -> float:
    """Return the share of the gap without an effect that it explains, by gaps of a group."""
    there = beyond(without, noise)
    return float(np.clip((there - beyond(after, noise)) / max(there, least), 0.0, 1.0))


def pooled(gap: list) -> dict:
    """Return {group: root mean square} of the gaps {group: ...} of flights."""
    return {name: float(np.sqrt(np.mean([one[name] ** 2 for one in gap]))) for name in gap[0]}


def stability(with_it: tuple, without: tuple, noise: dict, rules: Rules) -> float:
    """
    Return how steadily an effect helps: what it saves per block of time over its standard error.

    The statistic of Vuong (Econometrica 57, 1989) for two models, over blocks of all flights,
    the one held out among them. Squared errors count in units of what remains.
    Args: the Ends of all flights with and without the effect; noise {group: gap}.
    """
    scale = np.empty(ERRORS)
    for name, gap in gaps.gap(with_it).items():
        scale[GROUPS[name]] = max(gap, noise[name])
    blocks = []
    for one, other in zip(with_it, without, strict=True):
        change = np.sum((other.errors ** 2 - one.errors ** 2) / scale ** 2, axis=1)
        block = np.unique((one.t // rules.steady_block).astype(int), return_inverse=True)[1]
        blocks.append(np.bincount(block, change))
    saved = np.concatenate(blocks)
    return in_standard_errors(saved)


def in_standard_errors(sums: np.ndarray) -> float:
    """Return the total of sums over blocks of time, (K,), over its standard error; 0 of one."""
    if len(sums) < 2:
        return 0.0
    return float(np.sum(sums) / max(np.std(sums) * np.sqrt(len(sums)), 1e-300))


def lost_shares(after: dict, without: dict, before: dict, noise: dict, rules: Rules) -> dict:
    """
    Return {group: share of the closable gap that is lost}.

    Args: {group: gap} with all effects, without some, of the nominal vehicle, of the noise.
    """
    return {name: float(without[name] - after[name]) / max(
        before[name] - min(noise[name], after[name]), rules.least(name, noise[name]))
        for name in after}


def matters(after: dict, without: dict, before: dict, noise: dict, rules: Rules,
            apart: bool = False, form_error: float | None = None) -> bool:
    """
    Return whether effects matter, by the gap with and without them.

    In some group of outputs the share that is lost without them is material, beside the floors of
    the tolerance, too, and more than the error of form of the other effects may be, unless it is
    known apart from these. form_error: relative, of the others; usual where it is None.
    """
    wrong = rules.form_error if form_error is None else form_error
    shares = lost_shares(after, without, before, noise, rules)
    return any(share >= rules.material
               and without[name] - after[name] >= rules.lost * rules.floors[name]
               and (apart or beyond(without[name], after[name])
                    >= wrong * beyond(before[name], without[name]))
               for name, share in shares.items())


def form_error_beside(effects: Iterable[Candidate], removed: Collection[Candidate], rules: Rules
                      ) -> float:
    """Return the largest relative error of form of the effects that are not removed."""
    return max((rules.form_error_of(cause.effect) for cause in effects if cause not in removed),
               default=rules.form_error)


def closes_half(after: dict, before: dict, noise: dict, rules: Rules) -> bool:
    """
    Return whether a model closes half of the gap of some group of outputs.

    What does is named, though each of its effects may be less probable than not: `unknown` in its
    place would say less than the flights do. A gap within the tolerance does not count: nothing
    would be unknown.
    """
    shares = lost_shares(after, before, before, noise, rules)
    return any(shares[name] >= rules.half for name in remaining(before, noise, rules))


def _fewest(bench: Bench, model: Model, before: dict, noise: dict, present: dict) -> Model:
    """
    Return the Model with the fewest effects that closes half of the gap of some group, too.

    Of as many effects, those that are most probable together; args: present {effect: probability}.
    """
    slopes = bench.slopes(model)
    for size in range(1, len(model.effects)):
        fewer = [bench.without(model, removed, slopes)
                 for removed in combinations(model.effects, len(model.effects) - size)]
        fewer = [one for one in fewer if closes_half(one.gap, before, noise, bench.rules)]
        if fewer:
            return max(fewer, key=lambda one: sum(present[cause.effect]
                                                  for cause in one.effects))
    return model


def clear(supports: dict[Candidate, Support], distance: float, rules: Rules) -> bool:
    """
    Return whether effects, at least one of them probable, together clearly differ from none.

    How much of the gap the errors of form of others may be is then no matter: the standard errors
    have these in them. Effects that cancel one another are together near none.
    """
    return distance >= rules.shown and any(
        presence(support, rules, rules.shift(cause.effect)) >= rules.present
        for cause, support in supports.items())


def remaining(gap: dict, noise: dict, rules: Rules) -> dict:
    """Return {group: gap} of what remains beyond the noise, where it is over the tolerance."""
    found = {name: beyond(gap[name], noise[name]) for name in gap}
    return {name: remains for name, remains in found.items()
            if remains > rules.tolerance(name, noise[name])}


def unexplained(gap: dict, before: dict, noise: dict, named: bool, rules: Rules) -> dict:
    """
    Return {group: gap} of what remains beyond the noise, where that matters.

    It matters where it is more than the tolerance, and more than the error of form of the effects
    that are named, if any, may be.
    """
    return {name: remains for name, remains in remaining(gap, noise, rules).items()
            if not named or remains > rules.unexplained * beyond(before[name], gap[name])}


def beyond(gap: float, noise: float) -> float:
    """Return what makes a gap together with an independent other one."""
    return float(np.sqrt(max(0.0, gap ** 2 - noise ** 2)))


def _groups(model: Model, rules: Rules) -> list:
    """Return the effects that are taken out together: those that may cancel."""
    effects = model.effects
    scaling = [cause for cause in effects if EFFECTS[cause.effect].scale_group]
    groups = [tuple(group) for size in range(2, len(scaling) + 1)
              for group in combinations(scaling, size)]
    pairs = [pair for pair in combinations(effects, 2)
             if pair not in groups and tie(model.estimate, *pair) > rules.tied]
    return [*groups, *pairs]
