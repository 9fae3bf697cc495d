# SPDX-License-Identifier: Apache-2.0
"""Pictures as they were when last looked at, kept beside the tests, so no change goes unseen.

A picture is plain data here: what is drawn, with which colours, sizes and words. Arrays are kept
by their shape, bounds, mean and a few samples. After a change that is meant::

    RIGID_BODY_SIM_KEEP=1 python -m pytest test/analysis/test_kept.py
"""

import json
import math
import os
import pathlib
import re

import numpy as np

FOLDER = pathlib.Path(__file__).parent / 'data' / 'kept'
NEAR = 1e-6    # pictures have single precision; nothing that is seen is smaller
NOTHING = 1e-9    # NEAR of it is the rounding of what is 0 or a residual


def brief(value):
    """Return a picture as plain data, its arrays in brief."""
    if isinstance(value, dict):
        return {str(key): brief(one) for key, one in value.items()}
    if isinstance(value, np.ndarray) or (
            isinstance(value, (list, tuple)) and len(value) > 24 and _numeric(value)):
        return _in_brief(np.asarray(value))
    if isinstance(value, (list, tuple, set)):
        return [brief(one) for one in value]
    if isinstance(value, np.generic):
        return value.item()
    return value if isinstance(value, (str, int, float, bool, type(None))) else str(type(value))


def _numeric(value):
    return np.asarray(value).dtype.kind in 'fiub'


def _in_brief(array):
    if array.dtype.kind not in 'fiub' or array.size < 13:
        return array.tolist()
    flat = array.astype(float).ravel()
    good = flat[np.isfinite(flat)]
    return {'shape': list(array.shape), 'holes': int(flat.size - good.size),
            'least': float(good.min()), 'most': float(good.max()), 'mean': float(good.mean()),
            'size': float(np.abs(good).mean()), 'some': flat[::-(-flat.size // 7)].tolist()}


def differences(found, kept, where='', scale=0.0):
    """Yield a line for each place where two pictures differ by more than NEAR of their size."""
    if isinstance(found, dict) and isinstance(kept, dict):
        scale = max(abs(kept['least']), abs(kept['most'])) if 'holes' in kept else 0.0
        for key in sorted({*found, *kept}):
            if key not in found or key not in kept:
                yield f'{where}.{key}: {"gone" if key in kept else "new"}'
            else:
                yield from differences(found[key], kept[key], f'{where}.{key}', scale)
    elif isinstance(found, list) and isinstance(kept, list) and len(found) == len(kept):
        for place, (one, other) in enumerate(zip(found, kept, strict=True)):
            yield from differences(one, other, f'{where}[{place}]', scale)
    elif isinstance(found, float) and isinstance(kept, (int, float)):
        far = abs(found - kept) > NEAR * max(abs(kept), scale, NOTHING)
        if far or math.isnan(found) != math.isnan(kept):
            yield f'{where}: {found!r} was {kept!r}'
    elif isinstance(found, str) and isinstance(kept, str) and found != kept:
        (words, numbers), (others, before) = (_split(text) for text in (found, kept))
        if words != others:
            yield f'{where}: {found!r} was {kept!r}'
        yield from differences(numbers, before, where)
    elif found != kept:
        yield f'{where}: {found!r} was {kept!r}'


def _split(text):
    """Return the words between the numbers of a text, and the numbers."""
    parts = re.split(r'(\d+\.\d*(?:e[-+]\d+)?)', text)
    return parts[::2], list(map(float, parts[1::2]))


def drawn(figure):
    """Return what a figure of matplotlib shows."""
    from matplotlib.collections import Collection
    from matplotlib.colors import to_hex

    def line(one):
        return {'label': one.get_label(), 'color': to_hex(one.get_color()),
                'style': [one.get_linestyle(), one.get_marker(), one.get_drawstyle()],
                'sizes': [one.get_linewidth(), one.get_markersize()],
                'x': np.asarray(one.get_xdata(), float), 'y': np.asarray(one.get_ydata(), float)}

    def axes(one):
        return {
            'labels': [one.get_xlabel(), one.get_ylabel()], 'scale': one.get_yscale(),
            'limits': [*one.get_xlim(), *one.get_ylim()], 'lines': list(map(line, one.lines)),
            'texts': [[text.get_text(), *getattr(text, 'xy', ()), *text.get_position(),
                       text.get_fontsize()] for text in one.texts],
            'patches': [[to_hex(patch.get_facecolor()), *patch.get_extents().bounds]
                        for patch in one.patches],
            'legend': [text.get_text() for text in one.get_legend().get_texts()]
            if one.get_legend() else None,
            'collections': [[len(part.get_paths()), len(part.get_offsets()),
                             *map(float, part.get_linewidth())][:4]
                            for part in one.collections if isinstance(part, Collection)]}
    return {'size': list(figure.get_size_inches()), 'title': figure.get_suptitle(),
            'axes': list(map(axes, figure.axes))}


def check(name, found):
    """Compare a picture with the one that is kept under a name; RIGID_BODY_SIM_KEEP keeps it."""
    path, found = FOLDER / f'{name}.json', json.loads(json.dumps(brief(found)))
    if os.environ.get('RIGID_BODY_SIM_KEEP'):
        lines = re.sub(r'(?<=[}\]"]), (?=[{"\[])', ',\n', json.dumps(found, ensure_ascii=False))
        path.write_text(f'{lines}\n', encoding='utf-8')
    kept = json.loads(path.read_text(encoding='utf-8'))
    changed = list(differences(found, kept, name))
    assert not changed, '\n'.join(changed[:20])
