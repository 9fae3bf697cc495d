# SPDX-License-Identifier: Apache-2.0
"""The map of config/sweeps/rattleback.yaml beside the growth of small rocking.

Small rocking grows as exp(sigma t), sigma the largest real part of the eigenvalues of
rigid_body_sim/theory/rattleback.py at the spin of the start. A rattleback turns back when the
rocking has taken the energy of the spin: the dashed line is the pitch from which that takes 12 s.
"""

import numpy as np

from figures.style import BLUE, GREY, ORANGE, label, panels
from rigid_body_sim import load_scene, sweep
from rigid_body_sim.theory import rattleback as theory

SPEC = 'config/sweeps/rattleback.yaml'
DURATION, G = 12.0, 9.81
SECTIONS = (-5.0, 5.0)


def draw():
    """Return the figure."""
    found = sweep(SPEC)
    spin = found['initial.angular_velocity.2'].values
    pitch = found['initial.euler_zyz.1'].values
    back = np.where(spin[:, np.newaxis] < 0.0, found['maximum_angular_velocity_z'].values,
                    -found['minimum_angular_velocity_z'].values) / np.abs(spin)[:, np.newaxis]
    needed = [pitch_that_grows(one) for one in spin]
    figure, axes = panels(2, height=3.4)
    shown = axes[0].pcolormesh(spin, pitch, np.clip(back, 0.0, 1.2).T, shading='nearest',
                               cmap='cividis', rasterized=True)
    axes[0].set_facecolor('#dddddd')
    figure.colorbar(shown, ax=axes[0], label='spin back in 12 s over that at the start')
    axes[0].plot(spin, needed, color='white', linestyle='--', linewidth=1.5,
                 label='rocking grows\nfor 12 s')
    axes[0].set_yscale('log')
    axes[0].set_ylim(pitch[0], pitch[-1])
    label(axes[0], 'spin at the start (rad/s)', 'pitch at the start (rad)', labelcolor='white',
          loc='lower right')
    for one, color, marker in zip(SECTIONS, (BLUE, ORANGE), 'os', strict=True):
        k = int(np.abs(spin - one).argmin())
        axes[1].plot(pitch, back[k], color=color, marker=marker, markersize=3, linewidth=1.0,
                     label=f'started at {spin[k]:.2g} rad/s')
    axes[1].axhline(0.0, color=GREY, linewidth=0.8)
    axes[1].set_xscale('log')
    label(axes[1], 'pitch at the start (rad)', 'spin back over that at the start')
    refused = int((found['status'].values != 0).sum())
    for sense, chosen in (('against', spin < 0.0), ('with', spin > 0.0)):
        part = back[chosen]
        there = np.isfinite(part)
        print(f'  spin {sense} its sense: {int((part[there] > 0.5).sum())} of {int(there.sum())} '
              'runs come back with more than half of the spin')
    print(f'  {refused} of {back.size} runs would need a plane that pulls')
    return figure


def pitch_that_grows(spin):
    """Return the pitch (rad) whose rocking takes the energy of a spin (rad/s) in DURATION."""
    scene = load_scene('rattleback')
    body = scene.body
    a, _, c = semi_axes = body.surface.size
    values = theory.modes((body.mass, body.about_center.matrix, np.array(body.center_of_mass)),
                          semi_axes, G, spin)
    # the radius of curvature along the long axis, and the height of the centre of mass
    stiffness = body.mass * G * (a * a / c - (c + body.center_of_mass[2]))
    whole = abs(spin) * np.sqrt(body.about_center.matrix[2, 2] / stiffness)
    return whole * np.exp(-max(value.real for value in values) * DURATION)
