// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/openni_library.h"

#include <OpenNI.h>
#include <dlfcn.h>

#include <filesystem>

#include "rgbd_sfm_fusion/camera/camera_types.h"

namespace rgbd_sfm_fusion {
namespace {

/// Path of the libOpenNI2 that is loaded; empty where the linker does not tell.
std::string libraryPath() {
  Dl_info info;
  return dladdr(dlsym(RTLD_DEFAULT, "oniInitialize"), &info) == 0 ? "" : info.dli_fname;
}

// OpenNI2 counts initialisations, but not safely from several threads.
std::mutex& initialisationMutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

/// Drivers' threads call it, so it does as little as possible.
class OpenNiLibrary::Listener : public openni::OpenNI::DeviceConnectedListener,
                                public openni::OpenNI::DeviceDisconnectedListener,
                                public openni::OpenNI::DeviceStateChangedListener {
 public:
  explicit Listener(OpenNiLibrary* library) : library_(library) {
    openni::OpenNI::addDeviceConnectedListener(this);
    openni::OpenNI::addDeviceDisconnectedListener(this);
    openni::OpenNI::addDeviceStateChangedListener(this);
  }

  void stop() {
    openni::OpenNI::removeDeviceConnectedListener(this);
    openni::OpenNI::removeDeviceDisconnectedListener(this);
    openni::OpenNI::removeDeviceStateChangedListener(this);
  }

  void onDeviceConnected(const openni::DeviceInfo*) override { ++library_->changes_; }
  void onDeviceDisconnected(const openni::DeviceInfo* info) override {
    library_->disconnected(info->getUri());
  }
  void onDeviceStateChanged(const openni::DeviceInfo* info, openni::DeviceState state) override {
    if (state == openni::DEVICE_STATE_ERROR) library_->disconnected(info->getUri());
  }

 private:
  OpenNiLibrary* library_;
};

std::shared_ptr<OpenNiLibrary> OpenNiLibrary::acquire() {
  const std::lock_guard<std::mutex> lock(initialisationMutex());
  static std::weak_ptr<OpenNiLibrary> shared;
  std::shared_ptr<OpenNiLibrary> library = shared.lock();
  if (!library) {
    library.reset(new OpenNiLibrary());
    shared = library;
  }
  return library;
}

OpenNiLibrary::OpenNiLibrary() {
  if (openni::OpenNI::initialize() != openni::STATUS_OK) {
    const std::string reason = lastError();
    openni::OpenNI::shutdown();  // a failed initialisation counts too: without this, the next would seem to
                                 // succeed
    throw CameraError("OpenNI2 cannot start: " + reason + "; its drivers are looked for in " +
                      driverFolder());
  }
  listener_ = std::make_unique<Listener>(this);
}

OpenNiLibrary::~OpenNiLibrary() {
  const std::lock_guard<std::mutex> lock(initialisationMutex());
  listener_->stop();
  openni::OpenNI::shutdown();  // ends the drivers' threads, which must happen before the listener goes
}

std::vector<std::string> OpenNiLibrary::uris() const {
  openni::Array<openni::DeviceInfo> devices;
  openni::OpenNI::enumerateDevices(&devices);
  std::vector<std::string> uris;
  uris.reserve(static_cast<std::size_t>(devices.getSize()));
  for (int i = 0; i < devices.getSize(); ++i) uris.emplace_back(devices[i].getUri());
  return uris;
}

std::uint64_t OpenNiLibrary::disconnections(const std::string& uri) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = disconnections_.find(uri);
  return found == disconnections_.end() ? 0 : found->second;
}

void OpenNiLibrary::disconnected(const std::string& uri) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++disconnections_[uri];
  }
  ++changes_;
}

std::string OpenNiLibrary::lastError() {
  std::string text = openni::OpenNI::getExtendedError();
  while (!text.empty() && (text.back() == '\n' || text.back() == '\t')) text.pop_back();
  return text.empty() ? "no reason given" : text;
}

std::string OpenNiLibrary::whyNotFrom(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path wanted = fs::path(folder) / "libOpenNI2.so.0", loaded = libraryPath();
  if (fs::equivalent(wanted, loaded, error)) return "";
  const std::string found = "openni2 is " + folder + ", but " + loaded.string() + " is used: ";
  if (!fs::path(folder).is_absolute()) return found + "expected an absolute path";
  if (!fs::exists(wanted, error))
    return found + "expected libOpenNI2.so.0 in that folder, and OpenNI2/Drivers beside it";
  return found +
         "that folder's library cannot be loaded (of another processor, or lacking a library that it needs: "
         "see ldd)";
}

std::string OpenNiLibrary::driverFolder() {
  const std::string path = libraryPath();
  if (path.empty()) return "OpenNI2/Drivers beside libOpenNI2";
  return path.substr(0, path.rfind('/') + 1) + "OpenNI2/Drivers";
}

}  // namespace rgbd_sfm_fusion
