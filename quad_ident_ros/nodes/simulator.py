# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Node `simulator`: flies an experiment and publishes what a vehicle would."""

import sys

from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from std_msgs.msg import String, UInt64
from std_srvs.srv import Trigger

from quad_ident_ros.data.topics import JOINED_TOPIC, RUN_TOPIC
from quad_ident_ros.effects.registry import EFFECTS, from_entries
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import load_experiment, NOISE_UNITS
from quad_ident_ros.nodes import process
from quad_ident_ros.nodes.flight_worker import FlightWorker
from quad_ident_ros.nodes.node import PackageNode
from quad_ident_ros.nodes.parameters import help_text, NodeParameters, ParameterSpec
from quad_ident_ros.nodes.qos import latched, LOSSLESS, STREAM
from quad_ident_ros.nodes.samples import SampleStreams
from quad_ident_ros.playback import Playback

SETTLING = 0.5      # s without a change of the subscriptions before the first run starts,
SETTLING_PARTLY = 5.0   # and where some of the five topics have none: discovery takes up to 3 s
NO_ANSWER = 1.0     # s without news of a recorder after which it is not waited for
ANNOUNCED = 5.0     # s for subscribers to have the notice of the first run, unless they hang
STALLED = 5.0       # s of waiting for a subscriber after which the node says so

SPECS = (
    ParameterSpec('experiment', 'hover_single_axis',
                  'Name of a shipped experiment or path of an experiment file.'),
    ParameterSpec('vehicle', '', 'Name or path of a vehicle file that replaces the '
                  "experiment's; empty keeps it."),
    ParameterSpec('effects', (), 'Effects of the vehicle in addition to those of its file, each '
                  'NAME:PARAMETER=VALUE.'),
    ParameterSpec('real_time_factor', 1.0, 'Simulated seconds per second; 0 runs as fast as the '
                  'subscribers keep up, without loss.', limits=(0.0, 1000.0), fixed=True),
    ParameterSpec('publish_clock', False, 'Publish /clock with the simulated time, which then '
                  'begins at 0.', fixed=True),
    ParameterSpec('autostart', True, 'Start the experiment by itself; otherwise ~/start does.',
                  fixed=True),
    ParameterSpec('wait_for_subscribers', True, 'Start only when somebody listens and the '
                  'subscriptions have settled, so that nothing is missed.', fixed=True),
    ParameterSpec('seed', 0, 'Seed of the measurement noise, in closed loop of the trajectories '
                  'too.', limits=(0, 2 ** 31)),
    ParameterSpec('frame_prefix', '', "Before the name of the body's frame, base_link: uav1/ "
                  'gives uav1/base_link. The world is common to all.', fixed=True),
    *(ParameterSpec(f'noise.{channel}', -1.0, f'Standard deviation of the {channel} noise, '
                    f"{unit}; negative keeps the experiment's.", limits=(-1.0, 1e6))
      for channel, unit in NOISE_UNITS.items()),
)

_EFFECTS = '\n'.join(f'  {effect.name}: {effect.title}' for effect in EFFECTS.values())

HELP = f"""simulator: flies an experiment and publishes what a vehicle would.

  ros2 run quad_ident_ros simulator --ros-args -p experiment:=small_angle -p real_time_factor:=2.0
  ros2 run quad_ident_ros simulator --ros-args -p experiment:=closed_loop \\
      -p effects:="['rotor_drag:coefficient=0.2']"

Publishes (reliable; one stamp per sample on all five):
  attitude  geometry_msgs/Vector3Stamped  roll, pitch, yaw, unwrapped, rad
  altitude  geometry_msgs/PointStamped    point.z, m
  pose      geometry_msgs/PoseStamped     in the world (ENU)
  twist     geometry_msgs/TwistStamped    of the body, in body axes (FLU)
  input     geometry_msgs/WrenchStamped   on the body, in body axes: thrust in force.z (N), moments
                                          in torque x, y, z (N m): l U2, l U3, U4, l the arm length
  run       std_msgs/String (latched)     JSON: what flies now, its stamps and provenance
  /clock    rosgraph_msgs/Clock           with publish_clock
Subscribes: joined_until (std_msgs/UInt64): how far the recorders are, which full speed waits for
Services: ~/start, ~/stop (std_srvs/Trigger)
Effects:
{_EFFECTS}

Parameters (--ros-args -p NAME:=VALUE):
{help_text(SPECS)}"""


class Simulator(PackageNode):
    """Flies the runs of an experiment one after the other and publishes their samples."""

    def __init__(self, **kwargs):
        super().__init__('simulator', **kwargs)
        self._config = NodeParameters(self, SPECS, self._validate)
        self._factor = self._config['real_time_factor']
        if self._config['publish_clock'] and self.get_parameter('use_sim_time').value:
            raise InputError('publish_clock and use_sim_time exclude each other: the clock would '
                             'wait for itself')
        # What comes from outside by /clock is the time; otherwise time only has to be steady.
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        external = self.get_parameter('use_sim_time').value
        self._pace = self.get_clock() if external else self._steady
        self._streams = SampleStreams(self, STREAM if self._factor else LOSSLESS,
                                      self._config['frame_prefix'],
                                      self._config['publish_clock'])
        self._run_publisher = self.create_publisher(String, RUN_TOPIC, latched(32))
        self.create_service(Trigger, '~/start', self._on_start)
        self.create_service(Trigger, '~/stop', self._on_stop)
        self._joined = self.create_subscription(UInt64, JOINED_TOPIC, self._on_joined, 10)
        self._joined_until = 0
        self._news = 0
        self._playback = None
        self._timer = None
        self._worker = None
        self._waiting = None
        self.done = False
        if self._config['autostart']:
            self.start()

    def ready(self):
        """Say what flies, and when."""
        what = self._config['experiment']
        return f'flies {what}' if self._config['autostart'] else f'flies {what} on ~/start'

    @property
    def busy(self):
        """Whether anything was flown, or would be lost in a new start."""
        return self._playback is not None and not (self._config['autostart']
                                                   and self._playback.is_first)

    def start(self):
        """Restart the experiment with the parameters as they are now."""
        experiment = self._load(self._config.values())
        self._stop_timer()
        self._cut_short()
        self._streams.start_over()
        self._playback = Playback(experiment, self._factor,
                                  self._playback.epoch if self._playback else 0)
        self.done = False
        self._seen = (None, None)
        if self._config['wait_for_subscribers']:
            self.get_logger().info(f'{experiment.name}: waiting for subscribers '
                                   '(wait_for_subscribers:=false starts without)')
            self._schedule(0.02, self._await_subscribers)
        else:
            self._next_run()

    def close(self):
        """Stop publishing."""
        self._stop_timer()
        self._cut_short()

    def _validate(self, values):
        self._load(values)

    def _load(self, values):
        where = 'parameter effects'
        experiment = load_experiment(values['experiment'], values['vehicle'] or None)
        experiment = experiment.with_effects(
            from_entries(values['effects'], experiment.vehicle.effects, where), where)
        experiment.check(_noise(experiment, values))
        return experiment

    def _on_start(self, _, response):
        try:
            self.start()
        except InputError as error:   # the file has changed since it was named
            response.message = str(error)
            return response
        response.success = True
        response.message = (f'{self._playback.experiment.name}: '
                            f'{self._playback.waiting} runs to fly')
        return response

    def _on_stop(self, _, response):
        flying = self._timer is not None
        self._stop_timer()
        self._cut_short()
        self.done = True
        response.success = True
        response.message = 'stopped' if flying else 'nothing was flying'
        return response

    def _cut_short(self):
        """Announce again a run that ends before its time."""
        notice = self._playback.cut_short() if self._playback else None
        if notice is not None:
            self._run_publisher.publish(String(data=notice.to_json()))
            self.get_logger().info(f'{notice.info["run"]}: stopped after {notice.samples} '
                                   'samples')

    def _schedule(self, period, callback):
        """Call back every so many seconds until the next _schedule or _stop_timer."""
        def on_timer():
            # An executor may still call a timer that it had ready when it was destroyed.
            if self._timer is timer:
                callback()

        timer = self._timer = self.create_timer(period, on_timer, clock=self._steady)

    def _stop_timer(self):
        if self._timer is not None:
            self.destroy_timer(self._timer)
            self._timer = None
        if self._worker is not None:
            self._worker.cancel()
            self._worker = None

    def _await_subscribers(self):
        now = self._steady.now()
        counts = tuple(stream.get_subscription_count() for stream in self._streams.flight)
        if counts != self._seen[0]:
            self._seen = (counts, now.nanoseconds)
        patience = SETTLING if all(counts) else SETTLING_PARTLY
        settled = any(counts) and now.nanoseconds - self._seen[1] >= patience * 1e9
        # A clock that comes from outside stands at zero until its first message.
        if settled and self._pace.now().nanoseconds > 0:
            self._next_run()
        elif settled:
            self.get_logger().info('waiting for /clock', throttle_duration_sec=5.0)

    def _next_run(self):
        self._stop_timer()
        experiment, run = self._playback.experiment, self._playback.next_run()
        if run is None:
            self.done = True
            self.get_logger().info(f'{experiment.name}: done')
            return
        values = self._config.values()
        self._worker = FlightWorker(experiment, run, _noise(experiment, values), values['seed'])
        self._schedule(0.002, lambda: self._await_flight(run))

    def _await_flight(self, run):
        worker = self._worker
        if worker.is_alive():
            return
        self._stop_timer()
        if isinstance(worker.outcome, InputError):
            self.get_logger().error(f'{run.name}: {worker.outcome}')
            self._next_run()
            return
        is_first = self._playback.is_first
        self._announce(run, worker.outcome)
        self._playback.begin(self._pace.now().nanoseconds)
        self._news = self._steady.now().nanoseconds
        if is_first and self._config['wait_for_subscribers']:
            self._schedule(0.002, self._await_announced)
        else:
            self._publish_run()

    def _await_announced(self):
        """
        Publish the first run once the subscribers have its notice, or are too late with it.

        Who acknowledges it has discovered its publisher, and those of the streams, which were
        there before it: what is published now arrives.
        """
        waited = (self._steady.now().nanoseconds - self._news) * 1e-9
        if waited < ANNOUNCED and not self._run_publisher.wait_for_all_acked(Duration()):
            return
        self._stop_timer()
        self._publish_run()

    def _publish_run(self):
        self._news = self._steady.now().nanoseconds
        period = self._playback.experiment.period / self._factor if self._factor else 0.0
        # A timer per sample would set the pace by its own lateness; it only asks what is due.
        self._schedule(min(max(period, 0.001), 0.05) if self._factor else 0.0005,
                       self._publish_due)

    def _announce(self, run, flight):
        problem = flight.record.info['infeasible']
        if problem:
            self.get_logger().warning(f'{run.name}: {problem}')
        if flight.status != 'complete':
            self.get_logger().warning(f'{run.name}: the model diverged at t = '
                                      f'{flight.end_time:.6g} s')
        # Stamps begin now, for the flight has taken its time to compute; simulated time goes on
        # where it was.
        now = 0 if self._config['publish_clock'] else self.get_clock().now().nanoseconds
        notice = self._playback.load(flight, now)
        self._run_publisher.publish(String(data=notice.to_json()))
        self.get_logger().info(f'{run.name}: flying {notice.samples} samples')

    def _publish_due(self):
        until = None if self._factor else self._read_until()
        for _ in range(self._playback.due(self._pace.now().nanoseconds, until)):
            stuck = self._streams.publish(*self._playback.sample())
            if stuck is not None:
                self._say_if_stalled(stuck)
                return
            self._waiting = None
            if self._playback.sent():
                self._next_run()
                return

    def _read_until(self):
        """Return the stamp up to which the recorders have joined, None where none says."""
        waited = (self._steady.now().nanoseconds - self._news) * 1e-9
        if waited > NO_ANSWER or not self.count_publishers(self._joined.topic_name):
            return None
        return self._joined_until

    def _on_joined(self, message):
        self._joined_until = message.data
        self._news = self._steady.now().nanoseconds

    def _say_if_stalled(self, publisher):
        now = self._steady.now().nanoseconds
        if self._waiting is None:
            self._waiting = now
        elif now - self._waiting > STALLED * 1e9:
            self.get_logger().warning(f'waiting for a subscriber of {publisher.topic_name} that '
                                      'does not keep up', throttle_duration_sec=STALLED)


def _noise(experiment, values):
    """Return the noise of an experiment with that of the parameter values in its place."""
    return {**experiment.noise, **{channel: values[f'noise.{channel}'] for channel in NOISE_UNITS
                                   if values[f'noise.{channel}'] >= 0}}


def main(args=None):
    """Run the node; returns the exit code."""
    return process.run(Simulator, HELP, args, process.FastExecutor)


if __name__ == '__main__':
    sys.exit(main())
