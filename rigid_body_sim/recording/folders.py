# SPDX-License-Identifier: Apache-2.0
"""Folders of recordings: which files a recording has, and which recording is the newest."""

import os
import pathlib

import yaml

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import metadata


def files_of(path):
    """Return the paths of a recording folder's files and its custom_data."""
    where = path / metadata.FILE_NAME
    remedy = 'the folder of a recording; if its recorder was killed, "recover" makes it whole'
    try:
        if os.path.getsize(where) > 2**26:
            raise BadInput(str(where), 'is larger than 64 MB',
                           'a metadata.yaml as rosbag2 writes it')
        bag = metadata.load(where.read_text(encoding='utf-8'))[metadata.ROOT]
        storage, mode = bag['storage_identifier'], bag.get('compression_mode') or ''
        names = [pathlib.PurePath(name).name for name in bag['relative_file_paths']]
        custom = bag.get('custom_data') or {}
        custom = {str(key): str(value) for key, value in custom.items()}
    except OSError as error:
        raise BadInput(str(path),
                       f'holds no {metadata.FILE_NAME} that can be read ({error.strerror})',
                       remedy) from error
    except (UnicodeDecodeError, yaml.YAMLError, KeyError, TypeError, AttributeError,
            RecursionError) as error:
        raise BadInput(str(where), 'is not the metadata of a recording', remedy) from error
    if storage != 'mcap':
        raise BadInput(str(path), f'is stored as {storage!r}',
                       'an mcap recording ("ros2 bag convert" makes one)')
    if mode.lower() in ('file', 'message'):
        raise BadInput(str(path), f'whole {mode.lower()}s of it are compressed',
                       'compressed chunks ("ros2 bag convert" makes them)')
    return [path / name for name in names], custom


def newest_recording(path):
    """Return the recording that a path names, and how many others lie beside it.

    The path is a recording itself, or a folder of recordings: then it is the newest of them.
    Raises BadInput where there is none.
    """
    path = pathlib.Path(path)
    if path.is_file() or _is_recording(path):
        return path, 0
    try:
        found = sorted((one for one in path.iterdir() if one.is_dir() and _is_recording(one)),
                       key=_last_written)
    except OSError as error:
        raise BadInput(str(path), f'cannot be read ({error.strerror})',
                       'a recording, or a folder of recordings') from error
    if not found:
        raise BadInput(str(path), 'holds no recording', 'a recording, or a folder of recordings')
    return found[-1], len(found) - 1


def _last_written(folder):
    # a recording in another format has no such file
    return max((file.stat().st_mtime for file in folder.glob('*.mcap')), default=0.0)


def _is_recording(folder):
    return (folder / metadata.FILE_NAME).is_file() or any(folder.glob('*.mcap'))
