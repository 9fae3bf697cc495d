# SPDX-License-Identifier: Apache-2.0
"""Orekit (Java): TorqueFree, its closed form of a body that turns freely, called through JPype.

It has Jacobi's functions for omega; the angle that is left it integrates by steps over one
period, when a motion is made. Other motions need its numerical propagators of satellites.
"""

import importlib.metadata

from rigid_body_sim.study.precision.peers import body, given
from rigid_body_sim.study.precision.runner import RefusedError, Run, Runner

NAME = 'Orekit'


def version():
    """Return the version that is installed."""
    import orekit_jpype  # noqa: F401  (the virtual machine starts when a run is made)
    return importlib.metadata.version('orekit-jpype')


def runners(problem, reference):
    """Yield the closed form."""
    numbers = given.of(problem)
    if (not isinstance(numbers, body.Body) or problem.scene.constraint.kind != 'free'
            or numbers.torques() or numbers.inner):
        raise RefusedError('anything but a free rotation: it takes satellites and their orbits')
    yield Runner(NAME, 'none', (None,), lambda _: _run(numbers), True)


def _run(numbers):
    """Return the Run: a start makes the motion anew, in axes principal about the centre."""
    import jpype
    import orekit_jpype
    if not jpype.isJVMStarted():
        orekit_jpype.initVM()
    Attitude, Inertia, InertiaAxis, TorqueFree = (
        jpype.JClass(f'org.orekit.attitudes.{name}')
        for name in ('Attitude', 'Inertia', 'InertiaAxis', 'TorqueFree'))
    space = 'org.hipparchus.geometry.euclidean.threed'
    Rotation, Vector3D = (jpype.JClass(f'{space}.{name}') for name in ('Rotation', 'Vector3D'))
    frame = jpype.JClass('org.orekit.frames.FramesFactory').getGCRF()
    epoch = jpype.JClass('org.orekit.time.AbsoluteDate').ARBITRARY_EPOCH
    inertia = Inertia(*(
        InertiaAxis(float(moment), axis) for moment, axis in zip(
            numbers.moments, (Vector3D.PLUS_I, Vector3D.PLUS_J, Vector3D.PLUS_K), strict=True)))
    x, y, z, w, *omega = map(float, numbers.start)
    motion = now = None

    def begin():
        nonlocal motion, now
        # its quaternions have the signs of ours: a Rotation turns the axes, not the vector
        now = Attitude(epoch, frame, Rotation(w, x, y, z, True), Vector3D(*omega), Vector3D.ZERO)
        motion = TorqueFree(now, inertia)

    def to(time):
        nonlocal now
        now = motion.getAttitude(None, epoch.shiftedBy(time), frame)

    def state():
        q, spin = now.getRotation(), now.getSpin()
        return numbers.state((q.getQ1(), q.getQ2(), q.getQ3(), q.getQ0(),
                              spin.getX(), spin.getY(), spin.getZ()))
    return Run(begin, to, state)
