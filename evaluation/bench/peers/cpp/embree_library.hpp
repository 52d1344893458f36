// SPDX-License-Identifier: MIT OR Apache-2.0
// Embree 3 or 4, loaded and not linked: the versions name their functions alike.
#pragma once
#include <dlfcn.h>
#include <embree3/rtcore.h>

#include <stdexcept>
#include <string>

namespace bench {

/// What is called alike in both versions, from one library.
class EmbreeLibrary {
  // First, since the others are made with it.
  void* handle_;

 public:
  explicit EmbreeLibrary(const char* path) : handle_(dlopen(path, RTLD_NOW | RTLD_LOCAL)) {
    if (!handle_) throw std::runtime_error(dlerror());
  }

#define CALLED(name) const decltype(&::name) name = find<decltype(&::name)>(#name)
  CALLED(rtcNewDevice);
  CALLED(rtcReleaseDevice);
  CALLED(rtcNewScene);
  CALLED(rtcReleaseScene);
  CALLED(rtcSetSceneFlags);
  CALLED(rtcSetSceneBuildQuality);
  CALLED(rtcCommitScene);
  CALLED(rtcNewGeometry);
  CALLED(rtcReleaseGeometry);
  CALLED(rtcSetGeometryBuildQuality);
  CALLED(rtcSetSharedGeometryBuffer);
  CALLED(rtcUpdateGeometryBuffer);
  CALLED(rtcCommitGeometry);
  CALLED(rtcAttachGeometry);
  CALLED(rtcPointQuery);

 protected:
  template <typename F>
  F find(const char* name) const {
    const auto found = reinterpret_cast<F>(dlsym(handle_, name));
    if (!found) throw std::runtime_error(std::string("Embree has no ") + name);
    return found;
  }
};

}  // namespace bench
