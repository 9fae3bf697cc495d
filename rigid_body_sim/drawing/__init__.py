# SPDX-License-Identifier: Apache-2.0
"""Bodies as triangles: what every picture of a scene draws, in a browser, a report or a marker.

Nothing here knows who draws it. It may import ``scene`` and what lies below.
"""
