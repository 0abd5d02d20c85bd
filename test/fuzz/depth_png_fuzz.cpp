// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a depth image: refused with a reason, or pixels. Once as they are, once with the chunks' sums made
// right, without which nothing would be decoded.
#include <zlib.h>

#include <cstring>
#include <vector>

#include "depth_file.h"
#include "memory_file.h"

namespace {

using namespace voxid;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kSignature = 8, kChunkFrame = 12;

std::uint32_t bigEndian32(const std::uint8_t* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}

void repair(Bytes& bytes) {
  for (std::size_t at = kSignature; at + kChunkFrame <= bytes.size();) {
    const std::size_t length = bigEndian32(&bytes[at]);
    if (length > bytes.size() - at - kChunkFrame) return;
    std::uint8_t* const sum = &bytes[at + 8 + length];
    const auto crc = static_cast<std::uint32_t>(crc32(0, &bytes[at + 4], static_cast<uInt>(length + 4)));
    for (int i = 0; i < 4; ++i) sum[i] = static_cast<std::uint8_t>(crc >> (24 - 8 * i));
    at += kChunkFrame + length;
  }
}

void use(const Bytes& bytes) {
  const fuzz::MemoryFile file(bytes.data(), bytes.size());
  const auto image = cli::readDepthFile(file.path(), cli::CameraChoice{"525,525,319.5,239.5"});
  if (image.ok() == !image.status.sentence.empty()) std::abort();
  if (!image.ok()) return;
  const DepthView view = image.value.view();
  for (int v = 0; v < view.height_px; ++v) {
    for (int u = 0; u < view.width_px; ++u) (void)view.depthUm(u, v);
  }
}

bool isPng(const std::uint8_t* data, std::size_t size) {
  return size >= kSignature && std::memcmp(data, "\x89PNG\r\n\x1a\n", kSignature) == 0;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (!isPng(data, size)) return 0;  // other decoders are OpenCV's own affair
  Bytes bytes(data, data + size);
  use(bytes);
  repair(bytes);
  use(bytes);
  return 0;
}
