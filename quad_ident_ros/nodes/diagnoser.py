# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Node `diagnoser`: says what a vehicle has and its nominal description lacks."""

from datetime import datetime, timezone
import json
import sys

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray, String
from std_srvs.srv import Trigger

from quad_ident_ros.data.quality import refuse_unfit
from quad_ident_ros.data.table import record_from_table
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.length import refuse_short, SHORTEST
from quad_ident_ros.diagnose.where import CHANNELS
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.mixing import with_commands
from quad_ident_ros.model.vehicle import load_nominal
from quad_ident_ros.nodes import process
from quad_ident_ros.nodes.job import Job
from quad_ident_ros.nodes.messages import diagnostics_message, ERROR, OK, table_message, WARN
from quad_ident_ros.nodes.parameters import help_text, NodeParameters, ParameterSpec
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.records import Records
from quad_ident_ros.report.diagnosis import verdict_line
from quad_ident_ros.warm_up import warm_up_diagnosis

STAGES = ('before', 'after', 'noise')

SPECS = (
    ParameterSpec('vehicle', 'paper_quadrotor', 'Name of a shipped vehicle or path of a vehicle '
                  'file: the nominal one, without effects.'),
    ParameterSpec('effects', (), 'Effects that may be found; empty: all.',
                  choices=tuple(EFFECTS)),
    ParameterSpec('mode', 'once', 'once: diagnose the first complete experiment, then only on '
                  '~/diagnose; continuous: diagnose each new record by itself.',
                  choices=('once', 'continuous')),
    ParameterSpec('window', 0.0, 'Seconds at the end of a record that are diagnosed, at '
                  f'least {SHORTEST:g}; 0 takes all.', limits=(0.0, 1e6)),
)

HELP = f"""diagnoser: says what a vehicle has and its nominal description lacks.

  ros2 run quad_ident_ros diagnoser --ros-args -p vehicle:=hummingbird
  ros2 topic echo /diagnosis --once
  ros2 service call /diagnoser/diagnose std_srvs/srv/Trigger

Subscribes: record (std_msgs/Float64MultiArray, latched) of the recorder, which joins pose, twist
and input; of records without rotor speed commands, those that give the input are taken.
Of several flights the last one is held out, of a single one its second half.
Publishes (latched, but progress and diagnostics):
  diagnosis      std_msgs/String             JSON: verdict, effects with probability, where, gap,
                                             what to fly next
  gap            std_msgs/Float64MultiArray  gap of position, velocity, attitude, rate (m, m/s,
                                             rad, rad/s), 0.5 s ahead, held out: before, after the
                                             effects found, and of noise alone
  where          std_msgs/Float64MultiArray  share of the gap of {', '.join(CHANNELS)}
  ~/progress     std_msgs/String             JSON: fraction
  /diagnostics   diagnostic_msgs/DiagnosticArray  OK: nothing but noise; WARN: known effects, or
                                             undetermined; ERROR: unknown, or refused
Services (std_srvs/Trigger): ~/diagnose diagnoses what is there, ~/cancel ends a diagnosis

Parameters (--ros-args -p NAME:=VALUE):
{help_text(SPECS)}"""


class Diagnoser(Node):
    """Diagnoses records in a thread of its own, so that the executor stays free."""

    def __init__(self, **kwargs):
        super().__init__('diagnoser', **kwargs)
        self._config = NodeParameters(self, SPECS, _validate)
        self._json = self.create_publisher(String, 'diagnosis', latched())
        self._gap = self.create_publisher(Float64MultiArray, 'gap', latched())
        self._where = self.create_publisher(Float64MultiArray, 'where', latched())
        self._diagnostics = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        self.create_service(Trigger, '~/diagnose', self._on_diagnose)
        self.create_service(Trigger, '~/cancel', self._on_cancel)
        self._records = Records()
        self._diagnosed_once = False
        self._status = (OK, 'waiting for a record', {})
        self._job = Job(self, self._prepare, self._on_end,
                        'topic record: these records cannot be diagnosed')
        self.create_timer(1.0, self._report, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.create_subscription(Float64MultiArray, 'record', self._on_record, latched(16))

    def close(self):
        """End a diagnosis that is running."""
        self._job.close()

    def _on_record(self, message):
        try:
            record = record_from_table(message)
        except InputError as error:
            self.get_logger().error(str(error))
            return
        continuous = self._config['mode'] == 'continuous'
        if continuous:
            try:
                refuse_short(record)
            except InputError as error:     # the end of a run
                self.get_logger().warning(str(error))
                return
        self._records.add(record, longest=not continuous)
        if continuous or self._records.complete and not self._diagnosed_once:
            self._job.request()

    def _on_diagnose(self, _, response):
        if not self._records:
            response.message = 'there is no record yet: is a recorder running? (~/flush)'
            return response
        busy = self._job.busy
        self._job.request()
        response.success = True
        what = ('the newest record' if self._config['mode'] == 'continuous' else
                f'{len(self._records)} records')
        response.message = ('a diagnosis is running; another follows' if busy else
                            f'diagnosing {what}')
        return response

    def _on_cancel(self, _, response):
        response.success = self._job.cancel()
        response.message = 'cancelled' if response.success else 'no diagnosis is running'
        return response

    def _prepare(self):
        """Return the diagnosis of the records as they are now, or of the newest window."""
        self._diagnosed_once = True
        values = self._config.values()
        continuous = values['mode'] == 'continuous'
        records = [self._records.newest] if continuous else self._records.all()

        def run():
            vehicle = load_nominal(values['vehicle'])
            flights = [with_commands(record.last(values['window']) if values['window']
                                     else record, vehicle) for record in records]
            for flight in flights:
                refuse_short(flight)
                refuse_unfit(flight, vehicle)
            found = diagnose(flights, vehicle, effects=values['effects'] or None,
                             on_progress=self._job.tell)
            return found.data, flights

        return run

    def _on_end(self, outcome):
        if outcome is None:
            self._status = (WARN, 'the diagnosis was cancelled', {})
            self.get_logger().warning('the diagnosis was cancelled')
        elif isinstance(outcome, InputError):
            self._status = (ERROR, str(outcome), {})
            self.get_logger().error(str(outcome))
        else:
            self._publish(*outcome)
        self._publish_status()

    def _publish(self, data, flights):
        span = [int(flights[0].info.get('start_ns', 0)),
                int(flights[-1].info.get('start_ns', 0)
                    + round(1e9 * (flights[-1].t[-1] - flights[-1].t[0])))]
        data = {**data, 'time': datetime.now(timezone.utc).isoformat(), 'span_ns': span,
                'dropped_samples': sum(flight.info.get('dropped', 0) for flight in flights)}
        self._json.publish(String(data=json.dumps(data)))
        gap = data['gap']
        self._gap.publish(table_message([[gap[stage][name] for stage in STAGES]
                                         for name in gap['units']],
                                        ','.join(gap['units']), ','.join(STAGES)))
        shares = {row['channel']: row['share'] for row in data['where']}
        self._where.publish(table_message([[shares.get(name, 0.0)] for name in CHANNELS],
                                          ','.join(CHANNELS), 'share'))
        self._job.say(1.0)
        verdict = data['verdict']
        level = ERROR if 'unknown' in verdict else OK if verdict == ['none'] else WARN
        text = f'verdict: {verdict_line(data)}'
        self._status = (level, text, {
            'verdict': ','.join(verdict), 'closed': gap['closed'],
            'dropped_samples': data['dropped_samples'],
            **{f'probability/{row["effect"]}': row['probability'] for row in data['ranking']}})
        self.get_logger().info(f'{text}; {100 * gap["closed"]:.0f} % of the velocity gap above '
                               'the noise is closed')

    def _report(self):
        # A trigger that is lost delays a result at most.
        self._job.collect()
        self._publish_status()

    def _publish_status(self):
        level, text, values = self._status
        if self._job.busy:
            level, text = OK, 'diagnosing'
        self._diagnostics.publish(diagnostics_message(self, level, text, values))


def _validate(values):
    load_nominal(values['vehicle'])
    if 0.0 < values['window'] < SHORTEST:
        raise InputError(f'parameter window: {values["window"]:g} s are too short for a '
                         f'diagnosis; expected 0 (all) or at least {SHORTEST:g}')


def main(args=None):
    """Run the node; returns the exit code."""
    return process.run(Diagnoser, HELP, args, before=warm_up_diagnosis)


if __name__ == '__main__':
    sys.exit(main())
