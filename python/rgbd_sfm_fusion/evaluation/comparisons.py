# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Compares a run on disturbed input with the run on the same input undisturbed."""

import hashlib

import cv2
import numpy as np

from .. import bags
from .depth_score import given_depth
from .error_table import ErrorTable
from .motion_score import states

KEYFRAME_TOPICS = ('/tracker/keyframe/depth', '/tracker/keyframe/variance')
_MEAN, _VARIANCE = '/fusion/mean', '/fusion/variance'
_METRES = 8
_SFM, _LABEL, _DISAGREEMENT = '/fusion/sfm_depth', '/fusion/provenance', '/fusion/disagreement'


def keyframe_difference(fused, other):
    """Number of keyframe images that differ in any bit between two runs, and number of all keyframe images."""
    first, second = (_digests(path) for path in (fused, other))
    return sum(a != b for a, b in zip(first, second)) + abs(len(first) - len(second)), max(len(first), len(second))


def _digests(path):
    with bags.open_bag(path) as bag:
        found = [(topic, bags.stamp_of(message), hashlib.sha256(message.data).digest())
                 for topic, message, _ in bag.read_messages(topics=list(KEYFRAME_TOPICS))]
    return sorted(found)  # the revisions of a keyframe share its stamp


def _with_changes(plain, disturbed, topics, sequence, every):
    """Takes two runs, each as (input bag, output bag). Yields the pixels whose sensor depth differs, the pixels whose
    sensor depth is the same, and the images of both runs."""
    with bags.open_bag(plain[1]) as bag, bags.open_bag(disturbed[1]) as other:
        wanted = [stamp for stamp in bags.stamps(bag, '/tracker/frame')[::every] if stamp in sequence]
        chosen = set(wanted)
        sensors = (given_depth(inputs, sequence, wanted) for inputs in (plain[0], disturbed[0]))
        messages = (((stamp, found) for stamp, found in bags.synchronised(source, topics) if stamp in chosen)
                    for source in (bag, other))
        for sensor, other_sensor, (stamp, found), (other_stamp, other_found) in zip(*sensors, *messages):
            if stamp != other_stamp:
                raise ValueError(f'{disturbed[1]} does not have the frames of {plain[1]}')
            if sensor is None or other_sensor is None:
                continue
            before, after = ([bags.image(images[topic]) for topic in topics] for images in (found, other_found))
            yield (sensor > 0) & (sensor != other_sensor), sensor == other_sensor, before, after


def sfm_only_by_metre(fused, sequence, every=1):
    """NEES25 and median relative error of depth from SfM alone, by metre of the true depth. Pixels of mirrors are left
    out."""
    table = ErrorTable(_METRES)
    with bags.open_bag(fused) as bag:
        chosen = {stamp for stamp in bags.stamps(bag, '/tracker/frame')[::every] if stamp in sequence}
        for stamp, found in bags.synchronised(bag, [_MEAN, _VARIANCE, _LABEL]):
            if stamp not in chosen:
                continue
            mean, variance, label = (bags.image(found[topic]) for topic in (_MEAN, _VARIANCE, _LABEL))
            truth, mirror = sequence.true_depth(stamp), sequence.mirror(stamp)
            at = (label == 2) & (truth < _METRES)
            if mirror is not None:
                at &= ~mirror
            table.add(mean[at] - truth[at], truth[at], variance[at], truth[at].astype(np.int64))
    found = {}
    for metre in range(_METRES):
        summary = table.summary([metre])
        if 'nees25' in summary:
            found[f'nees25_{metre}_{metre + 1}'] = summary['nees25']
            found[f'error_{metre}_{metre + 1}'] = summary['median_relative']
    return found


def leak(plain, disturbed, sequence, every=1):
    """Median relative change of SfM depth where sensor depth was falsified. The change elsewhere in the same frame is
    taken off."""
    changes = []
    for inside, outside, (before,), (after,) in _with_changes(plain, disturbed, [_SFM], sequence, every):
        ratio = after / before
        elsewhere, there = ratio[outside & np.isfinite(ratio)], ratio[inside & np.isfinite(ratio)]
        if len(elsewhere) >= 100:
            changes.append(there[::5] / np.median(elsewhere) - 1)
    return float(np.median(np.concatenate(changes))) if changes else float('nan')


_MOTION = 8  # [px] fusion moves sensor depth at most so far to bring it to the time of the colour image


def _middle(inside, outside):
    """The part of a mask that is too far from pixels outside it for their depth to be moved there."""
    reach = np.ones((2 * _MOTION + 1, 2 * _MOTION + 1), np.uint8)
    return inside & (cv2.dilate(outside.astype(np.uint8), reach) == 0)


def false_depth(plain, disturbed, sequence, every=1):
    """Looks at the pixels that have both false sensor depth and SfM depth. Gives the shares of these pixels that are
    flagged as disagreeing, that are averaged, and that keep SfM's depth. Some of these pixels still have false depth
    after sensor depth was moved to colour's time: the last number is the share of them that is averaged."""
    counts = np.zeros(6)
    topics = [_SFM, _LABEL, _DISAGREEMENT]
    for inside, outside, _, (sfm, label, disagreement) in _with_changes(plain, disturbed, topics, sequence, every):
        at, middle = inside & np.isfinite(sfm), _middle(inside, outside) & np.isfinite(sfm)
        counts += [at.sum(), (disagreement[at] > 0).sum(), (label[at] == 3).sum(), (label[at] == 2).sum(),
                   (label[middle] == 3).sum(), middle.sum()]
    shares = counts[1:4] / counts[0] if counts[0] else np.full(3, np.nan)
    return dict(zip(('flagged', 'averaged', 'sfm_kept'), shares.tolist()), pixels=int(counts[0]),
                averaged_in_middle=float(counts[4] / counts[5]) if counts[5] else float('nan'))


def recovery(results, start, duration):
    """For a run whose images were black for a while: the number of dark frames that were still called tracked, and the
    time from the end of the darkness to the first frame that was tracked again [s]; NaN if no frame was."""
    stamps, state = states(results)
    seconds = 1e-9 * (stamps - stamps[0])
    tracking = np.array([name == 'tracking' for name in state])
    dark = (seconds >= start) & (seconds < start + duration)
    back = seconds[tracking & (seconds >= start + duration)]
    return {'dark_frames': int(dark.sum()), 'tracked_in_the_dark': int((tracking & dark).sum()),
            'recovered_after': float(back[0] - seconds[seconds >= start + duration][0]) if len(back) else float('nan')}
