# SPDX-License-Identifier: Apache-2.0
"""check_scenes: how made-up quantities are told, counted and judged."""

import json
import math

import pytest

from rigid_body_sim.study import check_scenes
from rigid_body_sim.study.scenes.quantity import Quantity

ROWS = [
    {'exact': Quantity('period', 2.0, 2.5, 0.5, 's'), 'dop8': Quantity('period', 2.0, 1.5, 0.5)},
    {'exact': Quantity('rates', [1.0, 2.0, 3.0, 4.0], [1.5, 2.0, 3.0, 4.0], 1.0, absolute=True,
                       as_written=[1.0, 2.0, 3.0, 8.0], detail='by hand'),
     'dop8': Quantity('rates', [1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, math.nan], 1.0,
                      absolute=True)},
    {'both': Quantity('sizes', [1.0, 2.0, 4.0], [0.5, 1.0, 3.0], 1e-9, bound=True)}]
TOLD = """  period (s)
      predicted 2  measured 2.5  relative error: exact 2.5e-01, dop8 2.5e-01  tolerance 5e-01  \
confirmed
  rates
      predicted (1, 2, 3, ...)  measured (1.5, 2, 3, ...)  absolute error: exact 5.0e-01, dop8 nan\
  tolerance 1e+00  NOT CONFIRMED
      uncorrected, the notes give (1, 2, 3, ...): off by 4.0e+00
      by hand
  sizes
      predicted (1, 2, 4)  measured (0.5, 1, 3)  bound, relative error: both 0.0e+00  \
tolerance 1e-09  confirmed

3 quantities of 1 systems: 2 confirmed, 1 not; """


@pytest.mark.parametrize(('name', 'about'), [
    ('tennis_racket', ''), (check_scenes.SHAPES, 'Moments of inertia of simple bodies (notes, ')])
@pytest.mark.parametrize(('rows', 'status'), [(ROWS, 1), (ROWS[::2], 0)])
def test_quantities_are_told_and_counted(monkeypatch, capsys, name, about, rows, status):
    monkeypatch.setattr(check_scenes, 'confirm', lambda scene: rows)
    monkeypatch.setattr(check_scenes, 'confirm_shapes', lambda: rows)
    assert check_scenes.main(['--scene', name]) == status
    said = capsys.readouterr().out
    assert said.startswith(f'{name}: {about}')
    if status:
        assert TOLD in said
    assert check_scenes.main(['--scene', name, '--json']) == status
    found = json.loads(capsys.readouterr().out)
    assert (found['quantities'], found['failed']) == (len(rows), status)
    [of_one] = found['scenes']
    assert of_one['scene'] == name
    first, last = of_one['quantities'][0], of_one['quantities'][-1]
    assert first == {
        'quantity': 'period', 'unit': 's', 'predicted': 2.0,
        'measured': {'exact': 2.5, 'dop8': 1.5}, 'error': {'exact': 0.25, 'dop8': 0.25},
        'tolerance': 0.5, 'kind': 'relative', 'verdict': 'confirmed'}
    assert last['measured'] == {'both': [0.5, 1.0, 3.0]}
    if status:
        rates = of_one['quantities'][1]
        assert rates['measured']['dop8'] == [1.0, 2.0, 3.0, 'nan']
        assert rates['error'] == {'exact': 0.5, 'dop8': 'nan'}
        assert (rates['as_written'], rates['error_as_written'], rates['detail']) == (
            [1.0, 2.0, 3.0, 8.0], 4.0, 'by hand')


@pytest.mark.parametrize('arguments', [
    [], ['--scene', check_scenes.SHAPES],
    ['--scene', 'heavy_top', '--scene', check_scenes.SHAPES]])
def test_a_change_is_of_a_named_scene(arguments, capsys):
    assert check_scenes.main([*arguments, '--set', 'initial.spin=1']) == 2
    assert 'name the scene it changes' in capsys.readouterr().err
