# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's five columns for a frame, as small images in data URIs."""

import base64
import dataclasses

import cv2
import numpy as np

SOURCE_COLOURS = np.array([[0, 0, 0], [255, 255, 255], [255, 255, 0], [255, 0, 0], [0, 0, 255]], np.uint8)
SIGMA_ENDS = 1e-3, 1.0  # [m] ends of the logarithmic colour bar
_NO_SIGMA = 64          # grey level
_QUALITY = 82

COLUMNS = (('image', 'Image'), ('sensor', 'Sensor depth'), ('sfm', 'SfM depth'), ('source', 'Depth by source'),
           ('sigma', 'Standard deviation'))


@dataclasses.dataclass
class Picture:
    uri: str
    width: int
    height: int


class Painter:
    """@param depth_limit  [m] upper end of the colour bar
    @param width        [px] of the images, roughly, as they are reduced by a whole number"""

    def __init__(self, depth_limit, width):
        self.depth_limit, self._width = depth_limit, width

    def columns(self, frame, image, sensor):
        """{column: Picture}, without those that are not known. @param image, sensor  may be None"""
        images = {'image': None if image is None else self._photo(image),
                  'sensor': None if sensor is None else self._depth(sensor),
                  'sfm': None if frame.sfm_depth is None else self._depth(frame.sfm_depth),
                  'source': self._sources(frame.provenance), 'sigma': self._sigma(frame.sigma)}
        return {name: picture for name, picture in images.items() if picture is not None}

    def _step(self, image):
        return max(1, round(image.shape[1] / self._width))

    def _reduced(self, image):
        step = self._step(image)
        return image[step // 2::step, step // 2::step]

    def _photo(self, image):
        step = self._step(image)
        small = cv2.resize(image, (image.shape[1] // step, image.shape[0] // step), interpolation=cv2.INTER_AREA)
        return _encoded(small if small.ndim == 3 else cv2.cvtColor(small, cv2.COLOR_GRAY2RGB), '.jpg')

    def _depth(self, depth):
        depth = self._reduced(depth)
        with np.errstate(invalid='ignore'):
            share = np.clip(depth / self.depth_limit, 0, 1)
        return _coloured(share, cv2.COLORMAP_TURBO, none=0)

    def _sources(self, provenance):
        known = np.where(provenance < len(SOURCE_COLOURS), provenance, 0)
        return _encoded(SOURCE_COLOURS[self._reduced(known)], '.png')

    def _sigma(self, sigma):
        low, high = np.log(SIGMA_ENDS)
        with np.errstate(invalid='ignore', divide='ignore'):
            share = np.clip((np.log(self._reduced(sigma)) - low) / (high - low), 0, 1)
        return _coloured(1 - share, cv2.COLORMAP_VIRIDIS, _NO_SIGMA)  # smaller is brighter, as in the preview


def _coloured(share, colours, none):
    known = np.isfinite(share)
    levels = np.where(known, np.rint(255 * share), 0).astype(np.uint8)
    image = cv2.cvtColor(cv2.applyColorMap(levels, colours), cv2.COLOR_BGR2RGB)
    image[~known] = none
    return _encoded(image, '.jpg')


def _encoded(image, ending):
    options = [cv2.IMWRITE_JPEG_QUALITY, _QUALITY] if ending == '.jpg' else [cv2.IMWRITE_PNG_COMPRESSION, 9]
    _, data = cv2.imencode(ending, image[..., ::-1], options)
    kind = 'jpeg' if ending == '.jpg' else 'png'
    text = base64.b64encode(data.tobytes()).decode()
    return Picture(f'data:image/{kind};base64,{text}', image.shape[1], image.shape[0])


def round_limit(values, percentile=99.5):
    """[m] A round upper end for a colour bar, above most of the values."""
    values = values[np.isfinite(values)]
    top = float(np.percentile(values, percentile)) if values.size else 1.0
    step = 10.0 ** np.floor(np.log10(max(top, 1e-3))) / 2
    return float(step * np.ceil(top / step))


def gradient(colours, first=0, last=255):
    """The colour bar as CSS, from level `first` to level `last`."""
    levels = np.linspace(first, last, 12).astype(np.uint8).reshape(1, -1)
    colours = cv2.applyColorMap(levels, colours)[0, :, ::-1]
    return 'linear-gradient(to right, ' + ', '.join('rgb(%d %d %d)' % tuple(colour) for colour in colours) + ')'


DEPTH_GRADIENT, SIGMA_GRADIENT = gradient(cv2.COLORMAP_TURBO), gradient(cv2.COLORMAP_VIRIDIS, 255, 0)
