# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the shipped layouts of Foxglove and PlotJuggler name, read from their files."""

import json
import xml.etree.ElementTree as ET

from quad_ident_ros.resources import config_dir

FOLDER = config_dir() / 'layouts'


def foxglove():
    """Return the layout of Foxglove."""
    return json.loads((FOLDER / 'foxglove.json').read_text('utf-8'))


def foxglove_paths():
    """Return {(topic, field, field of that, ...)} of all curves."""
    return {tuple(path['value'].split('.')) for panel in foxglove()['configById'].values()
            for path in panel.get('paths', ())}


def foxglove_topics():
    """Return the topics of panels that show whole messages."""
    return {panel['topicToRender'] for panel in foxglove()['configById'].values()
            if 'topicToRender' in panel}


def plotjuggler_curves():
    """Return the names of all curves of PlotJuggler."""
    return {curve.get('name')
            for curve in ET.parse(FOLDER / 'plotjuggler.xml').getroot().iter('curve')}
