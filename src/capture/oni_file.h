// SPDX-License-Identifier: BSD-3-Clause
// The outer form of an .oni file: a header of 24 bytes, then records, the last of which says that it is the last.
#pragma once

#include <cstdint>
#include <string>

#include "voxid/core/status.h"

namespace voxid {

/// Bytes up to the end of the last record (OpenNI2's recorder leaves a hole of the same size behind it). Reads the head
/// of each record only. CannotDo: no such file. Damaged: empty, another format, or no last record, as in a file that
/// was cut or whose recorder was killed; OpenNI2 itself opens some of those and then waits for ever.
Result<std::int64_t> oniLength(const std::string& path);

}  // namespace voxid
