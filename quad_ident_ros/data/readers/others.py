# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Files that are not flight records, by their content, and what to give instead."""

from collections.abc import Callable
from pathlib import Path
import re
import stat
import zlib

from quad_ident_ros.errors import InputError

START = 4096        # bytes that show what a file is: a tar archive says it at 257
GZIP = b'\x1f\x8b'
_CONTROL = 0.02     # share of control characters: numbers in binary have more, damaged text less
_SHOWN = 3          # files of a folder that its message names

_GIVE = 'give the log, the bag or the table of a flight'
_UNPACK = 'unpack it and give the file of the flight that is in it'
_WRITE = 'write the flight from there as CSV (writetable)'
_GPS = 'it has no rates and no commands; give the log that it was made from'

_MAGIC = (
    (b'\x89PNG', 'a picture (PNG)', _GIVE), (b'\xff\xd8\xff', 'a picture (JPEG)', _GIVE),
    (b'GIF8', 'a picture (GIF)', _GIVE), (b'II*\0', 'a picture (TIFF)', _GIVE),
    (b'MM\0*', 'a picture (TIFF)', _GIVE), (b'%PDF', 'a PDF document', _GIVE),
    (b'PK\x03\x04', 'a ZIP archive or a spreadsheet', _UNPACK + ', or save the sheet as CSV'),
    (b'PK\x05\x06', 'an empty ZIP archive', _GIVE), (b"7z\xbc\xaf'\x1c", 'a 7z archive', _UNPACK),
    (b'Rar!', 'a RAR archive', _UNPACK), (b'BZh', 'a file packed by bzip2', _UNPACK),
    (b'\xfd7zXZ', 'a file packed by xz', _UNPACK),
    (b'\x28\xb5\x2f\xfd', 'a file packed by zstd', _UNPACK),
    (b'\x7fELF', 'a program', _GIVE),
    (b'\xd0\xcf\x11\xe0', 'a document of Microsoft Office', 'save the sheet as CSV'),
    (b'MATLAB 5.0 MAT-file', 'a MAT file of MATLAB', _WRITE),
    (b'MATLAB 7.3 MAT-file', 'a MAT file of MATLAB', _WRITE),
    (b'\x89HDF', 'an HDF5 file', 'write the flight from there as CSV or Parquet'),
    (b'\x93NUMPY', 'an array of NumPy', 'write it as CSV with a header that names the columns'),
    (b'ARROW1', 'a table of Arrow (Feather)', 'write it as Parquet or CSV'),
    (b'\x80\x04\x95', 'a pickle of Python', 'write the flight from there as CSV or Parquet'),
    (b'\x80\x05\x95', 'a pickle of Python', 'write the flight from there as CSV or Parquet'),
    (b'version https://git-lfs', 'a pointer of Git LFS, not the file itself',
     'get that with: git lfs pull'),
    (b'\xff\xfe', 'text in UTF-16', 'save it as UTF-8'),
    (b'\xfe\xff', 'text in UTF-16', 'save it as UTF-8'),
)

_PICTURES = (b'heic', b'heix', b'hevc', b'hevx', b'mif1', b'msf1', b'avif')
"""Brands of files that are built as videos are, and hold a picture: HEIF and AVIF."""
_RIFF = {b'WEBP': 'a picture (WebP)', b'AVI ': 'a video', b'WAVE': 'a sound'}

_MODES: tuple[tuple[Callable[[int], bool], str], ...] = (
    (stat.S_ISFIFO, 'a pipe, which can be read only once; save it to a file and give that'),
    (stat.S_ISSOCK, f'a socket; {_GIVE}'), (stat.S_ISCHR, f'a device; {_GIVE}'),
    (stat.S_ISBLK, f'a device; {_GIVE}'))

_TIMES = 946_684_800 * 10 ** 6, 4_102_444_800 * 10 ** 6     # us, of the years 2000 to 2100
_MAVLINK = (0xFE, 0xFD)     # how messages of versions 1 and 2 begin
_CONSOLE = re.compile(r'(\x1b\[[\d;]*m)*((INFO|WARN|ERROR) +\[\w+\]|HW arch: |(nsh|pxh)> )')
_JSON = re.compile(r'(\{\s*("|\}|$)|\[\s*([{\["\]]|$))')
_YAML = re.compile(r'(- .*|-|---.*|[^\s:,;#]+:( .*)?|\s.*)$')


def refuse_others(path: Path, start: bytes) -> None:
    """Raise InputError for a file that is known to be none of a flight, by its first bytes."""
    found = _title(start)
    if found:
        title, instead = found
        raise InputError(f'{path}: this is {title}; {instead}')


def title_of(start: bytes) -> str:
    """Return what a file is that is known to be none of a flight, by its first bytes, or ''."""
    found = _title(start)
    return found[0] if found else ''


def refuse_unknown(path: Path, start: bytes, known: str) -> None:
    """Raise InputError for a file that is no text either; known: the kinds that are read."""
    # An invalid letter is an error of a table, which its reader reports with its place.
    control = sum(byte < 32 and byte not in b'\t\r\n\f\x1b' for byte in start)
    if control > _CONTROL * len(start) and not start.startswith(GZIP):
        raise InputError(f'{path}: this kind of file is not known; give {known}')


def refuse_no_file(path: Path) -> None:
    """Raise InputError for what is neither a file nor the folder of a bag; nothing is opened."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        raise InputError(f'{path}: there is no such file; check its path') from None
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    for test, title in _MODES:
        if test(mode):
            raise InputError(f'{path}: this is {title}')
    if stat.S_ISDIR(mode):
        _refuse_folder(path)


def is_text(start: bytes) -> bool:
    """Return whether the first bytes of a file are text in UTF-8."""
    try:
        text = start.decode('utf-8-sig')
    except UnicodeDecodeError as error:
        if error.start < len(start) - 3 or not error.start:   # the last letter may be cut off
            return False
        text = start[:error.start].decode('utf-8-sig')
    return all(letter.isprintable() or letter in '\t\r\n\f\x1b' for letter in text)


def _title(start: bytes) -> tuple[str, str] | None:
    """Return what a file is that is no flight, and what to give instead, or None."""
    for magic, title, instead in _MAGIC:
        if start.startswith(magic):
            return title, instead
    if start[257:262] == b'ustar':
        return 'a tar archive', _UNPACK
    if start[4:8] == b'ftyp':
        return 'a picture (HEIF)' if start[8:12] in _PICTURES else 'a video', _GIVE
    if start.startswith(b'RIFF') and start[8:12] in _RIFF:
        return _RIFF[start[8:12]], _GIVE
    # Two letters may begin anything; behind the size of a bitmap are four reserved zeros.
    if start.startswith(b'BM') and start[6:10] == bytes(4):
        return 'a picture (BMP)', _GIVE
    if start.startswith(GZIP):
        return _packed(start)
    if start and not start.strip(b'\0'):
        return 'a file of zeros', 'copy it from the vehicle again'
    if (len(start) > 8 and start[8] in _MAVLINK
            and _TIMES[0] < int.from_bytes(start[:8], 'big') < _TIMES[1]):
        return ('the telemetry log of a ground station (MAVLink, .tlog)',
                'it is too slow; give the log of the vehicle itself (.ulg, .BIN)')
    return _text_title(start.decode('utf-8-sig', 'ignore')) if is_text(start) else None


def _packed(start: bytes) -> tuple[str, str] | None:
    """Return what is in a gzip file other than text, and what to do, or None."""
    try:
        inside = zlib.decompressobj(31).decompress(start, START)
    except zlib.error:
        return None     # damaged, as the reader of tables says
    if is_text(inside):
        return None
    what = 'a tar archive' if inside[257:262] == b'ustar' else 'no text'
    return f'a file packed by gzip, with {what} in it', _UNPACK


def _text_title(text: str) -> tuple[str, str] | None:
    """Return what a text is that is no table, and what to give instead, or None."""
    head = text.lstrip()
    lower = head[:1024].lower()
    if lower.startswith(('<!doctype html', '<html')):
        return ('a page of the web (HTML)',
                'where it was downloaded as a log, download that again; ' + _GIVE)
    for tag in ('kml', 'gpx'):
        if lower.startswith(f'<{tag}') or lower.startswith('<?xml') and f'<{tag}' in lower:
            return f'a track for maps ({tag.upper()})', _GPS
    if lower.startswith('<?xml'):
        return 'a file in XML', _GIVE
    if _CONSOLE.match(head):
        return 'what PX4 writes to its console', 'give the .ulg file of the flight'
    if _JSON.match(head):
        return 'a file in JSON', _GIVE
    if head.startswith('rosbag2_bagfile_information:'):
        return 'the list of what is in a bag of ROS 2', 'give the folder that it is in'
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith('#')]
    if len(lines) > 1 and not lines[0].startswith(' ') and all(map(_YAML.match, lines[:-1])):
        return ('a file in YAML',
                f'vehicles and mappings go with --vehicle and --mapping; {_GIVE}')
    return None


def _refuse_folder(path: Path) -> None:
    """Raise InputError for a folder that is no bag."""
    if any((path / name).exists() for name in ('metadata.yaml', 'bag/metadata.yaml')):
        return
    names = sorted(one.name for one in path.iterdir() if one.is_file())
    if any(name.endswith(('.mcap', '.db3')) for name in names):
        return      # a bag whose list is missing, as its reader says
    more = ', ...' if len(names) > _SHOWN else ''
    instead = (f'give a file in it ({", ".join(names[:_SHOWN])}{more})' if names else
               'it holds no file')
    raise InputError(f'{path}: this is a folder and not a bag of ROS 2: it has no metadata.yaml; '
                     f'{instead}')
