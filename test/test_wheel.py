# SPDX-License-Identifier: Apache-2.0
"""The wheel in an environment of its own: one command, the scenes, no ROS.

The environment sees the packages that the wheel depends on through a path file, so the test needs
no network; nothing of this source tree is on its path.
"""

import importlib.metadata
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
MADE_HERE = {'build', 'install', 'log', 'recordings', 'study', 'study-full'}
CLEAN = {name: value for name, value in os.environ.items()
         if name not in ('PYTHONPATH', 'AMENT_PREFIX_PATH')}

# from this version on setuptools builds wheels without the package wheel
BUILDS_WHEELS = (70, 1)


def missing():
    """Return what is missing here to build a wheel, or ''."""
    if importlib.util.find_spec('pip') is None:
        return 'pip is not installed'
    version = tuple(map(int, importlib.metadata.version('setuptools').split('.')[:2]))
    alone = version >= BUILDS_WHEELS or importlib.util.find_spec('wheel')
    return '' if alone else 'this setuptools needs the package wheel'


pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or 'nothing is missing')


def not_copied(folder, names):
    """Return the names in a folder that are not sources."""
    made = MADE_HERE if pathlib.Path(folder) == ROOT else set()
    return [name for name in names
            if name in made or name[0] == '.' or name.endswith(('.egg-info', '__pycache__'))]


@pytest.fixture(scope='module')
def built(tmp_path_factory):
    """Return the paths of the source distribution and of the wheel that is built from it."""
    folder = tmp_path_factory.mktemp('built')
    shutil.copytree(ROOT, folder / 'tree', ignore=not_copied)
    python(folder / 'tree', 'setup.py', '-q', 'sdist', '-d', folder / 'dist')
    [source] = (folder / 'dist').glob('*.tar.gz')
    python(folder, '-m', 'pip', 'wheel', '-q', '--no-deps', '--no-build-isolation', '--no-index',
           '-w', folder / 'dist', source)
    [wheel] = (folder / 'dist').glob('*.whl')
    return source, wheel


def python(folder, *arguments):
    done = subprocess.run([sys.executable, *map(str, arguments)], cwd=folder, env=CLEAN,
                          capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope='module')
def environment(built, tmp_path_factory):
    """Return (bin folder, names in it before, names in it after the wheel was installed)."""
    folder = tmp_path_factory.mktemp('environment')
    python(folder, '-m', 'venv', '--without-pip', folder)
    before = {path.name for path in (folder / 'bin').iterdir()}
    python(folder, '-m', 'pip', '--python', folder / 'bin' / 'python', 'install', '-q',
           '--no-deps', '--no-index', built[1])
    after = {path.name for path in (folder / 'bin').iterdir()}
    [site] = folder.glob('lib/python3.*/site-packages')
    (site / 'dependencies.pth').write_text(sysconfig.get_path('purelib') + '\n')
    return folder / 'bin', before, after


def run(bin_folder, *arguments):
    """Run the installed command in the folder of executables; return its output."""
    done = subprocess.run([bin_folder / 'rigid_body_sim', *arguments], cwd=bin_folder, env=CLEAN,
                          capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_one_command_lands_in_bin(environment):
    _, before, after = environment
    assert after - before == {'rigid_body_sim'}


def test_it_lists_its_commands_and_says_its_version(environment):
    shown = run(environment[0], '--help')
    assert shown.startswith('usage: rigid_body_sim NAME') and '  simulate ' in shown
    name, version = run(environment[0], '--version').split()
    assert name == 'rigid_body_sim' and f'<version>{version}</version>' in (
        ROOT / 'package.xml').read_text()


def test_a_scene_runs_from_the_installed_files(environment):
    bin_folder = environment[0]
    shown = run(bin_folder, 'simulate', '--scene', 'tennis_racket', '--duration', '2')
    assert 'tennis_racket by exact: 2000 ticks' in shown
    where = subprocess.run([bin_folder / 'python', '-c', 'import rigid_body_sim as r; '
                            'print(r.__file__, len(r.scene_names()))'], cwd=bin_folder, env=CLEAN,
                           capture_output=True, text=True, timeout=60, check=True).stdout.split()
    assert pathlib.Path(where[0]).is_relative_to(bin_folder.parent)
    assert int(where[1]) == len(list((ROOT / 'config' / 'scenes').glob('*.yaml')))


def test_a_missing_package_is_one_line_with_its_remedy(environment, tmp_path):
    # makes the import of rclpy fail, as if it were not installed
    code = ("import sys; sys.modules['rclpy'] = None; sys.argv = ['rigid_body_sim', 'sim_node']\n"
            'from rigid_body_sim.__main__ import main; sys.exit(main())')
    done = subprocess.run([environment[0] / 'python', '-c', code], cwd=tmp_path, env=CLEAN,
                          capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    [line] = done.stderr.splitlines()
    assert 'rclpy is not installed' in line and 'pip install' in line


def test_a_recording_needs_neither_ros_nor_rosbags_nor_numba(environment, tmp_path):
    absent = ['numba', 'rosbags', 'builtin_interfaces', *(f'{name}_msgs' for name in (
        'diagnostic', 'geometry', 'nav', 'rosgraph', 'sensor', 'std', 'tf2', 'visualization'))]
    code = (f'import sys; sys.modules |= dict.fromkeys({absent})\n'
            'from rigid_body_sim.__main__ import main; sys.exit(main())')
    for words in (['simulate', '--scene', 'tennis_racket', '--duration', '0.5', '--publish',
                   'tf', 'odom', '--output', 'racket'],
                  ['resimulate', 'racket']):
        done = subprocess.run([environment[0] / 'python', '-c', code, *words], cwd=tmp_path,
                              env=CLEAN, capture_output=True, text=True, timeout=240)
        assert done.returncode == 0, done.stderr
    assert done.stdout.startswith('identical, 501 states')


def test_completion_offers_commands_and_scenes(environment):
    if not shutil.which('bash'):
        pytest.skip('needs bash')
    script = run(environment[0], '--completion', 'bash')

    def offered(*words):
        ask = (f'{script}\nCOMP_WORDS=({" ".join(words)})\nCOMP_CWORD={len(words) - 1}\n'
               '_rigid_body_sim\nprintf "%s\\n" "${COMPREPLY[@]}"')
        return subprocess.run(['bash', '-c', ask], capture_output=True, text=True, timeout=30,
                              check=True).stdout.split()

    assert offered('rigid_body_sim', 'sim') == ['sim_node', 'simulate']
    assert offered('rigid_body_sim', 'simulate', '--scene', 'tenn') == ['tennis_racket']


def test_the_wheel_has_the_data_files_of_the_tree(built):
    names = zipfile.ZipFile(built[1]).namelist()
    shared = {name.partition('/share/rigid_body_sim/')[2] for name in names if '/share/' in name}
    for folder in ('config', 'launch', 'examples'):
        for path in (ROOT / folder).rglob('*'):
            if path.is_file() and path.suffix != '.pyc':
                assert path.relative_to(ROOT).as_posix() in shared, path
    assert 'rigid_body_sim/py.typed' in names
    assert not [name for name in names if name.startswith('test')]


def test_the_source_distribution_has_all_that_the_tests_need(built):
    with tarfile.open(built[0]) as archive:
        names = {name.partition('/')[2] for name in archive.getnames()}
    for folder in ('rigid_body_sim', 'test', 'config', 'launch', 'requirements', 'docs'):
        for path in (ROOT / folder).rglob('*'):
            if path.is_file() and '__pycache__' not in path.parts:
                assert path.relative_to(ROOT).as_posix() in names, path
