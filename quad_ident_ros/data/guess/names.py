# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the names of the columns of other people's tables mean."""

import re

from quad_ident_ros.data.columns import FORCE, POSITION, RATE, VELOCITY
from quad_ident_ros.data.guess.words import in_english, without_accents
from quad_ident_ros.data.record import QUATERNION
from quad_ident_ros.data.unit_names import unit_by

UNIT = re.compile(r'[\[(]\s*([^\])]*)\s*[\])]\s*$')
_ENTRY = re.compile(r'\d+|[wxyzWXYZ]')
ENDING = re.compile(r'_((?:m?rad|deg)_?(?:ps|s|sec)|[mc]?m(?:_?s_?2|ps2?|_s)|ns|us|usec|ms|msec|s|'
                    r'sec|secs|seconds|mm|cm|m|ft|deg|rad|mrad|dps|rpm|krpm|hz|g|mv|v|'
                    r'(?<=time_)min|minutes|(?<=time_)h|hours)$')
NO_UNITS = frozenset(('', '-', '1', 'world', 'body', 'global', 'local', 'inertial', 'ned', 'enu',
                      'frd', 'flu', 'nwu', 'raw', 'filtered', 'estimated', 'measured', 'float',
                      'float32', 'float64', 'double', 'utc', 'unix', 'epoch', 'gps'))
"""What stands in brackets behind names, or in a line of units, and is none."""

NOT = re.compile(r'(^|_)(sp|setpoint|des|desired|ref|reference|target|goal|cov|covariance|var|'
                 r'std|err|error|raw|bias|offset|mag|wind)(_|$)|^b_[awg]_')
"""Of names that are not what was measured; b_w and b_a are biases."""

_IN = r'(?:_[wbiesgrmv]{{1,2}}){{0,2}}'
"""Frames behind a letter, as in p_RS_R_x: world, body, imu, earth, sensor, ..."""

_WORLD = 'w|world|inertial|ned|enu|nwu|global|local|map|odom'
_BODY = 'b|body|flu|frd|imu'
_HOW = 'est|estimate|estimated|meas|measured|true|gt|actual'
_BEHIND_BODY = rf'((?:_(?:{_BODY}|{_HOW}))?)$'
_BEHIND = rf'((?:_(?:{_WORLD}|{_HOW}))?)$'
"""What stands behind an axis, as in vx_w and pos_x_est: the axes and how it is known."""

AXES = {
    POSITION: rf'(^|_)(p{_IN}|pos|position|translation|loc|location|mocap|vicon|state_estimate|'
              rf'drone|uav|quad|robot|rigid_body|ground_truth|gt|odom|pose)(?:_(?:{_WORLD}))?'
              rf'_?{{}}{_BEHIND}',
    VELOCITY: rf'(^|_)(v{_IN}|vel|velocity|speed|linear_velocity|lin_vel|twist_linear|linear)'
              rf'(?:_(?:{_WORLD}|{_BODY}))?_?{{}}((?:_(?:{_WORLD}|{_BODY}|{_HOW}))?)$',
    FORCE: rf'(^|_)(a{_IN}|acc|accel|accelerometer|accelerations?|linear_acceleration|lin_acc|'
           rf'specific_force)(?:_b|_body|_m_s2|_xyz)?_?{{}}{_BEHIND_BODY}',
    RATE: rf'(^|_)(w{_IN}|gyro|gyr|gyroscope|gyro_rad|omega|om|rate|rates|body_?rates?|ang_vel|'
          r'angvel|angular_velocity|angular_rate|twist_angular|angular)(?:_b|_body|_xyz)?'
          rf'_?{{}}{_BEHIND_BODY}',
    QUATERNION: rf'(^|_)(q{_IN}|quat|quaternion|orientation|rotation|att_q|attitude_q)_?{{}}'
                rf'{_BEHIND}',
}
TURNED = re.compile(r'(^|_)(ang|angular|gyro|rot)')
"""Of names that are of a rotation, which a velocity or a force is not."""


def _named(trios: tuple[tuple[str, ...], ...], *patterns: str) -> list[tuple[str, ...]]:
    return [tuple(pattern.format(axis) for axis in trio) for trio in trios for pattern in patterns]


BEHIND = ('', *(f'_{word}' for word in f'{_WORLD}|{_HOW}'.split('|')))
"""What stands behind names that are bare."""

OF_BODY = re.compile(r'(?<!rigid)(?:^|_)(?:body|flu|frd)(?:_|$)|_b$|(?:^|_)v(?:el|elocity)?_b_')
SAID_WORLD = re.compile(r'(?:^|_)(ned|enu)(?:_|$)')

_COMPASS = (('north', 'east', 'down'), ('n', 'e', 'd'), ('east', 'north', 'up'), ('e', 'n', 'u'))
BARE: dict[tuple[str, ...], tuple[tuple[str, ...], ...]] = {
    POSITION: (('x', 'y', 'z'), ('tx', 'ty', 'tz'), *_COMPASS,
               *_named(_COMPASS, 'p_{}', 'p{}', 'pos_{}', 'position_{}')),
    VELOCITY: (('xdot', 'ydot', 'zdot'), ('x_dot', 'y_dot', 'z_dot'),
               *_named(_COMPASS, 'v_{}', 'v{}', 'vel_{}', 'velocity_{}')),
    RATE: (('p', 'q', 'r'), ('gx', 'gy', 'gz'), ('g_x', 'g_y', 'g_z'))}
WORLD = {trio: world for group in (POSITION, VELOCITY) for trio in BARE[group]
         for world, end in (('NED', ('d', 'down')), ('ENU', ('u', 'up'))) if trio[2].endswith(end)}
"""Names by points of the compass -> the axes of the world that they say."""

ROW_LABEL = re.compile(r'unnamed_\d+|index|level_\d+')
"""Names that pandas gives to a column of labels of rows."""

ANGLE = {'phi': r'(^|_)(roll|phi|rpy_[x0]|euler_x)$',
         'theta': r'(^|_)(pitch|theta|rpy_[y1]|euler_y)$',
         'psi': r'(^|_)(yaw|psi|heading|rpy_[z2]|euler_z)$'}
TURNING = ('roll', 'pitch', 'yaw')
PITCH_DOWN = re.compile(r'(stabilizer|state_estimate)_pitch')
"""Log variables of a Crazyflie, whose pitch has the other sign (Bitcraze, coordinate system)."""

TIME = re.compile(r'(^|_)(t|time|timestamp|time_?stamp|stamp|ts|zeit|elapsed|clock|'
                  r'rosbagtimestamp|time_boot|time_since_boot|millis|micros)$')
_WORDS = 'pwm|cmd|command|req|out|output|duty|throttle|value'
MOTOR = re.compile(r'(^|_)(cmd|command|motor_cmd|m|mot|mot_m|motor|motors|motor_m|pwm|dshot|esc|u|'
                   r'output|outputs|controls?|actuator|actuator_controls|action|throttle|thrust|'
                   r'duty|rc_?out|rcou_c|servo)'
                   rf'(?:_(?:data|control|velocities|angular_velocities|{_WORDS}))?_?(\d{{1,2}})$')
_ASKED = r'(^|_)(cmds?|commands?|commanded|req)(_|$)'
COMMANDED = re.compile(_ASKED)
"""Of rotor speeds that are asked for, not measured."""

WANTED = re.compile(rf'{_ASKED}|(^|_)(planned|inputs?)_|(^|_)(controller|ctrl_?target)_'
                    r'(v?[xyz]|q[wxyz]|(roll|pitch|yaw)(_rate)?)$')
"""Of states that are asked for; the last are log variables of a Crazyflie."""

REPORTED = re.compile(r'(^|_)esc_?\d')
"""Names of motors whose speeds, where named so, a speed controller has measured."""

_AFTER = re.compile(rf'_?(\d{{1,2}})_(speed|vel|velocity|{_WORDS})$')
"""What stands behind the number of a motor, and belongs before it: m1_pwm."""

_AXIS_FIRST = re.compile(r'(?<![a-z0-9])([xyz])_?(pos|position|vel|velocity|speed|acc|accel|gyro)'
                         rf'(?=$|_(?:{_WORLD}|{_BODY}|{_HOW})$)')
"""An axis before what it is of, and belongs behind it: x_pos, xgyro."""

_IMAGINARY = re.compile(r'(?<![a-z0-9])(q|quat|quaternion)_?([ijk])$')
_SERVO = re.compile(r'(?:^|_)servo(?:_output_raw_servo)?_?(\d{1,2})_raw$')
"""Messages of MAVLink, whose raw outputs are what is sent to the motors."""

CORNERS = {'front_right': r'(fr|front_?right)', 'rear_right': r'(rr|br|(rear|back)_?right)',
           'rear_left': r'(rl|bl|(rear|back)_?left)', 'front_left': r'(fl|front_?left)'}
CORNER = r'(^|_)(m|mot|motor|pwm|esc|rotor|cmd|motor_cmd|output|u|thrust)s?_?{}$'
"""Of commands that are named by where their motors are."""

CRAZYFLIE = re.compile(r'motor_m[1-4]')
"""Log variables of a Crazyflie's motors."""

SAID_PWM = re.compile(r'(^|_)(pwm|servo|rc_?out|rcou)(_|\d|$)')
"""Of signals that are PWM where their size says so, too."""

FORCES = re.compile(r'(^|_)thrust_?\d')
"""Of commands that may be forces, unless they are shares of full thrust."""

SPEED = re.compile(r'(^|_)(r|(?<!_)[nw]|omega|omega_m|rotor|rotor_speed|rotor_vel|'
                   r'rotor_velocities|motor_k?rpm|motor_speed|k?rpm|erpm|esc_rpm|esc_speed|prop|'
                   r'prop_speed|propeller)(?:_(?:meas|measured|actual|feedback))?_?(\d{1,2})$')
BATTERY = re.compile(r'(^|_)(vbat|vbatt|v_bat|bat_v|battery|battery_voltage|voltage|vbat_latest|'
                     r'battery_v|bat_volt|supply_voltage)$')


def plain(name: str) -> tuple[str, str]:
    """Return a name in small letters and English, _ between its parts, and its unit."""
    said = ''
    match = UNIT.search(name)
    # q[0] and q(w) are entries of an array, gyro.x [deg/s] has a unit.
    if match and not _ENTRY.fullmatch(match.group(1)):
        name, said = name[:match.start()], match.group(1).strip().lower()
    name = re.sub(r'_0(?=[/.])', '', name.strip())      # the first instance of a topic of PX4
    name = re.sub(r'([a-z0-9])([A-Z])', r'\1_\2', name)
    name = re.sub(r'[^a-z0-9]+', '_', without_accents(name).lower()).strip('_')
    name = re.sub(r'_0(\d)$', r'_\1', name)      # PlotJuggler counts .00, .01, ...
    match = ENDING.search(name)
    if not said and match and len(name) > len(match.group()):
        name, said = name[:match.start()], match.group(1)
    name = _AFTER.sub(r'_\2_\1', _SERVO.sub(r'servo_\1', in_english(name)))
    name = _AXIS_FIRST.sub(r'\2_\1', name)
    name = _IMAGINARY.sub(lambda found: f'{found[1]}_{"xyz"["ijk".index(found[2])]}', name)
    return name, unit_by(said)
