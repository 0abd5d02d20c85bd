// SPDX-License-Identifier: BSD-3-Clause
#include "oni_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>

namespace voxid {
namespace {

constexpr char kFileMagic[4] = {'N', 'I', '1', '0'};
constexpr std::int64_t kFileHeaderBytes = 24;
constexpr std::uint32_t kRecordMagic = 0x0052494e;  // "NIR"
constexpr std::uint32_t kLastRecord = 11;

/// Little-endian, 28 bytes in the file.
struct RecordHead {
  std::uint32_t magic, type, node, fields_bytes /* with the head */, payload_bytes;
};
constexpr std::uint32_t kRecordHeadBytes = 28;

class File {
 public:
  explicit File(const std::string& path) : fd_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~File() {
    if (fd_ >= 0) close(fd_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool good() const { return fd_ >= 0; }
  bool read(std::int64_t at, void* to, std::size_t bytes) const {
    return pread(fd_, to, bytes, at) == static_cast<ssize_t>(bytes);
  }

 private:
  int fd_;
};

Status damaged(const std::string& path, const std::string& what) {
  return Status::damaged(path + " " + what + "; expected an .oni recording; record it again");
}

bool isRecord(const RecordHead& head) { return head.magic == kRecordMagic && head.fields_bytes >= kRecordHeadBytes; }

Status checkKind(const std::string& path) {
  struct stat info = {};
  if (stat(path.c_str(), &info) != 0) return Status::cannotDo(path + " does not exist; expected an .oni recording");
  if (!S_ISREG(info.st_mode)) return Status::cannotDo(path + " is not a file; expected an .oni recording");
  if (info.st_size == 0) return damaged(path, "is empty");
  return {};
}

}  // namespace

Result<std::int64_t> oniLength(const std::string& path) {
  const Status kind = checkKind(path);
  if (!kind.ok()) return kind;
  const File file(path);
  if (!file.good()) return Status::cannotDo(path + " cannot be read: " + std::strerror(errno));
  char magic[sizeof kFileMagic];
  if (!file.read(0, magic, sizeof magic) || std::memcmp(magic, kFileMagic, sizeof magic) != 0)
    return damaged(path, "is in another format (it does not begin with NI10)");
  struct stat info = {};
  stat(path.c_str(), &info);
  RecordHead head;
  for (std::int64_t at = kFileHeaderBytes; file.read(at, &head, sizeof head) && isRecord(head);) {
    at += static_cast<std::int64_t>(head.fields_bytes) + head.payload_bytes;
    if (head.type == kLastRecord && at <= info.st_size) return at;
  }
  return damaged(path, "is cut short (it has no last record)");
}

}  // namespace voxid
