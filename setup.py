# SPDX-License-Identifier: Apache-2.0
"""Build the package, for colcon (ament_python) and for pip.

package.xml is the source of the version, the description and the addresses. It also names the
dependencies by their rosdep keys; here they stand under their names on PyPI.
"""

import pathlib
import runpy
import sys
import xml.etree.ElementTree

from setuptools import find_packages, setup

NAME = 'rigid_body_sim'
ROOT = pathlib.Path(__file__).resolve().parent
manifest = xml.etree.ElementTree.parse(ROOT / 'package.xml').getroot()
# the file is run alone: a build environment does not have the packages that rigid_body_sim imports
SUBCOMMANDS = runpy.run_path(str(ROOT / NAME / 'cli' / 'subcommands.py'))['SUBCOMMANDS']

PLOTS = ['matplotlib>=3.6', 'plotly>=5.0']
TABLES = ['pandas>=2.1', 'pyarrow>=14.0', 'xarray>=2023.6']
EXTRAS = {
    'ros': ['ros-jazzy-rclpy[fastrtps]==7.1.6', 'ros-jazzy-common-interfaces==5.3.6'],
    'fast': ['numba>=0.59'],
    'plots': PLOTS,
    'sweep': [*TABLES, 'dask[distributed]', 'zarr>=3.1'],
    'view': ['viser>=1.0'],
    'test': ['hypothesis', 'mcap-ros2-support', 'pytest', 'pytest-timeout', 'pytest-xdist',
             'rosbags', *TABLES, *PLOTS],
    'docs': [*PLOTS, 'furo', 'latex2mathml', 'myst-nb', 'numpydoc', 'rosdoc2', 'sphinx'],
}


def executables():
    """Return the console scripts.

    colcon and the makers of Debian packages call ``setup.py install`` or ``setup.py develop``;
    they put an executable of each subcommand into lib/rigid_body_sim, where ``ros2 run`` looks
    (setup.cfg). A wheel has the one command ``rigid_body_sim``: names as common as ``run`` and
    ``export`` have no place in the bin folder of an environment.
    """
    if {'install', 'develop'} & set(sys.argv):
        return [f'{name} = {NAME}.__main__:{name}' for name in SUBCOMMANDS]
    return [f'{NAME} = {NAME}.__main__:main']


def shared(folder, *patterns):
    """Return the entry of data_files that puts files of a folder under share/rigid_body_sim."""
    files = sorted(path.relative_to(ROOT).as_posix()
                   for pattern in patterns for path in (ROOT / folder).glob(pattern))
    return f'share/{NAME}/{folder}'.rstrip('/.'), files


def address(kind):
    """Return the address of one kind (website, repository, bugtracker) that package.xml names."""
    return next(element.text for element in manifest.iter('url') if element.get('type') == kind)


setup(
    name=NAME,
    version=manifest.findtext('version'),
    description=manifest.findtext('description'),
    long_description=(ROOT / 'README.md').read_text(encoding='utf-8'),
    long_description_content_type='text/markdown',
    license=manifest.findtext('license'),
    license_files=['LICENSE'],
    author=manifest.findtext('author'),
    author_email=manifest.find('author').get('email'),
    maintainer=manifest.findtext('maintainer'),
    maintainer_email=manifest.find('maintainer').get('email'),
    url=address('website'),
    project_urls={'Source': address('repository'), 'Issues': address('bugtracker')},
    classifiers=[
        'Development Status :: 4 - Beta',
        'Intended Audience :: Education',
        'Intended Audience :: Science/Research',
        'Operating System :: POSIX :: Linux',
        'Programming Language :: Python :: 3.11',
        'Programming Language :: Python :: 3.12',
        'Programming Language :: Python :: 3.13',
        'Topic :: Scientific/Engineering :: Physics',
        'Typing :: Typed',
    ],
    keywords=['rigid body', 'dynamics', 'ROS 2', 'simulation', 'physics'],
    python_requires='>=3.11',
    install_requires=['jsonschema>=4.10', 'mcap>=1.2', 'mpmath>=1.2', 'numpy>=1.26',
                      'PyYAML>=6.0', 'scipy>=1.11', 'tqdm>=4.60'],
    extras_require=EXTRAS,
    packages=find_packages(include=[NAME, f'{NAME}.*']),
    package_data={'': ['*.json', '*.css', '*.js'], NAME: ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        shared('.', 'package.xml'),
        shared('config', '*.yaml', '*.rviz', '*.json', '*.xml'),
        shared('config/scenes', '*.yaml'),
        shared('config/security', '*.xml'),
        shared('config/sweeps', '*.yaml'),
        shared('examples', '*.py'),
        shared('launch', '*.launch.py'),
    ],
    entry_points={'console_scripts': executables()},
    zip_safe=False,
)
