// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>

namespace voxid {

/// What went wrong, as a kind that programs act on and one sentence that people read
/// (what, where, found, expected, remedy). The kinds are the exit codes of the command line.
struct [[nodiscard]] Status {
  enum class Kind {
    Ok = 0,
    CannotDo = 1,      ///< a missing file, another major version, foreign parameters, no device
    BadUse = 2,        ///< wrong arguments
    NothingFound = 3,  ///< no table, empty table, no model left
    Damaged = 4,       ///< empty, cut, wrong checksum
  };

  Kind kind = Kind::Ok;
  std::string sentence;  ///< without full stop or "voxid:"; empty if Ok

  bool ok() const { return kind == Kind::Ok; }

  static Status cannotDo(std::string s) { return {Kind::CannotDo, std::move(s)}; }
  static Status badUse(std::string s) { return {Kind::BadUse, std::move(s)}; }
  static Status nothingFound(std::string s) { return {Kind::NothingFound, std::move(s)}; }
  static Status damaged(std::string s) { return {Kind::Damaged, std::move(s)}; }
};

/// A value, or the reason why there is none. `value` is meaningful only if `status.ok()`.
template <typename T>
struct [[nodiscard]] Result {
  Status status;
  T value{};

  Result(T v) : value(std::move(v)) {}        // NOLINT: a value is a result
  Result(Status s) : status(std::move(s)) {}  // NOLINT: so is a refusal
  bool ok() const { return status.ok(); }
};

}  // namespace voxid
