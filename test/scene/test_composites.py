# SPDX-License-Identifier: Apache-2.0
"""Bodies made of parts: what is small beside the rest is as right as what is large."""

import math
from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.rotations import angle_between, multiply
from rigid_body_sim.scene import composites
from rigid_body_sim.scene.bodies import IDENTITY, make_body, of_shape
from rigid_body_sim.scene.constraints.pivot import DisplacedPivot, Pivot
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

EPS = np.finfo(float).eps


def cylinders(source, orientation):
    """Return three cylinders in one line along the z axis of an orientation; one has a bore.

    Each has a mass, negative for the bore, a radius, a length, a place and the orientation.
    """
    axis = Rotation.from_quat(orientation).as_matrix()[:, 2]
    found = [(source.uniform(0.1, 3.0), 10.0 ** source.uniform(-4.0, -2.0),
              source.uniform(0.2, 1.0), (source.uniform(-1.0, 1.0) * axis).tolist(), orientation)
             for _ in range(3)]
    M, radius, *rest = found[0]
    return [*found, (-0.25 * M, 0.5 * radius, *rest)]


def body_of(parts):
    """Return the composite of such cylinders."""
    made = [of_shape('cylinder', abs(M), {'radius': radius, 'length': length})
            for M, radius, length, _, _ in parts]
    return composites.composite([
        (composites.hole(one) if part[0] < 0.0 else one, *part[3:])
        for one, part in zip(made, parts, strict=True)])


def exact(parts):
    """Return the moments about the centre of mass, rising, and that centre, with 50 digits."""
    with mpmath.workdps(50):
        placed = []
        for M, radius, length, at, orientation in parts:
            across = M * (3 * mpmath.mpf(radius) ** 2 + mpmath.mpf(length) ** 2) / 12
            x, y, z, w = map(mpmath.mpf, orientation)
            # the axis, third column of the rotation matrix: I = across 1 + (I3 - across) e e^T
            e = mpmath.matrix([2 * (x * z + w * y), 2 * (y * z - w * x),
                               w * w + z * z - x * x - y * y]) / (x * x + y * y + z * z + w * w)
            own = across * mpmath.eye(3) + (mpmath.mpf(M) * radius * radius / 2 - across) * e * e.T
            placed.append((mpmath.mpf(M), mpmath.matrix(at), own))
        total = sum(M for M, _, _ in placed)
        center = sum((M * at for M, at, _ in placed), mpmath.zeros(3, 1)) / total
        tensor = mpmath.zeros(3)
        for M, at, own in placed:
            d = at - center
            tensor += own + M * ((d.T * d)[0] * mpmath.eye(3) - d * d.T)
        return sorted(mpmath.eigsy(tensor, eigvals_only=True)), center


@pytest.mark.parametrize('seed', range(8))
def test_the_moments_of_skew_cylinders_in_one_line_are_those_of_fifty_digits(seed):
    source = np.random.default_rng(seed)
    parts = cylinders(source, Rotation.random(random_state=seed).as_quat().tolist())
    inertia, (truths, _) = body_of(parts).about_center, exact(parts)
    found = sorted(zip(inertia.moments, inertia.lost, strict=True))
    # the moments of each part are doubles: measured 1e-16; sums of doubles left 1e-10
    for (moment, less), truth in zip(found, truths, strict=True):
        assert abs(mpmath.mpf(moment) + less - truth) <= 2 * EPS * truth
    # I1 - I2, over I3, turns the needle about its axis: measured 4e-28
    (small, _), (middle, d2), (large, d1) = found
    assert abs((large - middle) + (d1 - d2) - (truths[2] - truths[1])) <= 1e-20 * small


def test_a_pivot_holds_a_skew_needle_by_the_arm_that_its_parts_have():
    """Off the line of the needle the arm is what rounding of the places left, 1e-17 m.

    Its weight turns the needle about the line: that torque is of the parts, and to their digits.
    """
    parts = cylinders(np.random.default_rng(3), Rotation.random(random_state=3).as_quat().tolist())
    body = body_of(parts)
    frame, (_, center) = Pivot().frame(body), exact(parts)
    with mpmath.workdps(50):
        arm = [sum(mpmath.mpf(x.numerator) / x.denominator * c
                   for x, c in zip(row, center, strict=True)) for row in frame.rows]
        along = max(range(3), key=lambda k: abs(arm[k]))
        for k in range(3):
            # measured: 1e-16; that of a centre of mass in doubles is another
            assert abs(frame.arm[k] - arm[k]) <= 1e-14 * abs(arm[k])
            assert k == along or abs(arm[k]) < 1e-15


@pytest.mark.without_numba
def test_a_skew_composite_moves_as_the_one_along_its_axes():
    """The places of the parts are doubles, off the line by 1e-17 m; the motion does not feel it.

    Half an ulp of each number of the start turns the end by up to 4e-15.
    """
    q = Rotation.from_rotvec([0.4, -0.7, 0.2]).as_quat().tolist()
    x, y, z, w = q
    turned = Rotation.from_quat(q)

    def after(parts, orientation, omega):
        text = ', '.join(
            f'{{mass: {M}, shape: {{cylinder: {{radius: {radius}, length: 0.5}}}}, at: {at}, '
            f'orientation: {way}}}' for M, radius, at, way in parts)
        scene = parse_scene(f'scene: needle\nbody: {{parts: [{text}]}}\nconstraint: free\n'
                            f'effects: []\ninitial: {{orientation: {orientation}, '
                            f'angular_velocity: {omega}}}\n')
        return Simulation(scene).states([10.0])[0].orientation
    along = [(1.0, 1e-3, [0.0, 0.0, 0.3], list(IDENTITY)),
             (0.7, 2e-4, [0.0, 0.0, -0.4], list(IDENTITY))]
    skew = [(M, radius, turned.apply(at).tolist(), q) for M, radius, at, _ in along]
    omega = [0.3, 0.2, 5.0]
    straight = after(along, list(IDENTITY), omega)
    found = after(skew, [-x, -y, -z, w], turned.apply(omega).tolist())
    # 4e-15 measured; 8e-13 where the tensor was a sum of doubles
    assert angle_between(*multiply(*found, *q), *straight) <= 5e-14


def test_two_skew_rods_in_one_line_have_no_moment_about_it():
    q = [0.3, 0.1, -0.2, 0.9]
    rods = [(of_shape('rod', 0.2, {'length': 0.7}), (0.0, 0.0, 0.0), q)] * 2
    assert sorted(composites.composite(rods).about_center.moments)[0] == 0.0
    rod = '{mass: 0.2, shape: {rod: {length: 0.7}}, orientation: [0.3, 0.1, -0.2, 0.9]}'
    text = ('scene: rods\nbody: {parts: [%s, %s]}\nconstraint: free\neffects: []\n'
            'initial: {angular_velocity: %s}\n')
    parse_scene(text % (rod, rod, [0.5, 0.75, 0.54]))    # across the line
    with pytest.raises(BadInput, match='whose moment is zero'):
        parse_scene(text % (rod, rod, [0.7, 0.5, -0.4]))


def test_the_centre_of_mass_is_known_beyond_its_doubles():
    ball = of_shape('solid_sphere', 1.0, {'radius': 0.1})
    body = composites.composite([(ball, (0.1, 0.0, 0.0), IDENTITY),
                                 (ball, (0.2, 0.0, 0.0), IDENTITY),
                                 (ball, (0.4, 0.0, 0.0), IDENTITY)])
    with mpmath.workdps(40):
        exact = sum(map(mpmath.mpf, (0.1, 0.2, 0.4))) / 3
        assert abs(body.center_of_mass[0] + mpmath.mpf(body.center_lost[0]) - exact) < 1e-32
    assert body.center_of_mass[1:] == (0.0, 0.0)
    assert math.isclose(body.center_of_mass[0], 0.7 / 3, rel_tol=2 * EPS)


@pytest.mark.parametrize('places', [
    ((0.1, 0.2, -0.7), (0.2, 0.3, 0.1), (0.4, -0.6, 0.3)),
    ((0.1, 0.0, 0.0), (0.2, 0.0, 0.0), (0.4, 0.0, 0.0))], ids=['askew', 'along its own axes'])
def test_the_arm_from_a_pivot_beside_the_centre_is_rounded_once(places):
    """The pivot is the centre as doubles have it: all of the arm is what they lost."""
    ball = of_shape('solid_sphere', 1.0, {'radius': 0.1})
    body = composites.composite([(ball, at, IDENTITY) for at in places])
    exact = [float(sum(map(Fraction, one)) / 3 - Fraction(middle))
             for one, middle in zip(zip(*places, strict=True), body.center_of_mass, strict=True)]
    turn = Rotation.from_quat(body.about_center.axes)
    arm = DisplacedPivot(body.center_of_mass).frame(body).arm
    assert any(exact)
    assert arm == near(turn.apply(exact, inverse=True), rel=4 * EPS)


def test_what_is_small_beside_a_far_part_is_kept():
    ball = of_shape('solid_sphere', 1.0, {'radius': 0.1})
    for x in (0.0, 0.2):
        body = composites.composite([(ball, (0.1 + x, 0.0, 1e60), IDENTITY),
                                     (ball, (0.1 - x, 0.0, -1e60), IDENTITY)])
        assert body.center_of_mass == near((0.1, 0.0, 0.0), rel=2 * EPS)
    corners = [(x, 0.0, z) for x in (-0.2, 0.2) for z in (-1e60, 1e60)]
    moments = composites.composite([(ball, at, IDENTITY) for at in corners]).about_center.moments
    # 4 M z^2 across the line, 4 (2/5 M r^2 + M x^2) about it
    assert moments == near((4e120, 4e120, 0.016 + 0.16), rel=4 * EPS)


def test_what_a_hole_takes_away_is_what_a_part_adds():
    """A skew tensor in doubles, of a slim part, is taken away to the last digit."""
    turn = Rotation.from_rotvec([0.4, -0.7, 0.2]).as_matrix()
    tensor = turn @ np.diag([1.0, 1.0, 1e-6]) @ turn.T
    skew = make_body(1.0, (tensor + tensor.T) / 2.0)
    ball = of_shape('solid_sphere', 1.0, {'radius': 0.1})
    at, orientation = (0.3, 0.1, -0.2), (0.1, 0.5, -0.3, 0.8)
    left = composites.composite([(ball, (0.0, 0.0, 0.0), IDENTITY), (skew, at, orientation),
                                 (composites.hole(skew), at, orientation)])
    assert left == replace(ball, radius=None)


def test_what_only_rounding_leaves_is_zero():
    ball, needle = (of_shape('solid_sphere', 0.3, {'radius': 0.1}),
                    of_shape('cylinder', 0.7, {'radius': 1e-3, 'length': 0.5}))
    in_line = composites.composite([(ball, (0.1, 0.1, 0.0), IDENTITY),
                                    (ball, (-0.2, -0.2, 0.0), IDENTITY),
                                    (ball, (0.1, 0.1, 0.3), IDENTITY)])
    assert in_line.center_of_mass[:2] == (0.0, 0.0)
    eighth = 0.0, 0.0, math.sin(math.pi / 8.0), math.cos(math.pi / 8.0)
    turned = composites.composite([(needle, (0.0, 0.0, 0.1), eighth),
                                   (needle, (0.0, 0.0, 0.4), IDENTITY)]).about_center
    assert (turned.axes, turned.rows) == (IDENTITY, ())
    assert turned.moments[0] == turned.moments[1]


def test_a_slim_composite_along_its_axes_knows_the_difference_of_its_large_moments():
    """Box edges of 1e-3 beside a length of 1: I1 - I2 over I3 turns the body about its axis."""
    bars = [((1e-3, 2e-3, 0.7), 0.3, 0.31), ((3e-3, 1e-3, 0.9), 0.9, -0.17)]
    about = composites.composite([(of_shape('box', M, {'size': size}), (0.0, 0.0, z), IDENTITY)
                                  for size, M, z in bars]).about_center
    made = [of_shape('box', M, {'size': size}).about_center.moments for size, M, _ in bars]
    # both parts lie on the axis: the parallel-axis terms of I1 and I2 are the same
    exact_difference = sum(Fraction(I1) - Fraction(I2) for I1, I2, _ in made)
    # measured: 0; 1e-11 of I3 with moments in doubles
    assert abs(about.differences[2] - exact_difference) <= 1e-20 * about.moments[2]


def test_a_hole_is_what_the_part_adds_with_the_other_sign():
    """Also what rounding took, and the entries of a tensor that was turned."""
    parts = [make_body(2.0, (1.0, 2.0, 2.5), exact=[
        [1 + Fraction(1, 10 ** 17), 0, 0], [0, 2 + Fraction(1, 10 ** 17), 0],
        [0, 0, Fraction(5, 2) - Fraction(1, 10 ** 17)]]),
        make_body(2.0, [[1.0, 0.1, 0.2], [0.1, 2.0, -0.3], [0.2, -0.3, 2.5]], (0.1, 0.2, 0.3))]
    for part in parts:
        hole = composites.hole(part)
        assert hole.mass == -2.0 and hole.center_of_mass == part.center_of_mass
        for found, of in ((hole.about_center, part.about_center),
                          (hole.about_origin, part.about_origin)):
            assert np.array_equal(found.exact, -np.array(of.exact))


def test_a_centre_of_mass_that_is_zero_but_for_the_sixty_digits_is_zero():
    """A half turn about (1, 2, 2) makes (9, 0, 0) to (-7, 4, 4), with ninths on the way."""
    ball, off = (make_body(1.0, (1.0, 1.0, 1.0), center)
                 for center in ((0.0, 0.0, 0.0), (9.0, 0.0, 0.0)))
    found = composites.composite([(off, (0.0, 0.0, 0.0), (1.0, 2.0, 2.0, 0.0)),
                                  (ball, (7.0, -4.0, -4.0), IDENTITY),
                                  (ball, (0.0, 0.0, 0.0), IDENTITY)])
    assert found.exact_center == (0, 0, 0)
