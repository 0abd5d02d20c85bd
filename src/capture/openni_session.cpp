// SPDX-License-Identifier: BSD-3-Clause
#include <mutex>

#include "parts.h"

namespace voxid {
namespace {

std::mutex& sessionMutex() {
  static std::mutex mutex;  // OpenNI2 counts its users, without a lock
  return mutex;
}

}  // namespace

Result<std::shared_ptr<OpenNiSession>> OpenNiSession::begin() {
  std::lock_guard<std::mutex> lock(sessionMutex());
  if (openni::OpenNI::initialize() == openni::STATUS_OK) return std::make_shared<OpenNiSession>();
  return Status::cannotDo("OpenNI2 cannot start (" + openNiComplaint() +
                          "); its drivers are missing: install libopenni2-0");
}

OpenNiSession::~OpenNiSession() {
  std::lock_guard<std::mutex> lock(sessionMutex());
  openni::OpenNI::shutdown();
}

std::string openNiComplaint() {
  std::string text = openni::OpenNI::getExtendedError();
  for (char& c : text)
    if (c == '\n' || c == '\t') c = ' ';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

}  // namespace voxid
