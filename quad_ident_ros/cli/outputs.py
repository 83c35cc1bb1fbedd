# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What no command may write to."""

from pathlib import Path
import tempfile

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import check_ending

INPUTS = ('flight', 'flights', 'hold_out', 'mapping', 'priors', 'vehicle', 'experiment', 'base')
FILES_READ = ('mapping', 'priors', 'base')
"""Names of the options that name files read, and never folders or what is shipped by name."""
OUTPUTS = ('out', 'output', 'out_vehicle', 'out_priors', 'json', 'report', 'picture',
           'write_mapping')
FILES = ('out_vehicle', 'out_priors', 'json', 'report', 'picture', 'write_mapping')
"""Names of the options, of any command, that name files read, written, and never folders."""
FOLDERS = ('simulate', 'demo', 'paper')
"""Commands whose output is a folder."""
PAGES = ('.html', '.htm')


def check_outputs(options):
    """
    Check, before any work, where the options of a command have it write.

    Raises InputError for an input file that is a folder, for an output that is an input, another
    output, a folder, lies in a file or in a folder that cannot be written to, and for a report or
    vehicle file of another ending. Folders that are not there are made when the file is written.
    """
    for given in _named(options, FILES_READ):
        if Path(given).is_dir():
            raise InputError(f'{given}: this is a folder; name a file')
    inputs, written = _named(options, INPUTS), set()
    for output in _named(options, OUTPUTS):
        refuse_overwriting(output, inputs)
        place = Path(output).resolve()
        if place in written:
            raise InputError(f'{output}: this would write over another output; give each a name '
                             'of its own')
        written.add(place)
        for folder in Path(output).parents:
            if folder.exists() and not folder.is_dir():
                raise InputError(f'{output}: {folder} is a file, not a folder; give another path')
        given = Path(output)    # the link of a pipe names no place
        if not given.exists() or given.is_file() or given.is_dir():
            _try_to_write(output, place)
    if getattr(options, 'command', None) in FOLDERS:
        for output in _named(options, ('output',)):
            if Path(output).is_file():
                raise InputError(f'{output}: this is a file; name a folder')
    for output in _named(options, FILES):
        if Path(output).is_dir():
            raise InputError(f'{output}: this is a folder; name a file')
    for output in _named(options, ('report',)):
        if Path(output).suffix.lower() not in PAGES:
            raise InputError(f'{output}: a report is a page for a browser; name a file that ends '
                             'in .html, and print it to a PDF from there')
    for output in _named(options, ('out_vehicle',)):
        check_ending(output)


def refuse_overwriting(output, inputs):
    """Raise InputError where an output is one of the inputs, or lies in one that is a folder."""
    whole = Path(output).resolve()
    places = [place for place in (whole, *whole.parents) if place.exists()]
    for given in map(Path, inputs):
        if not given.exists() or not any(place.samefile(given) for place in places):
            continue
        if whole.exists() and whole.samefile(given):
            raise InputError(f'{output}: this would write over {given}, which is read; give '
                             'another name')
        raise InputError(f'{output}: this would be written into {given}, a folder that is read; '
                         'name one outside of it')


def _try_to_write(output, place):
    """
    Raise InputError where no file can be made in the folder that is to hold an output.

    Permissions do not say: root has them all. The file's name is as long as the temporary one of
    whole_file.replacing.
    """
    folder, name = (place, '') if place.is_dir() else (
        next(one for one in place.parents if one.exists()), place.name)
    try:
        with tempfile.NamedTemporaryFile(dir=folder, prefix=f'.{name}'):
            pass
    except OSError as error:
        raise InputError(f'{output}: cannot be written into {folder}: {error.strerror}; give '
                         'another path, or see to its permissions') from None


def _named(options, names):
    """Return the paths that options name; - is standard output, and no path."""
    values = [getattr(options, name, None) for name in names]
    paths = [path for value in values if value
             for path in (value if isinstance(value, list) else [value])]
    return [path for path in paths if path != '-']
