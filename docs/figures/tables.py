# SPDX-License-Identifier: Apache-2.0
"""Tables of docs/systems/*.md and docs/corrections.md, made from the results of check_scenes.

A page marks the place of a table by ``<!-- check_scenes: SCENE -->`` or ``<!-- corrections -->``;
``<!-- check_scenes: SCENE only WORD; WORD -->`` takes the rows that begin with these words. The
lines up to ``<!-- end -->`` are generated. Numbers have the digits that their tolerance
guarantees, so they are the same on every machine.
"""

import functools
import math
import pathlib
import re

import numpy as np

from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.study.scenes.confirm import confirm, confirm_shapes

DOCS = pathlib.Path(__file__).resolve().parent.parent
MARK = re.compile(
    r'(<!-- (check_scenes: (\w+)(?: only ([^>]*?))?|corrections) -->\n).*?(<!-- end -->)',
    re.DOTALL)
ERRATA = (      # section of the notes, subject, scene, and the quantity that tells the two apart
    ('Symmetric top (no gravity)', 'Ω = ω3 (I3 − I1)/**I1**, not /I3', 'symmetric_top',
     'Omega of omega round e3 in the body'),
    ('Chandler wobble', 'the same, for the Earth', 'chandler_wobble',
     'period of the wobble (turns of the Earth)'),
    ('Asymmetric top', '**I2** η2′ = (I3 − I1) ω0 η1, not I1 η2′', 'asymmetric_top',
     "eta1', eta2' of the linear equations"),
    ('Asymmetric top', 'Ω² has I1 I2 below (right in the notes), not I1² as their equations give',
     'asymmetric_top', 'Omega, over the formula, in the limit'),
    ('Billiard ball, struck above 2a/5', 't = (2 v0/(**7** μ g)) (5h/(2a) − 1), not 2 v0/(μ g)',
     'billiard_follow', 'onset of rolling'),
    ("Kater's pendulum", 'I_Q = M **l l′** = M (l² + a²), not M (l + a²/l)', 'kater_pendulum',
     'I_Q = M g l/Omega^2'),
    ('Baseball bat', '**l l′** = l² + a², not l′² = l² + a²', 'baseball_bat',
     'centre of percussion'),
    ('Small oscillations about equilibrium', 'V_eff″ of the notes holds at β0 only', 'heavy_top',
     "V_eff'' off equilibrium, at 0.5219 rad"),
    ('Fast top', 'precession **M g l/P_γ**, not I1 M g l/P_γ', 'fast_top',
     'mean precession M g l/P_gamma, over the formula, in the limit'),
    ('Fast top', 'nutation **P_γ/I1**, not its square', 'fast_top',
     'nutation P_gamma/I1, over the formula, in the limit'),
)


@functools.cache
def rows(scene):
    """Return {name with unit: Quantity} of a scene, measured by its first method."""
    found = confirm_shapes() if scene == 'inertia_tensors' else confirm(load_scene(scene))
    return {name(quantity): quantity for row in found for quantity in list(row.values())[:1]}


def name(quantity):
    """Return the name with the unit."""
    return f'{quantity.name} ({quantity.unit})' if quantity.unit else quantity.name


def fill():
    """Write the tables into the pages."""
    for path in pages():
        path.write_text(filled(path.read_text()))


def pages():
    """Return the paths of the pages with tables."""
    return [*sorted((DOCS / 'systems').glob('*.md')), DOCS / 'corrections.md']


def filled(text, scenes=None):
    """Return a page with new tables; with `scenes`, only those of these scenes are new."""
    def table(match):
        scene = match[3]
        if scenes is not None and scene not in scenes:
            return match[0]
        only = tuple(match[4].split('; ')) if match[4] else ('',)
        lines = scene_table(scene, only) if scene else corrections()
        return match[1] + '\n'.join(lines) + '\n' + match[5]
    return MARK.sub(table, text)


def scene_table(scene, only=('',)):
    """Return the lines of the table of a scene: the rows that begin with one of these words."""
    lines = ['| quantity | predicted | measured | tolerance |', '|---|---|---|---|']
    for title, quantity in rows(scene).items():
        if not title.startswith(only):
            continue
        digits = digits_of(quantity)
        relation = '≤ ' if quantity.bound else ''
        measured = shown(quantity.measured, digits)
        if quantity.absolute and not np.any(quantity.predicted):
            measured = f'below {quantity.tolerance:.0e}'
        if quantity.detail.startswith(('deviation', 'change over')):
            measured += f': {quantity.detail}'
        kind = ' absolute' if quantity.absolute else ''
        cells = (title.replace('|', '\\|'), relation + shown(quantity.predicted, digits), measured,
                 f'{quantity.tolerance:.0e}{kind}')
        lines.append(f'| {" | ".join(cells)} |')
    return lines


def correction(section, right, scene, title):
    """Return one row of the page of corrections."""
    quantity = next(quantity for full, quantity in rows(scene).items()
                    if title in (full, quantity.name))
    digits = min(digits_of(quantity), 9)
    measured, written = shown(quantity.measured, digits), shown(quantity.as_written, digits)
    return (f'| {section} | {right} | `{scene}`: {name(quantity)} | {measured} '
            f'| {shown(quantity.predicted, digits)} | {written} |')


def corrections():
    """Return the lines of the table of corrections."""
    return ['| section | correction | scene: quantity | measured | corrected formula '
            '| the notes |',
            '|---|---|---|---|---|---|',
            *(correction(*erratum) for erratum in ERRATA)]


def digits_of(quantity):
    """Return the digits that the tolerance guarantees, 2 to 10."""
    return min(10, max(
        2, math.ceil(-math.log10(quantity.tolerance)) if quantity.tolerance else 10))


def shown(value, digits, inside=False):
    """Return a number, or the first three of many, to some digits."""
    if np.ndim(value):
        entries = np.ravel(value)
        if len(entries) > 3 and np.all(entries == entries[0]):
            return shown(entries[0], digits)
        size = np.abs(entries).max()
        first = [0.0 if abs(entry) < 10.0 ** -digits * size else entry for entry in entries[:3]]
        return (f'({", ".join(shown(entry, digits, True) for entry in first)}'
                f'{", ..." if len(entries) > 3 else ""})')
    text = f'{value:.{digits}g}'
    if 'e' in text:
        return f'{value:.{digits - 1}e}'
    # the zeros of 1.000000000 tell how close the number is to 1
    return text if inside or not value else f'{value:#.{digits}g}'
