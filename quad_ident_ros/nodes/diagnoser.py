# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Node `diagnoser`: says which effects a vehicle has in addition to its nominal description."""

from datetime import datetime, timezone
import json
import sys

from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros.data.outputs import commanded
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.intake import refuse_short
from quad_ident_ros.diagnose.residual_wrench import CHANNELS
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.errors import UNITS
from quad_ident_ros.nodes import process
from quad_ident_ros.nodes.messages import ERROR, OK, table_message, WARN
from quad_ident_ros.nodes.parameters import help_text, ParameterSpec
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.record_worker import RecordWorker, Words
from quad_ident_ros.nodes.remedies import for_a_node
from quad_ident_ros.nodes.stamped import StampedGap
from quad_ident_ros.report.verdict import closed_of, verdict_line
from quad_ident_ros.tolerances import EXAMPLE, rules_from
from quad_ident_ros.vehicle_files.load import load_any_vehicle
from quad_ident_ros.warm_up import warm_up_diagnosis

WORDS = Words('diagnose', 'diagnosis', 'diagnosing', 'diagnosed')
STAGES = ('before', 'after', 'noise')

SPECS = (
    ParameterSpec('vehicle', 'paper_quadrotor', 'Name of a shipped vehicle or path of a vehicle '
                  'file: the nominal one, with the effects that its simulator has.'),
    ParameterSpec('effects', (), 'Effects that may be named; empty: all.',
                  choices=tuple(EFFECTS)),
    ParameterSpec('mode', 'once', 'once: diagnose the first complete experiment, then only on '
                  '~/diagnose; continuous: diagnose each new record by itself.',
                  choices=('once', 'continuous')),
    ParameterSpec('window', 0.0, 'Seconds at the end of a record that are diagnosed, at '
                  f'least {RULES.shortest:g}; 0 takes all.', limits=(0.0, 1e6)),
    ParameterSpec('tolerance', (), 'Gaps beyond the noise that do not matter half a second ahead, '
                  f'each GROUP=VALUE, for example {EXAMPLE}; groups and units: '
                  + ', '.join(f'{name} {unit}' for name, unit in UNITS.items())
                  + '; empty: the usual ones.'),
)

HELP = f"""diagnoser: says which effects a vehicle has in addition to its nominal description.

  ros2 run quad_ident_ros diagnoser --ros-args -p vehicle:=hummingbird
  ros2 topic echo /diagnosis --once --full-length --field data
  ros2 service call /diagnoser/diagnose std_srvs/srv/Trigger

Subscribes: record (std_msgs/Float64MultiArray, latched) of the recorder, which joins pose, twist
and input; of records without rotor speed commands, those that give the input are taken. Outputs
to the motors (PWM, normalised, ...) become speeds by the recorder's mapping and the vehicle.
Of several flights the last one is held out, of a single one half of its blocks of 3 s.
Publishes (latched, but progress and diagnostics):
  diagnosis      std_msgs/String             JSON: verdict, effects with probability, where, gap,
                                             what to fly next
  gap            std_msgs/Float64MultiArray  gap of position, velocity, attitude, rate (m, m/s,
                                             rad, rad/s), 0.5 s ahead, held out: before, after the
                                             effects named, and of noise alone
  where          std_msgs/Float64MultiArray  share of the gap of {', '.join(CHANNELS)}
  gap/<group>    geometry_msgs/Vector3Stamped  of one group: before, after, noise in x, y, z, at
                                             the stamp of the last sample
  where/force, where/moment  geometry_msgs/Vector3Stamped  the shares, with that stamp
  ~/progress     std_msgs/String             JSON: fraction
  /diagnostics   diagnostic_msgs/DiagnosticArray  OK: nothing but noise; WARN: known effects, or
                                             undetermined; ERROR: unknown, or refused
Services (std_srvs/Trigger): ~/diagnose uses the records so far, ~/cancel ends a diagnosis

Parameters (--ros-args -p NAME:=VALUE):
{help_text(SPECS)}"""


class Diagnoser(RecordWorker):
    """Diagnoses the records, or in mode continuous the newest one, and publishes the verdict."""

    def __init__(self, **kwargs):
        super().__init__('diagnoser', SPECS, _validate, WORDS, **kwargs)
        self._json = self.create_publisher(String, 'diagnosis', latched())
        self._gap = self.create_publisher(Float64MultiArray, 'gap', latched())
        self._where = self.create_publisher(Float64MultiArray, 'where', latched())
        self._stamped = StampedGap(self, UNITS)

    def _unfit(self, record):
        if self._continuous:
            try:
                refuse_short(record, RULES)
            except InputError as error:     # the end of a run
                return str(error)
        return None

    def _taken(self):
        return [self._records.newest] if self._continuous else self._records.all()

    def _prepare(self):
        """Return the diagnosis of the records as they are now, or of the newest window."""
        values = self._config.values()
        records = self._taken()

        def run():
            vehicle = load_any_vehicle(values['vehicle'])
            flights = commanded([record.last(values['window']) if values['window'] else record
                                 for record in records], vehicle)
            found = diagnose(flights, vehicle,
                             effects=values['effects'] or None,
                             rules=rules_from(values['tolerance'], 'parameter tolerance'),
                             on_progress=self._job.tell)
            return found, flights

        return run

    def _publish(self, outcome):
        found, flights = outcome
        span = [int(flights[0].info.get('start_ns', 0)),
                int(flights[-1].info.get('start_ns', 0)
                    + round(1e9 * (flights[-1].t[-1] - flights[-1].t[0])))]
        data = {**found.as_data(), 'time': datetime.now(timezone.utc).isoformat(), 'span_ns': span,
                'dropped_samples': sum(flight.info.get('dropped', 0) for flight in flights)}
        self._json.publish(String(data=for_a_node(json.dumps(data))))
        gap = found.gap
        self._gap.publish(table_message([[stage[name] for stage in (gap.before, gap.after,
                                                                    gap.noise)]
                                         for name in gap.units],
                                        ','.join(gap.units), ','.join(STAGES)))
        shares = {row.channel: row.share for row in found.where}
        self._where.publish(table_message([[shares.get(name, 0.0)] for name in CHANNELS],
                                          ','.join(CHANNELS), 'share'))
        self._stamped.publish(span[1], gap, shares)
        self._job.say(1.0)
        verdict = found.verdict
        level = ERROR if 'unknown' in verdict else OK if verdict == ('none',) else WARN
        text = f'verdict: {verdict_line(found)}'
        self._status = (level, text, {
            'verdict': ','.join(verdict), 'closed': gap.closed,
            'dropped_samples': data['dropped_samples'],
            **{f'probability/{row.effect}': row.probability for row in found.ranking}})
        self.get_logger().info(f'{text}; {closed_of(gap)}')


def _validate(values):
    load_any_vehicle(values['vehicle'])
    rules = rules_from(values['tolerance'], 'parameter tolerance')
    if 0.0 < values['window'] < rules.shortest:
        raise InputError(f'parameter window: {values["window"]:g} s are too short for a '
                         f'diagnosis; expected 0 (all) or at least {rules.shortest:g}')


def main(args=None):
    """Run the node; returns the exit code."""
    return process.run(Diagnoser, HELP, args, warm_up=warm_up_diagnosis)


if __name__ == '__main__':
    sys.exit(main())
