// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace voxid {

/// Moves codes of one model's views, of a projection, a quarter of the way to their mean and brings them to length
/// again: a view is drawn once, with one draw of noise, size and distance, and what such draws add to a code goes with
/// the mean (shrinkage, as of James and Stein; measured in doc/descriptor.md, section 7). Every model is on its own, so
/// that adding, removing and merging models changes no other code.
void shrinkToMean(const std::vector<std::uint8_t*>& codes, std::size_t code_bytes);

/// The way back for one code of a model, as far as rounding lets it: what the view was before `codes` (`views` of them,
/// one after another, already moved) went to their mean. `code` is one of them.
void takeBackFromMean(const std::uint8_t* codes, std::size_t views, std::size_t code_bytes, std::uint8_t* code);

}  // namespace voxid
