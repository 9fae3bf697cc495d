# SPDX-License-Identifier: Apache-2.0
"""All figures of a report, as PNG and SVG.

matplotlib takes a second to import, so this module is imported only where figures are made.
"""

from rigid_body_sim.analysis import panels, plots
from rigid_body_sim.analysis.space import spaces

FORMATS = ('png', 'svg')


def draw_overview(folder, measured, title):
    """Write the overview; return the path of the PNG."""
    return _save(
        plots.stack(panels.overview(measured), title, measured.source),
        folder,
        'overview',
        measured.source,
    )[0]


def draw_all(folder, measured, spectrum, balance, title):
    """Write all figures; return the paths of the PNGs (an SVG lies beside each).

    Parameters
    ----------
    folder : pathlib.Path
    measured : measure.Measured
    spectrum : spectrum.Spectrum or None
    balance : as from ledger.ledger, or None
    title : str
    """
    source = measured.source
    made = {'overview': plots.stack(panels.overview(measured), title, source)}
    if panels.motion(measured):
        made['motion'] = plots.stack(panels.motion(measured), title, source)
    if balance:
        made['ledger'] = plots.stack(panels.energies(balance), title, source)
    if spectrum and spectrum.amplitudes:
        made['spectrum'] = plots.spectra(spectrum, title)
    made |= {one.name: plots.space(one) for one in spaces(measured)}
    return [_save(figure, folder, name, source, FORMATS)[0] for name, figure in made.items()]


def _save(figure, folder, name, source, formats=FORMATS[:1]):
    stem = '_'.join(filter(None, (name, *source.namespace.split('/'))))
    paths = [folder / f'{stem}.{suffix}' for suffix in formats]
    for path in paths:
        figure.savefig(path)
        figure.set_layout_engine(None)    # the layout is made: any engine draws once more
    return paths
