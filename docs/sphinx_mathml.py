# SPDX-License-Identifier: Apache-2.0
"""A Sphinx extension: equations become MathML while the site is built.

Sphinx's own MathJax renderer makes the reader's browser load a script from the network. Browsers
draw MathML without one.
"""

import re

from docutils import nodes
from latex2mathml.converter import convert

# browsers draw no bold but by a style, and the dot of a derivative too small to be seen
CHANGES = ((re.compile(r'<m[io]>(sin|cos|tan|cot|arctan|sn|max|min|sign)</m[io]>'),
            r'<mo lspace="0.17em" rspace="0.17em">\1</mo>'),
           (re.compile('<mi mathvariant="bold">'),
            '<mi mathvariant="normal" style="font-weight: bold">'),
           (re.compile('<mo>(&#x002D9;|&#x000A8;)</mo></mover>'),
            r'<mo style="font-size: 130%; font-weight: bold">\1</mo></mover>'))


def mathml(latex, display):
    """Return an equation as MathML; names of functions keep off their neighbours."""
    equation = convert(latex, display=display)
    for pattern, better in CHANGES:
        equation = pattern.sub(better, equation)
    return equation


def visit_math(translator, node):
    """Write an equation that stands within a line."""
    translator.body.append(mathml(node.astext(), 'inline'))
    raise nodes.SkipNode


def visit_math_block(translator, node):
    """Write an equation that stands alone."""
    translator.body.append(f'<div class="math">{mathml(node.astext(), "block")}</div>')
    raise nodes.SkipNode


def setup(app):
    """Register the renderer under the name ``mathml``."""
    app.add_html_math_renderer('mathml', (visit_math, None), (visit_math_block, None))
    return {'parallel_read_safe': True, 'parallel_write_safe': True}
