# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The interior of surfaces in a depth image: away from steps and holes."""

import cv2
import numpy as np

def surface_interior(truth, margin=5, step=0.05):
    """Pixels farther than a margin [px] from holes, and from every step of the true depth between neighbours. A step is
    relative to the nearer neighbour."""
    filled = np.nan_to_num(truth, nan=0.0)
    edges = (filled == 0).astype(np.uint8)
    for a, b in (((slice(1, None),), (slice(-1),)), ((slice(None), slice(1, None)), (slice(None), slice(-1)))):
        apart = np.abs(filled[a] - filled[b]) > step * np.minimum(filled[a], filled[b])
        edges[a] |= apart
        edges[b] |= apart
    return cv2.dilate(edges, np.ones((2 * margin + 1, 2 * margin + 1), np.uint8)) == 0
