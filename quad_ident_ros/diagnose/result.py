# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagnosis as typed values, and as the data of the project's JSON (version 2)."""

from dataclasses import asdict, dataclass, field, replace

import numpy as np

from quad_ident_ros import __version__
from quad_ident_ros.closed_loop.compare import ClosedLoop
from quad_ident_ros.diagnose.gap import Ends
from quad_ident_ros.diagnose.provenance import Recorded, Run
from quad_ident_ros.diagnose.residual_wrench import ResidualWrench
from quad_ident_ros.effects.registry import mapping, vector
from quad_ident_ros.greybox.parameters import SPLIT
from quad_ident_ros.model.covariance import Covariance, covariance_to_mapping
from quad_ident_ros.model.residual_function import ResidualFunction
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.schema import lengthened

SCHEMA = 'quad_ident/diagnosis/2'
BLOCKS = 'blocks'
"""Code of the finding that only a single flight has: which blocks of it are held out."""


@dataclass(frozen=True)
class Value:
    """
    A parameter of an effect, with its standard error.

    change: from the value of the vehicle file, where that has the effect, in whichever form.
    """

    value: float
    std: float
    unit: str
    change: float | None = None


@dataclass(frozen=True)
class Ranked:
    """
    An effect as the flights speak of it.

    probability that it is present; form: the law by which it was fitted, and explained: the share
    of its contribution that this law explains, or None; contribution: the share of the closable
    gap that is lost without it, everything else refitted, and without {group: gap} then;
    stability: how steadily it helps; distance: by how many standard errors its parameters together
    differ from no effect; companions: how many others clearly contribute beside it;
    gap_after {group: gap} on the flight held out with this effect alone.
    """

    effect: str
    probability: float
    form: str | None
    explained: float | None
    contribution: float | None
    stability: float | None
    distance: float | None
    companions: int | None
    parameters: dict
    gap_after: dict
    without: dict | None


@dataclass(frozen=True)
class Minor:
    """An effect that is more probable than not and closes less than what is material."""

    effect: str
    probability: float
    contribution: float


@dataclass(frozen=True)
class Channel:
    """
    A body force or moment that the nominal vehicle does not explain.

    share of the gap; regime in which most of it lies, and the share of it that does; band
    (low, high) Hz of half of it; rms, and what noise alone gives, in unit.
    """

    channel: str
    share: float
    regime: str
    share_in_regime: float
    band: tuple
    rms: float
    noise_rms: float
    unit: str


@dataclass(frozen=True)
class Gap:
    """
    The gap on the flight held out, {group: ...} in units.

    before: the nominal vehicle and nothing else; before_own: with the nuisances of the flight
    taken out; after: with the effects named; noise: what a perfect model leaves; closed: the share
    that the effects close of what is above the noise; horizons: the same {seconds: ...}.
    """

    horizon: float
    units: dict
    before: dict
    before_own: dict
    after: dict
    noise: dict
    before_interval: dict
    after_interval: dict
    closed: float
    horizons: dict
    without: dict = field(default_factory=dict)


@dataclass(frozen=True)
class GapGivenAttitude:
    """The gap of position and velocity on the flight held out, given its recorded attitude."""

    horizon: float
    before: dict
    before_own: dict
    after: dict
    noise: dict
    closed: float


@dataclass(frozen=True)
class ShareClosed:
    """
    A gap {group: ...} on the flight held out, and what that closes of one group's.

    closed: the share of what is above the noise, std: its standard error, by the jackknife over
    blocks of time, None where there is but one; group: velocity, or rate where a moment alone is
    added in open loop.
    """

    after: dict
    closed: float
    std: float | None
    group: str


@dataclass(frozen=True)
class Ceiling:
    """
    What any function of state and command closes of the gap on a flight that it has not seen.

    The effects named and a force and moment learnt from the other flights, in full open loop and
    given the recorded attitude. gain {force, moment: standard errors by which what was learnt
    helps beside the effects}; shown: those that count, for they surely help.
    """

    open_loop: ShareClosed
    given_attitude: ShareClosed
    gain: dict
    shown: tuple[str, ...]


@dataclass(frozen=True)
class GapInSimulator:
    """
    The gap of a user's simulator, FILE.py:NAME, on the flight held out, {group: ...}.

    As in Gap, before: the simulator as it is; after: with the effects named around it.
    from_nominal: how far its predictions are from those of the nominal vehicle; where: force and
    moment that the simulator does not explain.
    """

    simulator: str
    horizon: float
    before: dict
    before_own: dict
    after: dict
    noise: dict
    before_interval: dict
    after_interval: dict
    closed: float
    from_nominal: dict
    where: tuple[Channel, ...]


@dataclass(frozen=True)
class Unexplained:
    """What no effect explains: its channel, the regime in which it lies, its size in unit."""

    channel: str
    depends_on: str
    share: float
    band: tuple
    rms: float
    unit: str


@dataclass(frozen=True)
class FlightCheck:
    """How well the verdict's model predicts one flight: {group: gap over that of the noise}."""

    flight: str
    gap_over_noise: dict
    differs: bool


@dataclass(frozen=True)
class Pictures:
    """
    What the pictures of a diagnosis are drawn from.

    t (B,) s at which predictions end; states (B, 13) measured there; before, after: the Ends of
    open-loop predictions; wrenches: the ResidualWrenches of flights, before and after.
    """

    t: np.ndarray
    states: np.ndarray
    before: Ends
    after: Ends
    wrench_before: tuple[ResidualWrench, ...]
    wrench_after: tuple[ResidualWrench, ...]


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """
    The verdict on flights of a vehicle, and what it rests on.

    verdict: what matters, the largest contribution first, or none, unknown, undetermined; minor:
    what is present and does not matter; unknown: where something remains that matters;
    form_unknown: the effect, if any, whose error of form may explain it; z (Z,): the
    parameter vector with the effects named; covariance: how well their parameters are known
    together, with the constants whose deviations the vehicle file states, or None where there are
    none; residual: the function of state and command that reaches the ceiling, None where effects
    do; recorded: the flights as they came; run: the Run of the program, None where a library made
    the diagnosis; form_errors {effect: (G,)}: log-likelihoods of how exact its formula is, see
    Joint.
    """

    vehicle: Vehicle
    verdict: tuple[str, ...]
    minor: tuple[Minor, ...]
    ranking: tuple[Ranked, ...]
    where: tuple[Channel, ...]
    gap: Gap
    gap_given_attitude: GapGivenAttitude
    ceiling: Ceiling
    tolerance: dict
    unknown: tuple[Unexplained, ...]
    form_unknown: tuple[str, ...]
    undetermined: tuple[str, ...]
    sure: tuple[str, ...]
    one_finding: tuple[dict, ...]
    not_shown: tuple[str, ...]
    fly_next: list | None
    nuisances: dict | None
    flights: tuple[str, ...]
    held_out: str
    flight_checks: tuple[FlightCheck, ...]
    findings: tuple
    z: np.ndarray
    pictures: Pictures
    covariance: Covariance | None
    in_simulator: GapInSimulator | None = None
    residual: ResidualFunction | None = None
    closed_loop: ClosedLoop | None = None
    recorded: tuple[Recorded, ...] = ()
    run: Run | None = None
    form_errors: dict[str, np.ndarray] = field(default_factory=dict)

    def effects(self) -> dict:
        """Return {effect: {parameter: value}} of the vehicle, as flights and file have it."""
        return mapping(self.z[SPLIT:])

    def corrected(self, vehicle: Vehicle) -> Vehicle:
        """
        Return the vehicle of the file that flights were held against, with the effects named.

        Of the effects that the file has, those that these flights cannot have shown stay, and
        so does its covariance where these flights estimated nothing.
        """
        given, used = (vector(each.effects, vehicle) for each in (vehicle, self.vehicle))
        return replace(vehicle, name=lengthened(vehicle.name, '_diagnosed'),
                       effects=mapping(np.where(given != used, given, self.z[SPLIT:])),
                       covariance=self.covariance or vehicle.covariance)

    def as_data(self) -> dict:
        """Return the JSON of the project as data."""
        return {
            'schema': SCHEMA, 'version': __version__, 'vehicle': self.vehicle.name,
            'verdict': list(self.verdict),
            'minor': [asdict(one) for one in self.minor],
            'ranking': [asdict(one) for one in self.ranking],
            'where': [asdict(one) for one in self.where],
            'gap': asdict(self.gap), 'gap_given_attitude': asdict(self.gap_given_attitude),
            'ceiling': asdict(self.ceiling), 'tolerance': dict(self.tolerance),
            'unknown': [asdict(one) for one in self.unknown] or None,
            'form_unknown': list(self.form_unknown) or None,
            'undetermined': list(self.undetermined) or None,
            'sure': list(self.sure) if self.undetermined else None,
            'one_finding': [dict(one) for one in self.one_finding],
            'not_shown': list(self.not_shown), 'fly_next': self.fly_next,
            'nuisances': self.nuisances, 'flights': list(self.flights),
            'held_out': self.held_out,
            'flight_checks': [asdict(one) for one in self.flight_checks],
            'findings': list(self.findings),
            'covariance': self.covariance and covariance_to_mapping(self.covariance,
                                                                    len(self.vehicle.rotors)),
            'in_simulator': self.in_simulator and asdict(self.in_simulator),
            'closed_loop': self.closed_loop and asdict(self.closed_loop)}
