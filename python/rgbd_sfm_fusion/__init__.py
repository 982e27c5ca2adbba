# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads what runs of rgbd_sfm_fusion wrote: `runs` has their frames as numpy arrays."""
