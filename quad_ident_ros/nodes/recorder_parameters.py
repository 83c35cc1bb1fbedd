# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The parameters of the recorder."""

from quad_ident_ros.data.mapping import load_mapping
from quad_ident_ros.data.topics import FLIGHT_TOPICS
from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.folders import vehicle_name
from quad_ident_ros.nodes.mapped import KNOWN, known_mapping, MappedTopics
from quad_ident_ros.nodes.outlets import windows_of
from quad_ident_ros.nodes.parameters import ParameterSpec

SPECS = (
    ParameterSpec('topics', tuple(FLIGHT_TOPICS), 'Topics that a row needs: of the first five, '
                  'or of the last three.', choices=(*FLIGHT_TOPICS, *KNOWN), fixed=True),
    ParameterSpec('mapping', '', 'File that says which topics of any installed type are what, as '
                  'for bags (docs/records.md); empty: the topics of the parameter topics.',
                  fixed=True),
    ParameterSpec('gap', 0.1, 'Seconds between two samples of a topic of other rate or stamps '
                  'beyond which rows between them are dropped, where stamps are not equal.',
                  limits=(0.001, 10.0), fixed=True),
    ParameterSpec('window_samples', 60000, 'Samples after which a window is complete.',
                  limits=(2, 10_000_000), fixed=True),
    ParameterSpec('window_seconds', 600.0, 'Seconds after which a window is complete.',
                  limits=(0.01, 1e6), fixed=True),
    ParameterSpec('overlap', 0.0, 'Share of a full window that the next one keeps: 0.9 publishes '
                  'a sliding window ten times per window length.', limits=(0.0, 0.999),
                  fixed=True),
    ParameterSpec('windows', (), 'Further windows, each TOPIC=SECONDS or TOPIC=SECONDS,OVERLAP, '
                  'whose records go out on topics of their own: record_long=30,0.5.', fixed=True),
    ParameterSpec('output', '', 'Folder for recordings (a bag and CSV files in a new '
                  'recording_N); empty records in memory only.', fixed=True),
    ParameterSpec('vehicle_name', '', 'Name of the vehicle: recordings go to the folder of its '
                  'day in output, output/NAME/2026-05-14/recording_N, where `quad_ident fleet` '
                  'takes them; empty: into output itself.', fixed=True),
)


def mapped_topics(parameters):
    """Return the MappedTopics of the parameters, or None for the topics of the simulator."""
    if parameters['mapping']:
        path = parameters['mapping']
        return MappedTopics(load_mapping(path), path)
    names = [name for name in parameters['topics'] if name in KNOWN]
    return MappedTopics(known_mapping(names), 'parameter topics') if names else None


def validate(values):
    """Raise InputError where the parameters do not go together."""
    windows_of(values['windows'])
    if values['vehicle_name']:
        vehicle_name('parameter vehicle_name', values['vehicle_name'])
        if not values['output']:
            raise InputError('parameter vehicle_name: it names a folder in output, which is '
                             'empty; set output, too')
    if not values['topics'] or len(set(values['topics'])) != len(values['topics']):
        raise InputError('parameter topics: name at least one topic, and each once')
    if 0 < sum(name in KNOWN for name in values['topics']) < len(values['topics']):
        raise InputError(f'parameter topics: {", ".join(KNOWN)} do not go with the others, which '
                         'are joined by equal stamps; name only these, or a mapping')
