# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Node `identifier`: fits K/((s+a)(s+b)) to the records of the recorder."""

from dataclasses import replace
from datetime import datetime, timezone
import json
import sys

import numpy as np
from std_msgs.msg import Bool, Float64MultiArray, String

from quad_ident_ros.data.commands import with_inputs
from quad_ident_ros.data.info import LARGEST
from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.levy import LEAST, levy_sigma
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.online import Tracker
from quad_ident_ros.identify.result import as_data, error_table, parameter_table
from quad_ident_ros.identify.search import SwarmSettings
from quad_ident_ros.identify.signals import FEWEST, OUTPUTS
from quad_ident_ros.identify.vp import COMPLEX_PENALTY
from quad_ident_ros.nodes import process
from quad_ident_ros.nodes.messages import OK, parameter_message, WARN
from quad_ident_ros.nodes.parameters import help_text, ParameterSpec
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.record_worker import RecordWorker, Words
from quad_ident_ros.nodes.stamped import StampedParameters
from quad_ident_ros.vehicle_files.load import load_any_vehicle
from quad_ident_ros.warm_up import warm_up

WORDS = Words('identify', 'fit', 'fitting', 'fitted')
NEWS = 10.0             # s between two lines of log on results without a change

_SWARM = SwarmSettings()
SPECS = (
    ParameterSpec('method', 'all', 'Method to run.', choices=('all', *METHODS)),
    ParameterSpec('mode', 'once', 'once: fit the first complete experiment, then only on '
                  '~/identify; continuous: fit each new record.', choices=('once', 'continuous')),
    ParameterSpec('seed', 0, 'Seed of the searches.', limits=(0, 2 ** 31)),
    ParameterSpec('window', 0.0, 'Seconds at the end of a record that are fitted; 0 takes all.',
                  limits=(0.0, 1e6)),
    ParameterSpec('pole_bounds', [], 'Lower and upper bound of a and b, 1/s; empty: from the '
                  'data.', limits=(-LARGEST, LARGEST), length=(0, 2)),
    ParameterSpec('gain_bounds', [], 'Lower and upper bound of K; empty: from the data.',
                  limits=(-LARGEST, LARGEST), length=(0, 2)),
    ParameterSpec('poles', 'auto', 'Complex pairs: never (real), if they reduce the error by more '
                  'than noise does (auto), or if they are better at all (any).',
                  choices=tuple(COMPLEX_PENALTY)),
    ParameterSpec('search', 'per_output', "per_output solves for K; joint is the paper's literal "
                  '12-dimensional search.', choices=('per_output', 'joint')),
    ParameterSpec('box', 'scaled', 'Read the box [0, 200] as scaled coordinates or literally.',
                  choices=('scaled', 'literal')),
    ParameterSpec('initial_state', 'auto', 'State at the start of a record: rest, free '
                  '(estimated) or auto (rest where the record says so).',
                  choices=('auto', 'rest', 'free')),
    ParameterSpec('vehicle', '', 'Name or file of the vehicle whose arm length makes U2 and U3 of '
                  'moments, for records that do not say it (empty: these have no roll and pitch), '
                  'and whose limits show where rotors saturate.'),
    ParameterSpec('trim', [], 'U1..U4 from which inputs count; empty: what the record says, or '
                  'its first sample.', limits=(-LARGEST, LARGEST), length=(0, 4)),
    ParameterSpec('evaluations', 0, 'Evaluations of the objective per search, the same for each '
                  'method; 0 goes by generations.', limits=(0, 100_000_000)),
    ParameterSpec('population', _SWARM.population, 'Particles or nests, N.', limits=(2, 100_000)),
    ParameterSpec('generations', _SWARM.generations, 'Generations.', limits=(1, 1_000_000)),
    ParameterSpec('w', _SWARM.inertia, 'Inertia weight of PSO.', limits=(0.0, 2.0)),
    ParameterSpec('c1', _SWARM.c1, 'Largest pull towards the own best.', limits=(0.0, 10.0)),
    ParameterSpec('c2', _SWARM.c2, 'Largest pull towards the common best.', limits=(0.0, 10.0)),
    ParameterSpec('pa', _SWARM.abandon, 'Probability that an egg is discovered.',
                  limits=(0.0, 1.0)),
    ParameterSpec('alpha', _SWARM.alpha, 'Step size of the Levy flights.', limits=(0.0, 1000.0)),
    ParameterSpec('alpha_units', _SWARM.alpha_units, 'Alpha in coordinates of the box (raw) or '
                  'as a share of it (range).', choices=('raw', 'range')),
    ParameterSpec('lambda', _SWARM.levy_lambda, 'Exponent of the Levy flights, below 2.',
                  limits=(LEAST, 2.0)),
    ParameterSpec('replacement', _SWARM.replacement, 'Discovery of eggs: standard or eq. (28) as '
                  'printed.', choices=('standard', 'printed')),
    ParameterSpec('levy', _SWARM.levy, 'Eq. (26) as Mantegna has it or as printed.',
                  choices=('mantegna', 'printed')),
)

HELP = f"""identifier: fits K/((s+a)(s+b)) to the records of the recorder.

  ros2 run quad_ident_ros identifier --ros-args -p method:=pso_cs -p seed:=1
  ros2 topic echo /parameters --once
  ros2 service call /identifier/identify std_srvs/srv/Trigger

Subscribes: record (std_msgs/Float64MultiArray, latched)
Publishes (latched, but progress and diagnostics):
  parameters           std_msgs/Float64MultiArray  K, a, b of phi, theta, psi, z: best method
  parameters/<method>  std_msgs/Float64MultiArray  the same of one method ({', '.join(METHODS)})
  standard_errors      std_msgs/Float64MultiArray  their standard errors
  changed              std_msgs/Bool               mode continuous: the vehicle changed
  change               diagnostic_msgs/DiagnosticArray  each change: when, which output, what was
                                                   before and after; 10 deep
  outputs/<output>     geometry_msgs/Vector3Stamped  K, a, b in x, y, z, best method, stamped as
                       the last sample; outputs/<output>/standard_errors their errors
  parameters_json      std_msgs/String             everything: units, standard errors, metrics, ...
  ~/progress           std_msgs/String             JSON: method, output, fraction
  /diagnostics         diagnostic_msgs/DiagnosticArray
Not a number stands for an output that was not excited, and for a, b of a complex pair.
Services (std_srvs/Trigger): ~/identify fits the records so far, ~/cancel ends a fit

Parameters (--ros-args -p NAME:=VALUE):
{help_text(SPECS)}"""


class Identifier(RecordWorker):
    """Fits the records together, and publishes what each method found."""

    def __init__(self, **kwargs):
        super().__init__('identifier', SPECS, _settings, WORDS, **kwargs)
        self._best = self.create_publisher(Float64MultiArray, 'parameters', latched())
        self._each = {name: self.create_publisher(Float64MultiArray, f'parameters/{name}',
                                                  latched()) for name in METHODS}
        self._errors = self.create_publisher(Float64MultiArray, 'standard_errors', latched())
        self._changed = self.create_publisher(Bool, 'changed', latched())
        self._json = self.create_publisher(String, 'parameters_json', latched())
        self._stamped = StampedParameters(self)
        self._tracker = Tracker()

    def _unfit(self, record):
        if len(record) < FEWEST:
            return (f'a record of {len(record)} samples is ignored: at least {FEWEST} are needed')
        return None

    def _on_session(self):
        self._tracker = Tracker()

    def _prepare(self):
        """Return the fit of the records as they are now."""
        values = self._config.values()
        run = self._tracker.update if self._continuous else identify
        given, window = self._taken(), values['window']

        def fit():
            # In here an error, such as that of a vehicle file that is gone by now, ends no node.
            records, settings = given, _settings(values)
            order = list(settings.methods)
            if values['vehicle']:
                vehicle = load_any_vehicle(values['vehicle'])
                records = [with_inputs(record, vehicle) for record in records]

            def on_progress(method, output, share):
                done = ((OUTPUTS.index(output) + share) / len(OUTPUTS) if output in OUTPUTS
                        else share)
                self._job.tell((order.index(method) + done) / len(order), method=method,
                               output=output)

            result = run([record.last(window) if window else record for record in records],
                         settings, on_progress=on_progress)
            return replace(result, settings={**result.settings, 'window': window,
                                             'mode': values['mode']})

        return fit

    def _publish(self, result):
        for name, publisher in self._each.items():
            # A method that was not run says so, instead of leaving an older result latched.
            fit = result.methods.get(name)
            table = np.full((4, 3), np.nan) if fit is None else parameter_table(fit)
            publisher.publish(parameter_message(table))
        best = result.methods[result.best]
        self._best.publish(parameter_message(parameter_table(best)))
        self._errors.publish(parameter_message(error_table(best)))
        self._stamped.publish(result)
        self._changed.publish(Bool(data=bool(result.changes)))
        data = {**as_data(result), 'time': datetime.now(timezone.utc).isoformat()}
        self._json.publish(String(data=json.dumps(data)))
        self._job.say(1.0, method=result.best, output='')
        missing = [name for name in OUTPUTS if name not in best.outputs]
        notes = [f'{name}: {fit.model.form}' for name, fit in best.outputs.items()
                 if fit.model is not None and fit.model.form == 'complex']
        text = f'best method {result.best}, cost {best.cost:.3g}'
        if missing:
            text += f'; not excited: {", ".join(missing)}'
        if notes:
            text += f'; complex poles, so a and b are not published: {", ".join(notes)}'
        beyond = {name: one.why for name, one in result.validity.items() if one.holds is False}
        if beyond:
            text += f'; the linear model does not hold: {", ".join(beyond)}'
        for change in result.changes:
            moved = ', '.join(f'{name} {values[0]:.4g} -> {values[1]:.4g}'
                              for name, values in change.moved.items())
            text += f'; {change.output} changed at {change.stamp_ns * 1e-9:.2f} s: {moved}'
            self.get_logger().warning(text)
        self._status = (WARN if missing or notes or result.changes or beyond
                        or data['dropped_samples'] else OK, text,
                        {'best': result.best, 'cost': best.cost,
                         'dropped_samples': data['dropped_samples'],
                         **{f'linear_model/{name}': why for name, why in beyond.items()},
                         **{f'fit_percent/{name}': fit.errors['fit_percent']
                            for name, fit in best.outputs.items()}})
        if self._config['mode'] == 'once':
            self.get_logger().info(text)
        elif not result.changes:
            self.get_logger().info(text, throttle_duration_sec=NEWS)


def _settings(values):
    """Return the Settings that parameter values stand for; raises InputError."""
    levy_sigma(values['lambda'])
    if values['vehicle']:
        load_any_vehicle(values['vehicle'])
    swarm = SwarmSettings(
        population=values['population'], generations=values['generations'],
        evaluations=values['evaluations'] or None, inertia=values['w'], c1=values['c1'],
        c2=values['c2'], abandon=values['pa'], alpha=values['alpha'],
        alpha_units=values['alpha_units'], levy_lambda=values['lambda'],
        replacement=values['replacement'], levy=values['levy'])
    for name in ('pole_bounds', 'gain_bounds'):
        bounds = values[name]
        if len(bounds) == 2 and not bounds[0] < bounds[1]:
            raise InputError(f'parameter {name}: the lower bound must be below the upper, got '
                             f'{list(bounds)}')
    method = values['method']
    return Settings(
        methods=tuple(METHODS) if method == 'all' else (method,), seed=values['seed'],
        swarm=swarm, search=values['search'], box=values['box'], poles=values['poles'],
        pole_bounds=tuple(values['pole_bounds']) or None,
        gain_bounds=tuple(values['gain_bounds']) or None,
        initial_state=values['initial_state'], trim=tuple(values['trim']) or None)


def main(args=None):
    """Run the node; returns the exit code."""
    return process.run(Identifier, HELP, args, warm_up=warm_up)


if __name__ == '__main__':
    sys.exit(main())
