# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Write config/layouts for Foxglove and PlotJuggler (python -m docs.layouts)."""

from dataclasses import dataclass
import json
from pathlib import Path
import xml.etree.ElementTree as ET

from quad_ident_ros.greybox.errors import UNITS
from quad_ident_ros.identify.signals import OUTPUTS

FOLDER = Path(__file__).resolve().parents[1] / 'config' / 'layouts'
COLOURS = ('#1f77b4', '#ff7f0e', '#2ca02c', '#d62728', '#9467bd', '#8c564b')
AXES = 'xyz'


@dataclass(frozen=True)
class Curve:
    """A number of a message: its topic, its field ('vector.x') and its name in the legend."""

    topic: str
    field: str
    label: str


@dataclass(frozen=True)
class Plot:
    """A plot: its title with units, and its curves."""

    title: str
    curves: tuple[Curve, ...]


def _of(topic: str, field: str, labels: str) -> tuple[Curve, ...]:
    """Return the curves of x, y, z of a field of a topic."""
    return tuple(Curve(topic, f'{field}.{axis}', label)
                 for axis, label in zip(AXES, labels.split(', '), strict=False))


FLIGHT = ((Plot('position, m', _of('pose', 'pose.position', 'x, y, z')),
           Plot('velocity in body axes, m/s', _of('twist', 'twist.linear', 'x, y, z'))),
          (Plot('attitude, rad', _of('attitude', 'vector', 'roll, pitch, yaw')),
           Plot('rate, rad/s', _of('twist', 'twist.angular', 'x, y, z'))),
          (Plot('thrust, N', (Curve('input', 'wrench.force.z', 'U1'),)),
           Plot('moments, N m', _of('input', 'wrench.torque', 'x, y, z'))))
MODELS = tuple((Plot(f'{name}: K', _of(f'outputs/{name}', 'vector', 'K')),
                Plot(f'{name}: a, b, 1/s', _of(f'outputs/{name}', 'vector', 'K, a, b')[1:]),
                Plot(f'{name}: standard errors of K, a, b',
                     _of(f'outputs/{name}/standard_errors', 'vector', 'K, a, b')))
               for name in OUTPUTS) + ((Plot('the vehicle changed, 1: yes',
                                             (Curve('changed', 'data', 'changed'),)),),)
GAP = (tuple(Plot(f'gap of {name}, {unit}', _of(f'gap/{name}', 'vector', 'before, after, noise'))
             for name, unit in UNITS.items()),
       (Plot('share of the gap, forces', _of('where/force', 'vector', 'Fx, Fy, Fz')),
        Plot('share of the gap, moments', _of('where/moment', 'vector', 'Mx, My, Mz'))))
TABS = {'flight': FLIGHT, 'K, a, b': MODELS, 'gap': GAP}
"""Rows of plots of each tab."""


def foxglove() -> dict:
    """Return the layout of Foxglove: panels by id, and how they share the window."""
    panels: dict[str, dict] = {'DiagnosticSummary!nodes': {
        'minLevel': 0, 'pinnedIds': [], 'hardwareIdFilter': '', 'sortByLevel': True,
        'topicToRender': '/diagnostics'}}
    tabs = []
    for title, rows in TABS.items():
        lines = []
        for row in rows:
            names = []
            for plot in row:
                names.append(f'Plot!{len(panels)}')
                panels[names[-1]] = _foxglove_plot(plot)
            lines.append(_shared(names, 'row'))
        tabs.append({'title': title, 'layout': _shared(lines, 'column')})
    tabs.append({'title': 'nodes', 'layout': 'DiagnosticSummary!nodes'})
    panels['Tab!all'] = {'activeTabIdx': 0, 'tabs': tabs}
    return {'configById': panels, 'globalVariables': {}, 'userNodes': {},
            'playbackConfig': {'speed': 1}, 'layout': 'Tab!all'}


def plotjuggler() -> ET.Element:
    """Return the layout of PlotJuggler: tabs of plots, split into rows and columns."""
    root = ET.Element('root')
    window = ET.SubElement(root, 'tabbed_widget', parent='main_window', name='Main Window')
    for title, rows in TABS.items():
        tab = ET.SubElement(window, 'Tab', tab_name=title, containers='1')
        column = _split(ET.SubElement(tab, 'Container'), '-', len(rows))
        for row in rows:
            line = _split(column, '|', len(row))
            for plot in row:
                area = ET.SubElement(line, 'DockArea', name=plot.title)
                drawn = ET.SubElement(area, 'plot', mode='TimeSeries', style='LinesAndDots',
                                      flip_x='false', flip_y='false')
                ET.SubElement(drawn, 'limitY')
                for curve, colour in zip(plot.curves, COLOURS, strict=False):
                    ET.SubElement(drawn, 'curve', color=colour,
                                  name=f'/{curve.topic}/{curve.field.replace(".", "/")}')
    ET.SubElement(window, 'currentTabIndex', index='0')
    ET.SubElement(root, 'use_relative_time_offset', enabled='1')
    for name in ('Plugins', 'customMathEquations', 'snippets'):
        ET.SubElement(root, name)
    ET.indent(root)
    return root


def texts() -> dict[str, str]:
    """Return {name of a file: its text}."""
    return {'foxglove.json': json.dumps(foxglove(), indent=1) + '\n',
            'plotjuggler.xml': "<?xml version='1.0' encoding='UTF-8'?>\n"
                               + ET.tostring(plotjuggler(), encoding='unicode') + '\n'}


def _foxglove_plot(plot: Plot) -> dict:
    return {'foxglovePanelTitle': plot.title,
            'paths': [{'value': f'/{curve.topic}.{curve.field}', 'label': curve.label,
                       'color': colour, 'enabled': True, 'timestampMethod': _clock(curve),
                       'showLine': True}
                      for curve, colour in zip(plot.curves, COLOURS, strict=False)],
            'showXAxisLabels': True, 'showYAxisLabels': True, 'showLegend': True,
            'legendDisplay': 'floating', 'showPlotValuesInLegend': False, 'isSynced': True,
            'xAxisVal': 'timestamp', 'sidebarDimension': 240}


def _clock(curve: Curve) -> str:
    """Return whose time a curve is drawn over: only what has no header goes by its receipt."""
    return 'receiveTime' if curve.topic == 'changed' else 'headerStamp'


def _shared(parts: list, direction: str):
    """Return parts that share a space evenly; Foxglove splits in two again and again."""
    if len(parts) == 1:
        return parts[0]
    return {'direction': direction, 'first': parts[0], 'second': _shared(parts[1:], direction),
            'splitPercentage': round(100 / len(parts), 2)}


def _split(parent: ET.Element, orientation: str, count: int) -> ET.Element:
    return ET.SubElement(parent, 'DockSplitter', orientation=orientation, count=str(count),
                         sizes=';'.join([f'{1 / count:.6f}'] * count))


if __name__ == '__main__':
    FOLDER.mkdir(exist_ok=True)
    for name, text in texts().items():
        (FOLDER / name).write_text(text, encoding='utf-8')
        print(FOLDER / name)
