# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""MJCF models with the files that they include."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.source import is_file, Source, text_of
from quad_ident_ros.vehicle_files.xml_tree import Element, parse


def parsed(source: Source) -> Element:
    """Return the tree of a model, what other files have in the place of <include>; InputError."""
    root = parse(source.path, source.text)
    return _expanded(root, Path(source.path).parent, '', {Path(source.path).resolve()})


def _expanded(element: Element, folder: Path, beside: str, seen: set[Path]) -> Element:
    """Return an element with its children; beside: as of Element; seen: files that are in it."""
    return replace(element, beside=beside,
                   children=list(_children(element, folder, beside, seen)))


def _children(element: Element, folder: Path, beside: str, seen: set[Path]) -> Iterator[Element]:
    for child in element.children:
        if child.tag != 'include':
            yield _expanded(child, folder, beside, seen)
            continue
        name = child.get('file')
        # As in MuJoCo, names count from the folder of the whole model, or else from that of the
        # file that has them, and each file is taken once.
        path = next((each for each in (folder / name, Path(child.path).parent / name)
                     if is_file(each)), folder / name)
        if not is_file(path):
            raise InputError(f'{child.where}: {name[:100]!r} is not beside the model; put it '
                             'there, or save the whole model with `mj_saveLastXML`')
        if path.resolve() in seen:
            raise InputError(f'{child.where}: {name[:100]!r} is included twice, which MuJoCo '
                             'refuses; take one out')
        seen.add(path.resolve())
        yield from _children(parse(str(path), text_of(path)), folder, name, seen)
