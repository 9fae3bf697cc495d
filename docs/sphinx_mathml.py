# SPDX-License-Identifier: Apache-2.0
"""A Sphinx extension: equations become MathML while the site is built.

Sphinx's own MathJax renderer makes the reader's browser load a script from the network. docutils
brings a converter from LaTeX to MathML, which browsers draw without a script.
"""

from docutils import nodes
from docutils.utils.math import latex2mathml


def visit_math(translator, node):
    """Write an equation that stands within a line."""
    translator.body.append(latex2mathml.tex2mathml(node.astext(), as_block=False))
    raise nodes.SkipNode


def visit_math_block(translator, node):
    """Write an equation that stands alone."""
    translator.body.append(
        f'<div class="math">{latex2mathml.tex2mathml(node.astext(), as_block=True)}</div>')
    raise nodes.SkipNode


def setup(app):
    """Register the renderer under the name ``mathml``."""
    app.add_html_math_renderer('mathml', (visit_math, None), (visit_math_block, None))
    return {'parallel_read_safe': True, 'parallel_write_safe': True}
