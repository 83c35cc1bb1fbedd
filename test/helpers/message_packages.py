# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Packages of messages that are not to be had as wheels, built for rclpy from their definitions.

The generators of rosidl come with the wheels of rclpy, the C compiler has to be there.
"""

import json
from pathlib import Path
import shutil
import subprocess
import sys
import sysconfig

import numpy
import pytest

DEFINITIONS = Path(__file__).parents[2] / 'quad_ident_ros' / 'data' / 'definitions'
FAST, INTROSPECTION = 'rosidl_typesupport_fastrtps_c', 'rosidl_typesupport_introspection_c'
NEEDED = ('std_msgs', 'builtin_interfaces', 'geometry_msgs')
"""Packages whose messages those of others consist of."""


def shipped(package, *names):
    """Return the definitions that quad_ident_ros ships of messages, the usual version of each."""
    return {name: (DEFINITIONS / package / f'{name}.msg').read_text() for name in names}


def build(package, definitions, folder):
    """
    Build messages, name -> definition, of a package into folder/package.

    The folder is then one to import from. Skips the test where a generator or the compiler is
    missing.
    """
    prefix = Path(sys.prefix)
    if not shutil.which('g++') or not Path(sysconfig.get_paths()['include'], 'Python.h').exists():
        pytest.skip('no C++ compiler and headers of Python to build messages with')
    if not (prefix / 'include' / 'rosidl_typesupport_fastrtps_c').exists():
        pytest.skip('the headers of rosidl are not beside this Python')
    reason = 'the generators of rosidl are not installed'
    adapter, c, types, fastrtps, introspection, support, python = (
        pytest.importorskip(name, reason=reason) for name in (
            'rosidl_adapter', 'rosidl_generator_c', 'rosidl_generator_type_description',
            FAST, INTROSPECTION, 'rosidl_typesupport_c', 'rosidl_generator_py'))
    work, out = folder / f'{package}_definitions', folder / package
    (work / 'msg').mkdir(parents=True)
    for name, text in definitions.items():
        path = Path('msg', f'{name}.msg')
        (work / path).write_text(text)
        adapter.convert_to_idl(work, package, path, work)
    common = {
        'package_name': package, 'output_dir': str(out), 'target_dependencies': [],
        'idl_tuples': [f'{work}:msg/{name}.idl' for name in definitions],
        'include_paths': [f'{name}:{prefix / "share" / name}' for name in NEEDED],
        'ros_interface_dependencies': [
            f'{name}:{path}' for name in NEEDED for path in
            sorted((prefix / 'share' / name / 'msg').glob('*.idl'))],
        'type_description_tuples': [f'msg/{name}.idl:{out / "msg" / name}.json'
                                    for name in definitions]}
    for generator, generate in (
            ('rosidl_generator_type_description', types.generate_type_hash),
            ('rosidl_generator_c', c.generate_c),
            (FAST, fastrtps.generate_typesupport_fastrtps_c),
            (INTROSPECTION, introspection.generate_c),
            ('rosidl_typesupport_c', lambda told: support.generate_c(told, [FAST, INTROSPECTION])),
            ('rosidl_generator_py',
             lambda told: python.generate_py(told, ['rosidl_typesupport_c']))):
        told = work / f'{generator}.json'
        template = prefix / 'share' / generator / 'resource'
        told.write_text(json.dumps({**common, 'template_dir': str(template)}))
        generate(str(told))
    _visibility(package, prefix, out)
    (out / '__init__.py').touch()
    _compile(package, prefix, out)


def _visibility(package, prefix, out):
    for generator in ('rosidl_generator_c', FAST, INTROSPECTION):
        name = f'{generator}__visibility_control.h'
        text = (prefix / 'share' / generator / 'resource' / f'{name}.in').read_text()
        (out / 'msg' / name).write_text(text.replace('@PROJECT_NAME@', package).replace(
            '@PROJECT_NAME_UPPER@', package.upper()))


def _compile(package, prefix, out):
    """
    Compile what was generated into the module that rclpy asks for.

    The support of types looks two libraries up by their names: one has all, the other leads to it.
    """
    include, lib = prefix / 'include', prefix / 'lib'
    folders = [out.parent, sysconfig.get_paths()['include'], numpy.get_include(), include,
               *(path for path in include.iterdir() if path.is_dir())]
    objects = {}
    for source in (path for path in out.rglob('*.c*') if path.suffix in ('.c', '.cpp')):
        objects[source] = f'{source}.o'
        _run(['gcc' if source.suffix == '.c' else 'g++', '-O0', '-fPIC', '-w', '-c', str(source),
              '-o', objects[source], *(f'-I{folder}' for folder in folders)])
    of_python = [one for path, one in objects.items() if path.stem.startswith('_')]
    needed = [str(path) for name in NEEDED for path in sorted(lib.glob(f'lib{name}__rosidl*'))
              if '_cpp' not in path.name]
    needed += [str(lib / f'lib{name}.so') for name in (
        'rosidl_runtime_c', 'rosidl_typesupport_c', FAST, INTROSPECTION, 'fastcdr', 'rmw')]
    libraries = [out / f'lib{package}__{name}.so' for name in (FAST, INTROSPECTION)]
    link = ['g++', '-shared', '-Wl,--no-as-needed', f'-Wl,-rpath,{lib}', f'-Wl,-rpath,{out}', '-o']
    _run([*link, str(libraries[0]), f'-Wl,-soname,{libraries[0].name}',
          *(one for one in objects.values() if one not in of_python), *needed])
    _run([*link, str(libraries[1]), f'-Wl,-soname,{libraries[1].name}', str(libraries[0])])
    _run([*link, str(out / f'{package}_s__rosidl_typesupport_c.so'), *of_python,
          *map(str, libraries), *needed])


def _run(command):
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, f'{" ".join(command)}\n{done.stderr[-3000:]}'
