// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/image_size.h"
#include "rgbd_sfm_fusion/mapping/semi_dense_mapper.h"
#include "rgbd_sfm_fusion/odometry/relocalisation.h"
#include "rgbd_sfm_fusion/odometry/stereo_views.h"
#include "rgbd_sfm_fusion/odometry/tracking_depth.h"
#include "rgbd_sfm_fusion/sensor/skew_compensation.h"
#include "rgbd_sfm_fusion/tools/text_format.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"
#include "rgbd_sfm_fusion/tracking/image_noise.h"
#include "rgbd_sfm_fusion/tracking/readout_estimation.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kMinStartPixels = 1000;  // with gradient and depth, that a start needs, at full resolution
constexpr double kPatience = 0.5;      // [s] of good images after a loss in which the keyframe is looked for
constexpr double kLongestGap = 0.3;    // [s] between frames whose velocity still holds: 5 Hz, and late
constexpr double kGap = 0.5;           // [s] without a pose, after which none is predicted
constexpr double kDepthTimeSigma = 0.02;  // [s] depth has a readout of its own, and its stamp an error
// After a loss that the camera's place is not recognised after, it may have gone this far.
constexpr double kLostDistance = 0.5;  // [depths of the scene]
constexpr double kLostAngle = 0.5;     // [rad]
constexpr double kNoVariance = 1e-12;  // of what is defined, not measured: no filter takes a singular one
constexpr double kJump = 0.01;         // [tracker units or rad] a pose found again farther off has jumped
constexpr float kDepthPairInflation = 2.0F;   // of a cell's sigma: neighbours err alike
constexpr double kKnownReadoutSigma = 0.003;  // [s] the readout time is known
// With fewer frames for a keyframe, where they are far apart, none may be wasted: the next keyframe is a view
// of this one, and this one's views are views of the next.
constexpr std::uint32_t kFewViews = 8;
constexpr double kViewSpacing = 0.25;    // of the distance that makes a new keyframe
constexpr double kOtherReadout = 0.005;  // [s] stereo was done with another readout time
// [px] of an image that tracking may end on. Half of 320 x 240 doubles the error of the trajectory, half of
// 640 x 480 does not.
constexpr int kFewestPixels = 40000;

/// Pixels that tracking could use: with a gradient, and with depth unless that does not matter.
int trackablePixels(const ImagePyramid& pyramid, const DepthImage& depth, bool needs_depth,
                    float min_gradient) {
  const cv::Mat_<float>& image = pyramid[0];
  const cv::Rect& seen = pyramid.seen(0);
  int count = 0;
  for (int v = seen.y + 1; v + 1 < seen.br().y; ++v) {
    for (int u = seen.x + 1; u + 1 < seen.br().x; ++u) {
      const float gx = 0.5F * (image(v, u + 1) - image(v, u - 1)),
                  gy = 0.5F * (image(v + 1, u) - image(v - 1, u));
      const bool has_depth = !needs_depth || depth(v, u) > 0.0F;
      count += has_depth && gx * gx + gy * gy >= min_gradient * min_gradient ? 1 : 0;
    }
  }
  return count;
}

double meanInverseDepth(const InverseDepthImage& depth) {
  const int count = cv::countNonZero(depth.mean);
  return count > 0 ? cv::sum(depth.mean)[0] / count : 1.0;
}

/// The level that alignment ends on: a finer one than is set, where the images are small.
int finestLevel(int finest, const PinholeCamera& camera) {
  while (finest > 0 && (camera.width >> finest) * (camera.height >> finest) < kFewestPixels) --finest;
  return finest;
}

/// From the frame before to a frame.
struct Step {
  Vector6 twist = Vector6::Zero();  // of T_frame_last
  double interval = 0.0;            // [s]; 0 where the velocity is unknown

  bool isKnown() const { return interval > 0.0 && interval <= kLongestGap; }
  Vector6 during(double time) const {
    return isKnown() ? Vector6(twist * (time / interval)) : Vector6::Zero();
  }
};

}  // namespace

class VisualOdometry::Implementation {
 public:
  Implementation(const PinholeCamera& camera, const OdometryOptions& options)
      : camera_(camera), mapper_(camera), tracking_depth_(camera) {
    setOptions(options);
  }

  TrackingResult track(const RgbdFrame& frame) {
    check(frame);
    frame_ = frame;
    pyramid_.build(frame.grey, options_.tracking.pyramid_levels, frame.seen);
    tracked_ = TrackingResult();
    tracked_.stamp = frame.stamp;
    if (has_keyframe_) follow();
    if (!isTracking() && canStart() && !findPlace() && !isLookingForKeyframe()) startAnew();
    tracked_.readout_time = readoutTime();
    tracked_.readout_sigma = options_.estimate_readout ? readout_estimator_.sigma() : 0.0;
    return tracked_;
  }

  std::shared_ptr<const KeyframeMap> map() {
    if (!isTracking()) return nullptr;
    if (tracked_.keyframe_stamp == tracked_.stamp) {
      makeKeyframe();
    } else {
      if (revision_ == 0) learnKeyframeStep();
      observe(tracked_.T_frame_keyframe);
      rememberView();
      ++revision_;
    }
    updateReference();
    return publishedMap();
  }

  void reset() {
    forgetKeyframes();
    was_lost_ = false;
    good_again_ = kNoStamp;
    tracked_ = TrackingResult();
    step_ = Step();
    last_pose_ = StampedPose();
    odom_pose_ = OdomPose();
    readout_estimator_ = ReadoutEstimator(static_cast<double>(options_.readout_time));
    noise_ = ImageNoise(static_cast<double>(options_.tracking.image_noise));
  }

  void setOptions(OdometryOptions options) {
    validate(options, camera_);
    options.tracking.finest_level = finestLevel(options.tracking.finest_level, camera_);
    const bool same_levels = has_keyframe_ &&
                             options.tracking.pyramid_levels == options_.tracking.pyramid_levels &&
                             options.tracking.finest_level == options_.tracking.finest_level;
    if (!same_levels) forgetKeyframes();  // their pyramids are others
    if (options.readout_time != options_.readout_time)
      readout_estimator_ = ReadoutEstimator(static_cast<double>(options.readout_time));
    if (options.tracking.image_noise != options_.tracking.image_noise)
      noise_ = ImageNoise(static_cast<double>(options.tracking.image_noise));
    options_ = options;
    cameras_ = cameraPyramid(camera_, options.tracking.pyramid_levels);
  }

 private:
  void forgetKeyframes() {
    has_keyframe_ = false;
    recent_keyframes_.clear();
  }

  bool isTracking() const { return tracked_.state == TrackingState::kTracking; }

  void check(const RgbdFrame& frame) const {
    requireSize("colour image", frame.grey, camera_);
    if (!frame.depth.empty()) requireSize("depth image", frame.depth, camera_);
    if (tracked_.stamp != kNoStamp && frame.stamp <= tracked_.stamp) {
      throw std::invalid_argument("stamp " + formatStamp(frame.stamp) +
                                  " s is not later than that of the frame before, " +
                                  formatStamp(tracked_.stamp) + " s");
    }
  }

  bool canStart() const {
    const bool needs_depth = options_.init == Initialisation::kDepth;
    if (needs_depth && frame_.depth.empty()) return false;
    return trackablePixels(pyramid_, frame_.depth, needs_depth, options_.tracking.min_gradient) >=
           kMinStartPixels;
  }

  /// After a loss, a keyframe is looked for before a new one is started.
  bool isLookingForKeyframe() {
    if (!has_keyframe_) return false;
    if (good_again_ == kNoStamp) good_again_ = tracked_.stamp;
    return toSeconds(tracked_.stamp - good_again_) < kPatience;
  }

  /// After a loss, a keyframe before the last may be what the camera sees. Its scale is that of depth from
  /// the sensor, with which a new keyframe starts there.
  bool findPlace() {
    if (!has_keyframe_ || options_.init != Initialisation::kDepth) return false;
    const std::optional<OdomPose> pose =
        recent_keyframes_.find(pyramid_, 1.0 / mean_inverse_depth_, options_.tracking);
    if (!pose) return false;
    tracked_.relocalised = hasJumped(pose->T_odom_camera);
    startAt(*pose);
    return true;
  }

  /// The first keyframe; or one about which no more is known than that it is not far from the last pose.
  void startAnew() {
    tracked_.relocalised = has_keyframe_;
    OdomPose pose = odom_pose_;
    pose.covariance.diagonal() += unknownSinceLoss();
    startAt(pose);
  }

  /// [variances] of where the camera may have gone while lost; of a first keyframe, which is where odom is,
  /// as good as none.
  Vector6 unknownSinceLoss() const {
    if (!has_keyframe_) return Vector6::Constant(kNoVariance);
    const double distance = kLostDistance / mean_inverse_depth_;
    Vector6 variances;
    variances << Eigen::Vector3d::Constant(distance * distance),
        Eigen::Vector3d::Constant(kLostAngle * kLostAngle);
    return variances;
  }

  /// A first keyframe, or one that does not hang together with the last.
  void startAt(const OdomPose& pose) {
    starting_ = true;
    moveTo(pose);
    step_ = Step();
    becomeKeyframe();
  }

  void becomeKeyframe() {
    tracked_.state = TrackingState::kTracking;
    tracked_.keyframe_stamp = tracked_.stamp;
    tracked_.keyframe_revision = 0;
    tracked_.T_frame_keyframe = SE3();
    tracked_.covariance = kNoVariance * Matrix6::Identity();
    was_lost_ = false;
    good_again_ = kNoStamp;
  }

  bool hasJumped(const SE3& T_odom_frame) const {
    return (last_pose_.T_odom_camera.inverse() * T_odom_frame).log().norm() > kJump;
  }

  void moveTo(const OdomPose& pose) {
    tracked_.T_odom_frame = pose.T_odom_camera;
    tracked_.odom_covariance = pose.covariance;
    odom_pose_ = pose;
    last_pose_ = {tracked_.stamp, pose.T_odom_camera};
  }

  /// Aligns the frame with the keyframe.
  void follow() {
    const SE3 T_last_keyframe = last_pose_.T_odom_camera.inverse() * keyframe_pose_.T_odom_camera;
    const double interval = toSeconds(tracked_.stamp - last_pose_.stamp);
    if (interval > kGap) {  // the camera may be anywhere
      was_lost_ = true;
      step_ = Step();
    }
    const double readout_share = interval <= kLongestGap ? readoutTime() / interval : 0.0;
    const FrameShutter shutter{T_last_keyframe, readout_share};
    const AlignmentResult result =
        align(reference_, pyramid_, starts(T_last_keyframe), {brightness_, noise_.sigma()}, shutter,
              options_.tracking, depthPair(interval));
    tracked_.share_of_good_points = result.share_good;
    if (was_lost_ ? !isRecognised(result, options_.tracking) : !fits(result, options_.tracking)) {
      tracked_.state = TrackingState::kLost;
      if (was_lost_) step_ = Step();
      was_lost_ = true;
      return;
    }
    tracked_.state = TrackingState::kTracking;
    tracked_.keyframe_stamp = keyframe_stamp_;
    tracked_.keyframe_revision = revision_;
    tracked_.T_frame_keyframe = result.T_frame_keyframe;
    tracked_.covariance = poseCovariance(result, mean_inverse_depth_);
    const Vector6 twist = (result.T_frame_keyframe * T_last_keyframe.inverse()).log();
    tracked_.relocalised =
        was_lost_ && hasJumped(keyframe_pose_.T_odom_camera * result.T_frame_keyframe.inverse());
    step_ = was_lost_ ? Step() : Step{twist, interval};
    was_lost_ = false;
    good_again_ = kNoStamp;
    brightness_ = result.photometry.brightness;
    noise_.observe(result.photometry.noise);
    if (options_.estimate_readout && step_.isKnown() && keyframe_step_.isKnown())
      readout_estimator_.observe(reference_, pyramid_, result, shutter, keyframe_step_.during(interval),
                                 interval, options_.tracking);
    moveTo(keyframe_pose_.then(result.T_frame_keyframe, tracked_.covariance));
    forgets_stereo_ = isOfOtherShutter();
    if (forgets_stereo_ || isFarFromKeyframe(result)) {
      T_new_old_ = result.T_frame_keyframe;
      becomeKeyframe();
    }
  }

  /// The camera moves on as it did, or has stopped, or goes faster than before. After a loss it may have
  /// turned anywhere.
  std::vector<SE3> starts(const SE3& T_last_keyframe) const {
    constexpr double kFaster = 1.6;
    if (was_lost_ && !step_.isKnown()) return turned(T_last_keyframe, 2, 1.0 / mean_inverse_depth_);
    return {SE3::exp(step_.twist) * T_last_keyframe, T_last_keyframe,
            SE3::exp(kFaster * step_.twist) * T_last_keyframe};
  }

  DepthPair depthPair(double interval) {
    if (!options_.sensor_feedback || frame_.depth.empty() || keyframe_cells_.empty() ||
        interval > kLongestGap)
      return {};
    frame_cells_.compute(frame_.depth, camera_, options_.noise);
    const float sigma = kDepthPairInflation * std::sqrt(2.0F) * options_.noise.quadratic;
    return {&keyframe_cells_, &frame_cells_, toSeconds(frame_.stamp - frame_.depth_stamp) / interval,
            kDepthTimeSigma / interval, sigma};
  }

  double readoutTime() const {
    return options_.estimate_readout ? readout_estimator_.readoutTime()
                                     : static_cast<double>(options_.readout_time);
  }

  ReadoutMotion readout(const Step& step) const { return {step.during(readoutTime())}; }

  /// What stereo found before a rolling shutter was known is several per cent wrong, and stays so: tracking
  /// and stereo confirm each other.
  bool isOfOtherShutter() const {
    return options_.estimate_readout && readout_estimator_.sigma() < kKnownReadoutSigma &&
           std::abs(readoutTime() - stereo_readout_) > kOtherReadout;
  }

  bool isFarFromKeyframe(const AlignmentResult& result) const {
    const double distance = result.T_frame_keyframe.translation().norm() * mean_inverse_depth_ /
                            static_cast<double>(options_.keyframe.max_distance);
    const double lost = (1.0 - result.share_in_view) / static_cast<double>(options_.keyframe.max_lost);
    return distance * distance + lost * lost > 1.0;
  }

  /// Stereo between the keyframe and the present frame.
  void observe(const SE3& T_frame_keyframe) {
    mapper_.observe({&pyramid_[0], pyramid_.seen(0), T_frame_keyframe, brightness_, readoutTime(),
                     step_.during(1.0), keyframe_step_.during(1.0)},
                    maxInverseDepth(), options_.mapping);
  }

  ImagePose imagePose(const Brightness& brightness) const {
    return {tracked_.T_odom_frame, step_.during(1.0), brightness};
  }

  /// A view for the next keyframe's stereo.
  void rememberView() {
    const double far = static_cast<double>(options_.keyframe.max_distance) / mean_inverse_depth_;
    views_.add(pyramid_, imagePose(brightness_), kViewSpacing * far);
  }

  /// Stereo of what a new keyframe shows anew, with the views of the one before.
  void observeWhatIsNew() {
    for (const StereoView& view : views_.from(imagePose(brightness_), readoutTime()))
      mapper_.observeNew(view, maxInverseDepth(), options_.mapping);
  }

  void makeKeyframe() {
    if (has_keyframe_) recent_keyframes_.remember(reference_, keyframe_pose_);
    const bool asks_sensor = starting_ ? options_.init == Initialisation::kDepth : options_.sensor_feedback;
    const bool uses_sensor = asks_sensor && !frame_.depth.empty();
    const InverseDepthWarp warp(camera_, T_new_old_, readout(keyframe_step_), readout(step_));
    if (starting_ || forgets_stereo_) {
      mapper_.start(pyramid_, options_.mapping);
      stereo_readout_ = readoutTime();
    } else {
      const bool has_few_views = revision_ < kFewViews;
      if (has_few_views) observe(T_new_old_);
      mapper_.moveTo(pyramid_, warp, brightness_, options_.mapping);
      if (has_few_views) observeWhatIsNew();
    }
    if (starting_) {
      tracking_depth_.clear();
    } else {
      tracking_depth_.moveTo(warp);
    }
    if (starting_ && options_.init == Initialisation::kRandom) tracking_depth_.setRandom();
    keyframe_sensor_ = RgbdFrame();
    keyframe_cells_.clear();
    if (uses_sensor) {
      if (forgets_stereo_) tracking_depth_.setAside();
      setSensorDepth(frame_, step_);
      if (forgets_stereo_) tracking_depth_.contestBySetAside(std::max(parallax_, previous_parallax_));
      keyframe_sensor_ = frame_;
    }
    previous_parallax_ = starting_ ? 0.0 : parallax_;
    parallax_ = 0.0;
    starting_ = forgets_stereo_ = false;
    has_keyframe_ = true;
    keyframe_stamp_ = frame_.stamp;
    keyframe_grey_ = frame_.grey.clone();
    keyframe_pose_ = odom_pose_;
    brightness_ = Brightness();
    keyframe_step_ = step_;
    views_.setKeyframe(pyramid_, imagePose(Brightness()));
    revision_ = 0;
    reference_.setKeyframe(pyramid_, cameras_);
  }

  /// The first frame after a keyframe tells how the camera went on from there. Of a keyframe that follows no
  /// frame it is all that tells of its motion.
  void learnKeyframeStep() {
    if (keyframe_step_.isKnown() && step_.isKnown()) {
      keyframe_step_.twist = 0.5 * (keyframe_step_.twist + step_.during(keyframe_step_.interval));
    } else {
      keyframe_step_ = step_;
      if (!keyframe_sensor_.depth.empty()) setSensorDepth(keyframe_sensor_, keyframe_step_);
    }
    keyframe_sensor_ = RgbdFrame();
    views_.setKeyframeVelocity(keyframe_step_.during(1.0));
  }

  /// The keyframe's depth, where the camera was when it took the colour image.
  void setSensorDepth(const RgbdFrame& frame, const Step& step) {
    const SE3 T_colour_depth = SE3::exp(step.during(toSeconds(frame.stamp - frame.depth_stamp)));
    const DepthImage depth =
        options_.compensate_skew ? compensateSkew(frame.depth, camera_, T_colour_depth) : frame.depth;
    tracking_depth_.setSensor(withNoise(depth, options_.noise.withinRange()));
    keyframe_cells_.compute(depth, camera_, options_.noise);
  }

  void updateReference() {
    mapper_.reliable(options_.mapping, stereo_);
    parallax_ = std::max(parallax_, tracked_.T_frame_keyframe.translation().norm() * mean_inverse_depth_);
    const InverseDepthImage& depth = tracking_depth_.fuse(stereo_, std::max(parallax_, previous_parallax_));
    if (revision_ == 0) mean_inverse_depth_ = meanInverseDepth(depth);
    reference_.setDepth(depth, readout(keyframe_step_), options_.tracking.min_gradient,
                        options_.tracking.finest_level);
  }

  std::shared_ptr<const KeyframeMap> publishedMap() {
    auto map = std::make_shared<KeyframeMap>();
    map->stamp = keyframe_stamp_;
    map->revision = revision_;
    map->camera = camera_;
    map->T_first_keyframe = keyframe_pose_.T_odom_camera;
    map->grey = keyframe_grey_;
    map->depth = toDepth(mapper_.published(stereo_, options_.mapping), images_);
    if (options_.mapping.follow_scatter) mapper_.followScatter(map->depth.variance);
    if (options_.estimate_readout) mapper_.addReadoutVariance(readout_estimator_.sigma(), map->depth);
    return map;
  }

  float maxInverseDepth() const {
    return static_cast<float>(mean_inverse_depth_) / options_.mapping.min_depth;
  }

  PinholeCamera camera_;
  OdometryOptions options_;
  std::vector<PinholeCamera> cameras_;
  ImagePool images_;

  // The frame that is being worked on.
  RgbdFrame frame_;
  ImagePyramid pyramid_;
  TrackingResult tracked_;
  bool starting_ = false;
  bool forgets_stereo_ = false;  // with the next keyframe
  SE3 T_new_old_;                // of a frame that becomes a keyframe

  // Where the camera is.
  StampedPose last_pose_;
  OdomPose odom_pose_;  // the same, with what is not known of it
  Step step_;
  Brightness brightness_;  // of the last frame, relative to the keyframe
  bool was_lost_ = false;
  Stamp good_again_ = kNoStamp;  // first usable image after a loss
  ReadoutEstimator readout_estimator_;
  ImageNoise noise_{static_cast<double>(TrackingOptions().image_noise)};

  // The keyframe.
  bool has_keyframe_ = false;
  double stereo_readout_ = 0.0;  // [s] with which stereo began
  Stamp keyframe_stamp_ = kNoStamp;
  std::uint32_t revision_ = 0;
  GreyImage keyframe_grey_;
  OdomPose keyframe_pose_;
  Step keyframe_step_;
  RgbdFrame keyframe_sensor_;  // with its depth, until the keyframe's motion is known
  StereoViews views_;
  double mean_inverse_depth_ = 1.0;
  double parallax_ = 0.0, previous_parallax_ = 0.0;  // largest distance from it in depths of the scene
  DepthCells keyframe_cells_, frame_cells_;
  SemiDenseMapper mapper_;
  TrackingDepth tracking_depth_;
  InverseDepthImage stereo_;
  TrackingReference reference_;
  RecentKeyframes recent_keyframes_;
};

VisualOdometry::VisualOdometry(const PinholeCamera& camera, const OdometryOptions& options)
    : implementation_(std::make_unique<Implementation>(camera, options)) {}
VisualOdometry::~VisualOdometry() = default;

TrackingResult VisualOdometry::track(const RgbdFrame& frame) {
  return implementation_->track(frame);
}
std::shared_ptr<const KeyframeMap> VisualOdometry::map() {
  return implementation_->map();
}
void VisualOdometry::reset() {
  implementation_->reset();
}
void VisualOdometry::setOptions(const OdometryOptions& options) {
  implementation_->setOptions(options);
}

}  // namespace rgbd_sfm_fusion
