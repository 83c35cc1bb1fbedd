# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Logs of PX4 with what real ones have beside the samples: parameters, states, resets, rpm."""

import struct

from flightmaker import px4_samples, ulog, ULOG_FORMATS, VEHICLE
import numpy as np

PLACES = ((0.12, 0.12, 0.05), (-0.12, -0.12, 0.05), (0.12, -0.12, -0.05), (-0.12, 0.12, -0.05))
"""Forward, right and KM of motors 1 to 4: PX4's quad x, with the arms of VEHICLE."""
ORDER = [1, 4, 2, 3]
"""Motors that lie at the rotors of VEHICLE, whose spins are the opposite of PX4's."""
TURNED = [place[:2] + (-place[2],) for place in PLACES]

FORMATS = {
    **ULOG_FORMATS,
    'vehicle_status': ('uint64_t timestamp', 'uint8_t arming_state', 'uint8_t vehicle_type',
                       'bool is_vtol'),
    'vehicle_land_detected': ('uint64_t timestamp', 'bool landed'),
    'esc_report': ('uint64_t timestamp', 'int32_t esc_rpm', 'uint8_t actuator_function'),
    'esc_status': ('uint64_t timestamp', 'uint8_t esc_count', 'esc_report[4] esc'),
    'vehicle_odometry': ('uint64_t timestamp', 'uint64_t timestamp_sample', 'float[3] position',
                         'float[4] q', 'float[3] velocity', 'float[3] angular_velocity',
                         'uint8_t velocity_frame'),
}
POSITION = ('uint64_t timestamp', 'uint64_t timestamp_sample', 'float x', 'float y', 'float z',
            'float vx', 'float vy', 'float vz', 'float[2] delta_xy', 'uint8_t xy_reset_counter')


def parameters(places=TURNED, **more):
    """Return the parameters of a vehicle with motors at places."""
    found = {'CA_ROTOR_COUNT': len(places), 'MAV_TYPE': 2, **more}
    for k, place in enumerate(places):
        found |= {f'CA_ROTOR{k}_P{axis}': float(value)
                  for axis, value in zip('XYZ', (*place[:2], 0.0), strict=True)}
        found[f'CA_ROTOR{k}_KM'] = float(place[2])
    return found


def controls(record, curve='linear'):
    """Return actuator_motors (N, 4) of a record of VEHICLE, in PX4's order."""
    speed = record.stack('cmd1', 'cmd2', 'cmd3', 'cmd4')
    low, high = VEHICLE.speed_min, VEHICLE.speed_max
    share = ((speed - low) / (high - low) if curve == 'linear' else
             (speed ** 2 - low ** 2) / (high ** 2 - low ** 2))
    made = np.empty_like(share)
    made[:, np.array(ORDER) - 1] = share
    return made


def status(stamp, armed=True, kind=1, vtol=False):
    """Return a sample of vehicle_status."""
    return 'vehicle_status', 0, stamp, bytes([2 if armed else 1, kind, vtol])


def landed(stamp, down):
    """Return a sample of vehicle_land_detected."""
    return 'vehicle_land_detected', 0, stamp, bytes([down])


def esc(stamp, speeds):
    """Return a sample of esc_status of rotor speeds in rad/s, its entries in reverse order."""
    entries = [struct.pack('<QiB', stamp, round(speed * 30 / np.pi), 101 + k)
               for k, speed in enumerate(speeds)]
    return 'esc_status', 0, stamp, bytes([len(speeds)]) + b''.join(reversed(entries))


def log_of(record, extra=(), formats=FORMATS, named=None, info=None, **samples):
    """Return the bytes of a log of a record with samples beside those of px4_samples."""
    every = [*px4_samples(record, **samples), *extra]
    return ulog(sorted(every, key=lambda sample: sample[2]), formats,
                parameters() if named is None else named, info)
