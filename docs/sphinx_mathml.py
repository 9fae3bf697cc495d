# SPDX-License-Identifier: Apache-2.0
"""A Sphinx extension: equations become MathML while the site is built.

Sphinx's own MathJax renderer makes the reader's browser load a script from the network. Browsers
draw MathML without one.
"""

import re

from docutils import nodes
from latex2mathml.converter import convert

FUNCTION = re.compile(r'<m[io]>(sin|cos|tan|arctan|sn|max|min|sign)</m[io]>')


def mathml(latex, display):
    """Return an equation as MathML; names of functions keep off their neighbours."""
    return FUNCTION.sub(r'<mo lspace="0.17em" rspace="0.17em">\1</mo>',
                        convert(latex, display=display))


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
