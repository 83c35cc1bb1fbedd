# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Every threshold of a verdict, with its reason; docs/method.md shows where each acts."""

from dataclasses import dataclass, field
from math import exp

from quad_ident_ros.diagnose.priors import EffectPrior, log_odds


@dataclass(frozen=True)
class Rules:
    """
    The thresholds of a verdict.

    Intake:
      shortest: s of a flight. Half of a single one is held out: four rollouts of half a second
        for each half; whether that suffices is a matter of information, see `not_shown`.
      held_block: s of a block of a single flight, of which half are held out: room for a few
        rollouts, and longer than the errors of a formula are correlated.
      follows: share of the spread of measured rotor speeds that the commands must explain for the
        speeds to say anything about the motors: with less, most of it comes from something else.
    Candidates:
      voltage: V that a recorded voltage must change for it to say anything about the battery: what
        the coarsest loggers resolve. at_bound: usual sizes from a bound that are at it.
    Noise:
      coloured: times that all that is left may be the noise from sample to sample, or a part of
        it, before it takes its place as the weight: errors are then autocorrelated.
      levelling: rad, the usual error of the level of an attitude that accelerometer and GPS
        correct; autopilots' filters are good to half a degree to two. It does not show in their
        states. drift: m/s, that of the velocity of such a filter, which stays over a prediction.
        filtered_attitude: rad from sample to sample, below which an attitude is that of
        a filter; tracked_position: m, above which its position is not from motion capture.
        quiet_gyro: rad/s from sample to sample, below which a rate is no gyro's but a
        simulation's: the best ones of autopilots have 0.003 deg/s/Hz^0.5 over 50 Hz.
      tracked_level: rad, the usual error of the level of a filter's attitude that tracking
        corrects: what motion capture makes of a body. sensitivity: tolerance of the sensitivity of
        a gyro, as a share.
      low_pass: s by which the low pass of a gyro makes a rate late, and the attitude that a filter
        has from it: 5.9 ms for that of 41 Hz in an MPU-9250.
      walk_lags: s, which separate the growth of errors of velocity and rate from their noise:
        gyros are filtered at 20 Hz and more, effects take half a second; what the filter of a
        velocity remembers for longer is bounded by its deviation.
    Prior:
      prior_probability: of each effect, before looking. One to three of some seventeen are
        there in vehicles that are looked at; less, for the many that may be named by chance
        (multiplicity: Scott and Berger, Annals of Statistics 38, 2010).
      usual_form: share of that which the usual form of an effect has where there are others: an
        effect is not more probable for having more laws.
      prior_width: usual sizes of a parameter that are one standard deviation of its prior about
        no effect: wide enough for the largest that is flown.
      alike: log evidence within which sets are about as good, so that the smallest is taken and a
        rival is not ruled out: a Bayes factor under 20 is not strong (Kass and Raftery, JASA 90,
        1995).
      worth: share of the cost that forms with more parameters must save over others of the same
        effects: a form that is wrong by 10 % of what an effect does leaves that much of a gap ten
        times the noise.
      untried: log evidence, beside the best set, that the linear model alone may give a set: it
        has been wrong by more.
      priors: what a fleet knows of each effect instead, by name; without one: nothing.
      forms_seen: times that a form is rarer which a fleet of many vehicles never named: what
        ten vehicles without it say (Laplace's rule of succession). fleet_width, fleet_least:
        the prior's width is so many times what a fleet has of an effect, since its next vehicle
        may have more, and at least that share of the usual width, since its others were few.
      usual_presence: share of the vehicles that an effect is present in, from which that of a
        fleet differs: one to three of some seventeen in the flights of `calibration`.
    Discrepancy (see discrepancy.py):
      form_error: relative error of an effect's formula. Published laws of one effect differ from
        one another by 10 to 30 % over the range in which they are used. A fleet may know better.
      form_time: s over which that error stays the same: that of a turn or a stop of a flight.
    Vehicle file:
      constant_error: how far a constant is usually off whose file states no deviation, as a share:
        a pendulum, a ruler and a thrust stand leave some percent open. Mass and thrust do not
        count: motion shows the other constants only in proportion to them. drag_error: that of
        a drag: published ones of one vehicle differ by some tens of percent.
    Probability:
      calibration: constant, and weights of the share that the form explains, of the logarithm of
        one plus the standard errors from no effect, of that logarithm times one minus the size
        relative to the greatest effect, and of the companions, in the log odds of being present,
        fitted to the flights of development of the withheld check. With the constant, an effect
        that explains all that there is, two standard errors from none, is as probable as not:
        docs/method.md has the command.
      companion: contribution and stability (standard errors) from which on another effect clearly
        contributes.
    Gap (see gap.py):
      horizon: s ahead at which predictions are judged: the length of the rollouts that are fitted.
        near_horizon: that of inertial flights: what the air does is not modelled there, and soon
        turns the vehicle elsewhere.
      steady_block: s of a flight over which errors may be correlated, as for the scatter of the
        cost. What helps in most of such blocks helps steadily.
    Naming:
      present: probability from which on an effect is named: more likely there than not.
      half: share of the closable gap from which on the effects that matter are named although each
        of them is less probable than that, if nothing else is: most of it has their cause.
      instead: how many times the odds of a rival must be greater without an effect than with it.
      material: share of the closable gap that an effect must close to be in the verdict: less is
        below what a change of the weather or of a battery does.
      lost: share of the floor of the tolerance that must be lost, too: as much as a material share
        of `smallest` is, so that it only counts where a user has set wider floors.
      stand_in: share of its parameters that clearly differ from none beyond which, at bounds or
        not told for errors of the commands, an effect does the work of something else: one at a
        bound may be one that the flights do not show.
      tied: correlation of two effects' parameters from which on they are taken out together, too.
    Advice:
      hidden, shown: standard errors from no effect below which an effect of usual size is not
        seen, and from which on it is, so is a parameter that shapes a form, and what differs from
        none is no error of the form of others. Noise needs no proof: that of forces and moments
        between the samples counts from `hidden` on. Measured rotor speeds rule a lag or a delay
        out by `shown`, by as much commands show errors, and what remains has to come and go with
        an effect to be an error of its form.
      told_by: rollouts from which on errors of the commands are looked for: chance makes three
        standard errors in 0.3 % of draws of twenty, in 6 % of three.
    Tolerance (a gap that matters, by group of outputs, at 0.5 s):
      visible: of the noise's gap: of what can be closed below it, shares mean nothing.
      noise_share: of the noise's gap: what remains below it is hard to see in a prediction, and
        the noise itself is known to some ten percent only where it has a memory.
      floors: m, m/s, rad, rad/s that no user of a simulation at 0.5 s minds. The attitude is that
        by which gravity makes the velocity, as it grows with the square of the time: 3 v / (g t),
        and the rate that by which it then grows, 2 / t of it.
      smallest: half of the usual floors: of what can be closed below it, shares mean nothing,
        whatever the tolerance of the user. Presence does not depend on it.
    Where:
      regime: of the energy of a residual that a half-space must have beyond its share of the time
        to be named: for less, `everywhere` is the better word.
    Unknown:
      differs: times the gap that remains in the other flights from which on one flight differs.
      unexplained: share of the gap that the named effects close which may remain as error of
        their form before something unknown is named: effects that close half of a gap leave
        1 / sqrt(3) of what they close.
    """

    shortest: float = 4.0
    held_block: float = 3.0
    follows: float = 0.5
    voltage: float = 0.02
    at_bound: float = 1e-2
    coloured: float = 2.0
    levelling: float = 0.015
    tracked_level: float = 0.003
    drift: float = 0.05
    filtered_attitude: float = 5e-4
    tracked_position: float = 1e-3
    quiet_gyro: float = 3e-4
    low_pass: float = 0.006
    sensitivity: float = 0.01
    walk_lags: tuple[float, float, float] = (0.02, 0.05, 0.1)
    prior_probability: float = 0.02
    usual_form: float = 0.5
    prior_width: float = 3.0
    alike: float = 3.0
    worth: float = 0.01
    untried: float = -2.0
    priors: dict[str, EffectPrior] = field(default_factory=dict)
    forms_seen: float = 10.0
    fleet_width: float = 2.0
    fleet_least: float = 0.1
    usual_presence: float = 0.1
    form_error: float = 0.2
    form_time: float = 1.0
    constant_error: float = 0.05
    drag_error: float = 0.2
    horizon: float = 0.5
    near_horizon: float = 0.1
    steady_block: float = 2.0
    present: float = 0.5
    half: float = 0.5
    instead: float = 2.0
    calibration: tuple[float, float, float, float, float] = (-3.86, 1.85, 1.83, -1.19, 0.343)
    companion: tuple[float, float] = (0.1, 3.0)
    stand_in: float = 0.5
    tied: float = 0.9
    hidden: float = 1.0
    shown: float = 3.0
    told_by: int = 20
    material: float = 0.05
    lost: float = 0.025
    visible: float = 0.25
    noise_share: float = 0.75
    floors: dict = field(default_factory=lambda: {
        'position': 0.01, 'velocity': 0.02, 'attitude': 0.012, 'rate': 0.05})
    smallest: dict[str, float] = field(default_factory=lambda: {
        'position': 0.005, 'velocity': 0.01, 'attitude': 0.006, 'rate': 0.025})
    regime: float = 0.35
    unexplained: float = 0.58
    differs: float = 2.0

    @property
    def doubt(self) -> float:
        """
        Return the probability from which on a rival of what is named is not ruled out.

        What has one minus that, or more, is sure.
        """
        return 1.0 / (1.0 + exp(self.alike))

    def shift(self, effect: str) -> float:
        """Return by how much a fleet raises the log odds that an effect is present."""
        known = self.priors.get(effect)
        return 0.0 if known is None else log_odds(known.present) - log_odds(self.usual_presence)

    def prior_of(self, effect: str) -> float:
        """Return the probability that an effect is present, before looking."""
        if effect not in self.priors:
            return self.prior_probability
        return 1.0 / (1.0 + exp(-log_odds(self.prior_probability) - self.shift(effect)))

    def form_error_of(self, effect: str | None) -> float:
        """
        Return the relative error of the formula of an effect, or of a nuisance (None).

        That of a fleet where it is smaller: what else is wrong with flights looks like a larger
        one, above all beside weak effects.
        """
        known = None if effect is None else self.priors.get(effect)
        if known is None or known.form_error is None:
            return self.form_error
        return min(known.form_error, self.form_error)

    def least(self, group: str, noise: float) -> float:
        """Return the gap of a group of outputs below which shares of it mean nothing."""
        return max(self.visible * noise, self.smallest[group])

    def tolerance(self, group: str, noise: float) -> float:
        """Return the gap of a group of outputs that does not matter, beside its noise's gap."""
        return max(self.noise_share * noise, self.floors[group])


RULES = Rules()
