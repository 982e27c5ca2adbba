# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""A small run of fuse_bag, and the bag that it fused. The camera moves along a wall 2 m away. In the left third the sensor
sees nothing, and half of that was added."""

import json
import os

import cv2
import genpy
import numpy as np
import rosbag
from sensor_msgs.msg import CameraInfo, Image

WIDTH, HEIGHT, FRAMES = 64, 48, 8
STAMPS = [10**9 * 1000 + 10**8 * i for i in range(FRAMES)]
K = [50.0, 0.0, 31.5, 0.0, 50.0, 23.5, 0.0, 0.0, 1.0]
HOLE, ADDED, COMPLETED = slice(0, 21), slice(0, 10), slice(10, 15)  # columns
DEPTH, SFM_ERROR, SIGMA = 2.0, 0.02, 0.04  # [m]
SPEED = 0.01  # [m] a frame


def time_of(stamp):
    return genpy.Time(stamp // 10**9, stamp % 10**9)


def image_message(values, stamp, encoding):
    message = Image(height=values.shape[0], width=values.shape[1], encoding=encoding,
                    step=values.strides[0], data=values.tobytes())
    message.header.stamp = time_of(stamp)
    return message


def camera_info(stamp, distortion=()):
    info = CameraInfo(width=WIDTH, height=HEIGHT, K=K, distortion_model='plumb_bob', D=list(distortion) or [0.0] * 5,
                      P=[*K[:3], 0.0, *K[3:6], 0.0, *K[6:], 0.0])
    info.header.stamp = time_of(stamp)
    return info


def colour_image(frame):
    x, y = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    return np.dstack([(3 * x + frame) % 256, 5 * y % 256, np.full(x.shape, 10 * frame)]).astype(np.uint8)


def images_of(frame, completed=False):
    """{topic: (values, encoding)} of the output bag. @param completed  whether part of the hole was completed"""
    rng = np.random.default_rng(frame)
    label = np.ones((HEIGHT, WIDTH), np.uint8)
    label[:, HOLE] = 0
    label[:, ADDED] = 2
    label[:, 40:] = 3
    if completed:
        label[:, COMPLETED] = 4
    sfm = DEPTH + SFM_ERROR * rng.standard_normal(label.shape)
    sfm[(label != 2) & (label != 3)] = np.nan
    mean = np.where(label == 0, np.nan, np.where(label == 2, sfm, DEPTH))
    variance = np.where(np.isnan(mean), np.nan, SIGMA**2)
    sfm_variance = np.where(np.isnan(sfm), np.nan, SFM_ERROR**2)
    floats = {'mean': mean, 'variance': variance, 'sfm_depth': sfm, 'sfm_variance': sfm_variance}
    found = {f'/fusion/{name}': (values.astype(np.float32), '32FC1') for name, values in floats.items()}
    found['/fusion/provenance'] = label, 'mono8'
    return found


def write_input(path, distortion=()):
    with rosbag.Bag(path, 'w') as bag:
        for frame, stamp in enumerate(STAMPS):
            depth = np.full((HEIGHT, WIDTH), int(1000 * DEPTH), np.uint16)
            depth[:, HOLE] = 0
            bag.write('/camera/rgb/camera_info', camera_info(stamp, distortion), time_of(stamp))
            bag.write('/camera/rgb/image_raw', image_message(colour_image(frame), stamp, 'rgb8'), time_of(stamp))
            bag.write('/camera/depth_registered/image_raw', image_message(depth, stamp, '16UC1'), time_of(stamp))


def write_bag(path, left_out=(), completed=False):
    with rosbag.Bag(path, 'w') as bag:
        for frame, stamp in enumerate(STAMPS):
            bag.write('/fusion/camera_info', camera_info(stamp), time_of(stamp))
            for topic, (values, encoding) in images_of(frame, completed).items():
                if topic not in left_out:
                    bag.write(topic, image_message(values, stamp, encoding), time_of(stamp))


def seconds(stamp):
    return f'{stamp // 10**9}.{stamp % 10**9:09d}'


def write_results(folder, given=None, completed=False):
    os.makedirs(folder)
    pixels = HEIGHT * (WIDTH - 11)
    shares = [HEIGHT * columns / pixels for columns in (19, 10, 24)]
    with open(os.path.join(folder, 'frames.csv'), 'w') as file:
        file.write('stamp,state,keyframe,revision,relocalised,alpha,sigma_alpha,refused,inliers,residual,'
                   'pixels_with_depth,sensor_only,sfm_only,fused,disagreement,skew,run'
                   f'{",completed" if completed else ""}\n')
        for i, stamp in enumerate(STAMPS):
            alpha = 'nan,nan' if i == 0 else '1.01,0.002'
            file.write(f'{seconds(stamp)},tracking,{seconds(STAMPS[0])},{i},0,{alpha},0,900,0.01,{pixels},'
                       f'{shares[0]:.6f},{shares[1]:.6f},{shares[2]:.6f},0,0.000000000,1'
                       f'{f",{5 / WIDTH:.6f}" if completed else ""}\n')
    with open(os.path.join(folder, 'timing.csv'), 'w') as file:
        file.write('stamp,preparation_ms,tracking_ms,mapping_ms,fusion_ms\n')
        for stamp in STAMPS:
            file.write(f'{seconds(stamp)},0.500,3.000,20.000,9.000\n')
    write_poses(os.path.join(folder, 'trajectory.txt'))
    settings = {'noise_quadratic': 0.001425, 'noise_floor': 0.001, 'noise_lateral': 0.5, 'common_scale_sigma': 0.005,
                'depth_scale': 0.001, 'sensor': 'kinect'}
    summary = {'version': '1.2.3', 'frames': FRAMES, 'settings': settings, 'changed_settings': {'noise_lateral': 0.3}}
    if given:
        summary['input'] = {'bags': [given], 'colour': '/camera/rgb/image_raw', 'start': 0, 'duration': None,
                            'depth': '/camera/depth_registered/image_raw', 'calibration': '/camera/rgb/camera_info'}
    with open(os.path.join(folder, 'summary.json'), 'w') as file:
        json.dump(summary, file)


def write_poses(path):
    with open(path, 'w') as file:
        for i, stamp in enumerate(STAMPS):
            file.write(f'{seconds(stamp)} {SPEED * i} 0 0 0 0 0 1\n')


def write_sequence(folder, depth):
    """@param depth  H x W [m], 0 = none, the same in all frames"""
    os.makedirs(os.path.join(folder, 'depth'))
    with open(os.path.join(folder, 'calib.txt'), 'w') as file:
        file.write(f'50 50 31.5 23.5 {WIDTH} {HEIGHT} 1000\n')
    write_poses(os.path.join(folder, 'groundtruth.txt'))
    with open(os.path.join(folder, 'associations.txt'), 'w') as file:
        for stamp in STAMPS:
            name = seconds(stamp) + '.png'
            file.write(f'{seconds(stamp)} rgb/{name} {seconds(stamp)} depth/{name}\n')
            cv2.imwrite(os.path.join(folder, 'depth', name), np.rint(1000 * depth).astype(np.uint16))


def write_truth(folder):
    """Exact depth everywhere, as render_sequence writes it."""
    write_sequence(folder, np.full((HEIGHT, WIDTH), DEPTH))
    os.makedirs(os.path.join(folder, 'mask'))
    for stamp in STAMPS:
        cv2.imwrite(os.path.join(folder, 'mask', seconds(stamp) + '.png'), np.zeros((HEIGHT, WIDTH), np.uint8))


def write_recorded(folder):
    """The input of the run."""
    depth = np.full((HEIGHT, WIDTH), DEPTH)
    depth[:, HOLE] = 0
    write_sequence(folder, depth)


def write_all(folder):
    """Writes in.bag, fused.bag and results."""
    paths = [os.path.join(folder, name) for name in ('in.bag', 'fused.bag', 'results')]
    write_input(paths[0])
    write_bag(paths[1])
    write_results(paths[2], paths[0])
    return paths
