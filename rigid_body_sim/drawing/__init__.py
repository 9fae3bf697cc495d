# SPDX-License-Identifier: Apache-2.0
"""Bodies as triangles, for every picture of a scene: in a browser, a report or a marker.

Nothing here depends on the medium. It may import ``scene`` and what lies below.
"""
