// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/core/kept_surface.h"

#include <gtest/gtest.h>

#include "core/index_fixture.h"
#include "core/surface_fixture.h"

namespace voxid {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::optional<KeptSurface> read(const Bytes& bytes) { return KeptSurface::of({bytes.data(), bytes.size()}); }

TEST(KeptSurface, GivesItsNumbersBack) {
  const Bytes bytes = test::keptTetrahedron();
  const auto kept = read(bytes);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->header().vertices, 4u);
  EXPECT_EQ(kept->header().triangles, 4u);
  EXPECT_EQ(kept->header().folds[1], 3);
  EXPECT_EQ(kept->vertex(2), (std::array<std::int16_t, 3>{-18918, 18918, -18918}));
  EXPECT_EQ(kept->triangle(3), (std::array<std::uint16_t, 3>{1, 2, 3}));
}

TEST(KeptSurface, WhatIsNotWholeIsNone) {
  const Bytes good = test::keptTetrahedron();
  for (std::size_t length = 0; length < good.size(); ++length)
    EXPECT_FALSE(read({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)})) << length;
  Bytes bad = good;
  bad.push_back(0);
  EXPECT_FALSE(read(bad)) << "longer than its numbers say";
  bad = good;
  bad[11] = 1;
  EXPECT_FALSE(read(bad)) << "padding";
  bad = good;
  bad[bad.size() - 2] = 4;
  EXPECT_FALSE(read(bad)) << "a vertex that is not there";
  bad = good;
  bad[3] = 0x80;
  EXPECT_FALSE(read(bad)) << "vertices beyond all bounds";
}

TEST(KeptSurface, AnIndexKeepsThemByModel) {
  test::Folder folder;
  IndexContent content = test::randomContent(2, 2, 3, 1);
  const std::string without = folder.file("without.vxi");
  ASSERT_TRUE(writeIndex(content, without).ok());
  EXPECT_FALSE(test::openGood(without)->hasSurfaces());
  for (ModelRecord& model : content.models) {
    if (model.name == "m1") model.surface = test::keptTetrahedron();
  }
  const auto index = test::writtenIndex(folder, content);
  EXPECT_EQ(index->verify().sentence, "");
  EXPECT_EQ(index->header().minor, 5);
  EXPECT_EQ(index->surfaceBytes(), 5 * 8 + 2 * test::keptTetrahedron().size());
  EXPECT_TRUE(index->surface(0).empty());
  const Span<const std::uint8_t> surface = index->surface(1);
  EXPECT_EQ(Bytes(surface.begin(), surface.end()), test::keptTetrahedron());
  EXPECT_TRUE(index->surface(4).empty()) << "there is no such model";
}

TEST(KeptSurface, ASurfaceThatIsNotWholeIsNotWritten) {
  test::Folder folder;
  IndexContent content = test::randomContent(1, 1, 1, 1);
  content.models[0].surface = {1, 2, 3};
  const Status status = writeIndex(content, folder.file("x.vxi"));
  EXPECT_NE(status.sentence.find("model c100/m0 has a surface that is not whole"), std::string::npos)
      << status.sentence;
}

}  // namespace
}  // namespace voxid
