# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Build and installation of the package, with colcon or with pip."""

from glob import glob
import os

from setuptools import find_packages, setup

PACKAGE = 'quad_ident_ros'
SHARE = f'share/{PACKAGE}'


def files_below(folder):
    """List (destination, files) for every folder below one, for data_files."""
    found = []
    for path, _, names in sorted(os.walk(folder)):
        files = [f'{path}/{name}' for name in sorted(names) if not name.startswith('.')]
        if files:
            found.append((f'{SHARE}/{path}', files))
    return found


setup(
    name=PACKAGE,
    version='0.1.0',
    description='Identification of quadrotors and diagnosis of their sim-to-real gap on ROS 2',
    long_description=(
        'ROS 2 nodes and a command line that simulate a quadrotor, record its flight, identify '
        'the parameters of second-order models of it, with their standard errors, and diagnose '
        'which effects it has that its nominal description does not have.'
    ),
    long_description_content_type='text/plain',
    author='quad_ident_ros contributors',
    maintainer='quad_ident_ros maintainers',
    maintainer_email='maintainers@example.org',
    license='Apache-2.0',
    keywords=['ROS', 'quadrotor', 'system identification', 'sim-to-real'],
    classifiers=[
        'Development Status :: 4 - Beta',
        'Intended Audience :: Science/Research',
        'Operating System :: MacOS',
        'Operating System :: POSIX :: Linux',
        'Programming Language :: Python :: 3',
        'Topic :: Scientific/Engineering',
    ],
    packages=find_packages(include=[PACKAGE, f'{PACKAGE}.*']),
    package_data={f'{PACKAGE}.data.definitions': ['*/*.msg'],
                  f'{PACKAGE}.report': ['web/*']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{PACKAGE}']),
        (SHARE, ['package.xml']),
        (f'{SHARE}/launch', sorted(glob('launch/*.launch.py'))),
        # What `ros2 run` starts, whether colcon or pip installed the package.
        (f'lib/{PACKAGE}', sorted(glob('scripts/*'))),
        *files_below('config'),
    ],
    python_requires='>=3.10',
    install_requires=[
        'numpy>=1.26',
        'scipy>=1.11',
        'numba>=0.58',
        # Later ones have no wheels for Macs of Intel.
        'numba<0.63; sys_platform == "darwin" and platform_machine == "x86_64"',
        'matplotlib>=3.6',
        'PyYAML>=6',
        'rich>=13',
        'rosbags>=0.11.9,<0.12',
        'pyulog>=1.2.4,<1.4',
    ],
    extras_require={'ardupilot': ['pymavlink>=2.4.40'],
                    'betaflight': ['orangebox>=0.4,<0.5'],
                    'fleet': ['distributed>=2025.1', 'pyarrow>=17'],
                    'parquet': ['pyarrow>=17'],
                    'watch': ['textual>=8.2'],
                    'all': ['pymavlink>=2.4.40', 'orangebox>=0.4,<0.5', 'pyarrow>=17',
                            'textual>=8.2', 'distributed>=2025.1'],
                    'test': ['pytest>=7.4', 'pytest-xdist>=3.5', 'hypothesis>=6.80', 'mypy>=2.0',
                             'ruff>=0.4']},
    zip_safe=True,
    entry_points={'console_scripts': ['quad_ident = quad_ident_ros.cli.main:main']},
)
