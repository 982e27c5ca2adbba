# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""What a run of fuse_bag is worth: readers of its files, and comparisons with the truth."""
