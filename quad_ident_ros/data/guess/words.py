# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""German and French words in the names of columns, in English."""

import re
import unicodedata

WORDS = {
    # German
    'zeit': 'time', 'zeitstempel': 'timestamp', 'bildnummer': 'frame',
    'geschwindigkeit': 'velocity', 'beschleunigung': 'acc', 'drehrate': 'angular_velocity',
    'winkelgeschwindigkeit': 'angular_velocity',
    'rollen': 'roll', 'rollwinkel': 'roll', 'nicken': 'pitch', 'nickwinkel': 'pitch',
    'gieren': 'yaw', 'gierwinkel': 'yaw', 'rollrate': 'roll_rate', 'nickrate': 'pitch_rate',
    'gierrate': 'yaw_rate', 'drehzahl': 'rpm', 'stellgrosse': 'command', 'stellwert': 'command',
    'schub': 'thrust', 'soll': 'setpoint', 'sollwert': 'setpoint', 'ist': '', 'istwert': '',
    'vorne_rechts': 'front_right', 'vorne_links': 'front_left',
    'hinten_rechts': 'rear_right', 'hinten_links': 'rear_left',
    'batteriespannung': 'battery_voltage', 'akkuspannung': 'battery_voltage',
    'spannung': 'voltage',
    # French
    'temps': 'time', 'horodatage': 'timestamp', 'trame': 'frame', 'vitesse': 'velocity',
    'vitesse_angulaire': 'angular_velocity', 'vitesse_de_rotation': 'angular_velocity',
    'roulis': 'roll', 'tangage': 'pitch', 'lacet': 'yaw',
    'moteur': 'motor', 'commande': 'command', 'poussee': 'thrust', 'consigne': 'setpoint',
    'avant_droit': 'front_right', 'avant_gauche': 'front_left', 'arriere_droit': 'rear_right',
    'arriere_gauche': 'rear_left', 'tension_batterie': 'battery_voltage',
    'tension_de_batterie': 'battery_voltage'}
"""Words, or several with _ between them, without their accents."""

_WORD = re.compile(rf'(?<![a-z0-9])(?:{"|".join(sorted(WORDS, key=len, reverse=True))})'
                   '(?![a-z0-9])')


def without_accents(text: str) -> str:
    """Return a text whose letters have no accents and no dots."""
    return ''.join(letter for letter in unicodedata.normalize('NFKD', text.replace('ß', 'ss'))
                   if not unicodedata.combining(letter))


def in_english(name: str) -> str:
    """Return a name in small letters, with _ between its parts, in English."""
    return re.sub('_+', '_', _WORD.sub(lambda word: WORDS[word.group()], name)).strip('_')
