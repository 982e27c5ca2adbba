# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Judges a run of fuse_bag: readers of the run's files, and comparisons with the truth."""
