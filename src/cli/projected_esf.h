// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "compare_codes.h"
#include "compare_views.h"

namespace voxid::cli {

/// ESF made as small as the index's own codes, as these are made of their bins: roots of the bins in bytes, a
/// projection learnt from the views that are compared, codes compared by way of their category's mean.
struct ProjectedEsf {
  std::unique_ptr<ViewCode> code;    ///< "esf_projected"
  std::unique_ptr<CodeTable> table;  ///< of the same views
};

/// `esf`: a table of ESF's bins for `views` of `index`.
ProjectedEsf projectEsf(const Index& index, const std::vector<std::uint32_t>& views, const CodeTable& esf);

}  // namespace voxid::cli
