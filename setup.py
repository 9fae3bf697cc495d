"""Build of the ament_python package; its dependencies are in package.xml (apt) and requirements/ (pip)."""

import pathlib
import sys
import xml.etree.ElementTree

from setuptools import find_packages, setup

ROOT = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(ROOT))
from rigid_body_sim.cli.subcommands import COMMANDS  # noqa: E402  (the table imports nothing but the standard library)

NAME = 'rigid_body_sim'
manifest = xml.etree.ElementTree.parse(ROOT / 'package.xml').getroot()


def shared(folder, *patterns):
    """Return the entry of data_files that installs the files of one folder of the tree under share/rigid_body_sim."""
    files = sorted(path.relative_to(ROOT).as_posix() for pattern in patterns for path in (ROOT / folder).glob(pattern))
    return f'share/{NAME}/{folder}'.rstrip('/.'), files


setup(
    name=NAME,
    version=manifest.findtext('version'),
    description=manifest.findtext('description'),
    license=manifest.findtext('license'),
    maintainer=manifest.findtext('maintainer'),
    maintainer_email=manifest.find('maintainer').get('email'),
    packages=find_packages(include=[NAME, f'{NAME}.*']),
    package_data={'': ['*.json', '*.css', '*.js']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        shared('.', 'package.xml'),
        shared('config', '*.yaml', '*.rviz', '*.json'),
        shared('config/scenes', '*.yaml'),
        shared('config/security', '*.xml'),
        shared('launch', '*.launch.py'),
    ],
    entry_points={'console_scripts': [f'{name} = {target}' for name, (target, _) in COMMANDS.items()]},
    extras_require={'test': ['pytest']},
    zip_safe=False,
)
