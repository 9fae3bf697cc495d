# SPDX-License-Identifier: Apache-2.0
"""Sphinx: pages in MyST Markdown, the Python interface by numpydoc. ``make docs`` builds it.

Nothing is fetched: equations become MathML, which browsers draw themselves, and the search runs
in the page.
"""

import os
import pathlib
import sys
import xml.etree.ElementTree

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

manifest = HERE.parent / 'package.xml'
own = manifest.exists()         # rosdoc2 builds a copy of this folder; it knows the package, and
if own:                         # brings a Markdown parser that does not stand beside myst_nb
    package = xml.etree.ElementTree.parse(manifest).getroot()
    project = package.findtext('name')
    author = copyright = package.findtext('author')  # noqa: A001  (Sphinx reads the name)
    release = version = package.findtext('version')

extensions = ['myst_nb' if own else 'myst_parser', 'sphinx.ext.autodoc',
              'sphinx.ext.autosummary', 'numpydoc', 'sphinx_mathml']
html_math_renderer = 'mathml'
myst_enable_extensions = ['dollarmath', 'deflist']
myst_heading_anchors = 3
# a file of the tree (a scene, a script) is a download; pages of folders outside of docs are not
suppress_warnings = ['misc.highlighting_failure']
# notebooks are run where they changed since the last build, by a kernel that finds this tree
nb_execution_mode = 'cache'
nb_execution_cache_path = str(HERE.parent / '.cache' / 'notebooks')
nb_execution_raise_on_error = True
nb_execution_timeout = 300
os.environ['PYTHONPATH'] = str(HERE.parent)
exclude_patterns = ['_build', 'figures', 'images', *([] if own else ['notebooks'])]

autosummary_generate = True
autodoc_typehints = 'none'           # numpydoc shows the types that the docstrings say
autodoc_preserve_defaults = True     # signatures show defaults as the source has them
autodoc_default_options = {'members': True, 'undoc-members': False}
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

html_theme = 'furo'
html_title = 'rigid_body_sim'
html_static_path = ['static'] if own else []
html_css_files = ['site.css'] if own else []
html_show_sourcelink = False
html_copy_source = False
highlight_language = 'text'      # of code blocks that name no language
