// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/virtual_camera.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/geometry/rolling_shutter.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kBandRows = 8;  // of colour, that are taken as read at once

void require(bool good, const char* what) {
  if (!good) throw std::invalid_argument(what);
}

/// Whole microseconds.
Stamp rounded(double seconds) {
  return 1000 * static_cast<Stamp>(std::llround(1e6 * seconds));
}

void validate(const VirtualCameraOptions& options) {
  require(options.rate >= 0.1 && options.rate <= 1000.0, "rate has to be 0.1 to 1000 Hz");
  const PinholeCamera& c = options.camera;
  require(c.width >= 16 && c.width <= 8192 && c.height >= 16 && c.height <= 8192,
          "camera width and height have to be 16 to 8192 pixels");
  require(std::isfinite(c.fx) && std::isfinite(c.fy) && c.fx >= 1.0 && c.fy >= 1.0,
          "camera fx and fy have to be at least 1 pixel");
  require(std::isfinite(c.cx) && std::isfinite(c.cy), "camera cx and cy have to be finite");
  require(options.start >= 0, "start has to be 0 or later");
  require(options.registration_error.norm() <= 100.0, "registration_error has to be at most 100 pixels");
  require(std::abs(options.skew) <= 1.0, "skew has to be at most 1 s");
  require(options.start + rounded(options.skew) >= 0, "start plus skew has to be 0 or later");
  require(std::abs(options.readout) <= 0.1, "readout has to be at most 0.1 s");
  require(options.offset.norm() <= 1.0, "offset has to be at most 1 m");
}

/// @param materials by index of the surface
void describeTruth(const GeometryBuffer& geometry, const std::vector<std::uint8_t>& materials,
                   VirtualFrame& frame) {
  frame.true_depth.create(geometry.surface.rows, geometry.surface.cols);
  frame.mask.create(geometry.surface.rows, geometry.surface.cols);
  for (int row = 0; row < geometry.surface.rows; ++row) {
    const std::int32_t* surface = geometry.surface[row];
    const float* inverse_depth = geometry.inverse_depth[row];
    float* depth = frame.true_depth[row];
    std::uint8_t* material = frame.mask[row];
    for (int x = 0; x < geometry.surface.cols; ++x) {
      const bool nothing = surface[x] == GeometryBuffer::kNothing;
      depth[x] = nothing ? kNoDepth : 1.0f / inverse_depth[x];
      material[x] = nothing ? static_cast<std::uint8_t>(Material::kNone)
                            : materials[static_cast<std::size_t>(surface[x])];
    }
  }
}

/// Materials of all surfaces of a GeometryBuffer: the patches, then the mirrored patches.
std::vector<std::uint8_t> materialsOf(const Scene& scene) {
  std::vector<std::uint8_t> materials(2 * scene.patches.size(), static_cast<std::uint8_t>(Material::kMirror));
  for (std::size_t i = 0; i < scene.patches.size(); ++i)
    materials[i] = static_cast<std::uint8_t>(scene.patches[i].material);
  return materials;
}

}  // namespace

VirtualCamera::VirtualCamera(const VirtualCameraOptions& options, std::shared_ptr<const Scene> scene)
    : options_(options),
      scene_(std::move(scene)),
      trajectory_(options.seed),
      depth_sensor_(options.depth, options.seed),
      colour_sensor_(options.colour, options.seed) {
  validate(options);
  require(scene_ != nullptr, "a virtual camera needs a scene");
  materials_ = materialsOf(*scene_);
}

int VirtualCamera::framesPerPass() const {
  return static_cast<int>(std::lround(HandheldTrajectory::kPeriod * options_.rate));
}

Stamp VirtualCamera::stampOf(std::uint32_t index) const {
  return options_.start + rounded(index / options_.rate);
}

SE3 VirtualCamera::poseAt(double time) const {
  return trajectory_.T_world_camera(time) * SE3(Eigen::Quaterniond::Identity(), options_.offset);
}

void VirtualCamera::render(std::uint32_t index, VirtualFrame& frame, const FrameParts& parts) {
  const double time = index / options_.rate;
  frame.stamp = stampOf(index);
  frame.depth_stamp = frame.stamp + rounded(options_.skew);
  frame.T_world_camera = poseAt(toSeconds(frame.stamp - options_.start));
  const bool depth_has_own_view = options_.skew != 0.0 || !options_.registration_error.isZero(0.0);
  if (parts.colour || parts.truth || (parts.depth && !depth_has_own_view))
    rasteriser_.draw(*scene_, options_.camera, frame.T_world_camera, geometry_);
  frame.rgb = parts.colour ? frame.rgb : cv::Mat();
  if (parts.colour) {
    if (options_.readout != 0.0) {
      shadeRowByRow(toSeconds(frame.stamp - options_.start));
    } else {
      shader_.shade(*scene_, geometry_, rgb_);
    }
    colour_sensor_.expose(rgb_, time, index, frame.rgb);
  }
  frame.true_depth = parts.truth ? frame.true_depth : DepthImage();
  frame.mask = parts.truth ? frame.mask : cv::Mat_<std::uint8_t>();
  if (parts.truth) describeTruth(geometry_, materials_, frame);
  frame.depth = parts.depth ? frame.depth : cv::Mat();
  if (parts.depth) {
    measureDepth(index, toSeconds(frame.depth_stamp - options_.start), depth_has_own_view, frame);
  }
}

/// Colours each band of rows as seen from where the camera is when it is read.
void VirtualCamera::shadeRowByRow(double time) {
  const PinholeCamera& camera = options_.camera;
  rgb_.create(camera.height, camera.width, CV_8UC3);
  for (int row = 0; row < camera.height; row += kBandRows) {
    PinholeCamera band = camera;
    band.height = std::min(kBandRows, camera.height - row);
    band.cy -= row;
    const double share = ReadoutMotion::share(row + 0.5 * (band.height - 1), camera.height);
    rasteriser_.draw(*scene_, band, poseAt(time + share * options_.readout), band_geometry_);
    shader_.shade(*scene_, band_geometry_, band_rgb_);
    band_rgb_.copyTo(rgb_.rowRange(row, row + band.height));
  }
}

void VirtualCamera::measureDepth(std::uint32_t index, double time, bool own_view, VirtualFrame& frame) {
  if (own_view) {
    PinholeCamera camera = options_.camera;
    camera.cx += options_.registration_error.x();
    camera.cy += options_.registration_error.y();
    rasteriser_.draw(*scene_, camera, poseAt(time), depth_geometry_);
  }
  depth_sensor_.measure(own_view ? depth_geometry_ : geometry_, scene_->patches, options_.camera.fx, index,
                        frame.depth);
}

VirtualFrame VirtualCamera::frame(std::uint32_t index) {
  VirtualFrame result;
  render(index, result);
  return result;
}

}  // namespace rgbd_sfm_fusion
