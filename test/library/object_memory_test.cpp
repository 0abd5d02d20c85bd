// SPDX-License-Identifier: BSD-3-Clause
#include "voxid/geometry/object_memory.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/index_fixture.h"

namespace voxid {
namespace {

using Eigen::Vector3f;
using Numbers = std::vector<std::uint32_t>;

/// Three categories of one model with ten views; thirty frames a second.
class ObjectMemoryTest : public testing::Test {
 protected:
  static constexpr int kFrame_us = 33333;

  ObjectMemoryTest() : index_(test::writtenIndex(folder_, test::randomContent(3, 1, 10, 1))) {}

  Numbers frame(const std::vector<Sighting>& sightings) {
    now_us_ += kFrame_us;
    const auto numbers = memory_.update(now_us_, Vector3f::UnitZ(), {sightings.data(), sightings.size()}, params_);
    return {numbers.begin(), numbers.end()};
  }
  void pass(int frames) { now_us_ += frames * kFrame_us; }

  /// The label after a frame with these distances of the categories.
  std::uint32_t look(std::uint32_t first, std::uint32_t second, std::uint32_t third = 1000, std::size_t sighting = 0) {
    std::vector<Neighbour> categories{{0, first}, {10, second}, {20, third}};
    std::sort(categories.begin(), categories.end());
    const Nearest nearest{{categories.data(), 3}, {categories.data(), 3}, 30};
    const Answer alone = classify(*index_, nearest, ClassifyMethod::Vote, 0);
    return memory_.remember(sighting, *index_, nearest, alone, 0).alternatives[0].category;
  }

  static Sighting at(float x, float y, float z = 0.05f, const Vector3f& size = {0.1f, 0.08f, 0.1f}) {
    return {{x, y, z}, size};
  }

  test::Folder folder_;
  std::shared_ptr<const Index> index_;
  MemoryParams params_;
  ObjectMemory memory_{3};
  std::int64_t now_us_ = 1000000;
};

TEST_F(ObjectMemoryTest, NumbersFollowTheObjectsWhateverTheOrder) {
  EXPECT_EQ(frame({at(0, 0), at(0.3f, 0)}), (Numbers{1, 2}));
  EXPECT_EQ(frame({at(0.31f, 0), at(0.01f, 0)}), (Numbers{2, 1}));
  EXPECT_EQ(frame({at(0.32f, 0), at(0.02f, 0, 0.2f), at(0.6f, 0)}), (Numbers{2, 1, 3})) << "height does not count";
}

TEST_F(ObjectMemoryTest, EachIsTakenOnceAndTheNearestPairComesFirst) {
  frame({at(0, 0)});
  EXPECT_EQ(frame({at(0.03f, 0), at(0.01f, 0)}), (Numbers{2, 1}));
}

TEST_F(ObjectMemoryTest, AMovedObjectHasANewNumberAtOnce) {
  frame({at(0, 0)});
  EXPECT_EQ(frame({at(0.051f, 0)}), (Numbers{2}));
}

TEST_F(ObjectMemoryTest, OcclusionIsToleratedForSeconds) {
  frame({at(0, 0), at(0.3f, 0)});
  pass(60);
  EXPECT_EQ(frame({at(0.3f, 0)}), (Numbers{2}));
  pass(28);
  EXPECT_EQ(frame({at(0, 0)}), (Numbers{1})) << "2.97 s after it was seen last";
  pass(91);
  EXPECT_EQ(frame({at(0, 0)}), (Numbers{3})) << "more than 3 s";
}

TEST_F(ObjectMemoryTest, AnotherSizeInTheSamePlaceIsNoticedWithinHalfASecond) {
  frame({at(0, 0)});
  int frames = 0;
  while (frame({at(0, 0, 0.05f, {0.14f, 0.08f, 0.1f})})[0] == 1) ASSERT_LT(++frames, 30);
  EXPECT_LE((frames + 1) * kFrame_us, 500000);
  EXPECT_GE(frames, 6) << "a frame or two of another size are noise";
}

TEST_F(ObjectMemoryTest, AFifthOrAFewMillimetresMoreAreNoOtherSize) {
  const auto numbersWithinHalfASecond = [&](const Vector3f& before, const Vector3f& after) {
    pass(100);  // forgotten
    frame({at(0, 0, 0.05f, before)});
    const std::uint32_t first = frame({at(0, 0, 0.05f, before)})[0];
    for (int i = 0; i < 14; ++i) frame({at(0, 0, 0.05f, after)});
    return frame({at(0, 0, 0.05f, after)})[0] - first + 1;
  };
  EXPECT_EQ(numbersWithinHalfASecond({0.1f, 0.08f, 0.1f}, {0.12f, 0.096f, 0.12f}), 1u);
  EXPECT_EQ(numbersWithinHalfASecond({0.03f, 0.02f, 0.03f}, {0.039f, 0.029f, 0.03f}), 1u);
  EXPECT_EQ(numbersWithinHalfASecond({0.03f, 0.02f, 0.03f}, {0.045f, 0.02f, 0.03f}), 2u);
}

TEST_F(ObjectMemoryTest, ASizeThatDoublesInFiveFramesIsAnotherObjects) {
  frame({at(0, 0)});
  Vector3f size = at(0, 0).extents_m;
  for (int i = 0; i < 5; ++i) frame({at(0, 0, 0.05f, size *= 1.2f)});
  for (int i = 0; i < 10; ++i) frame({at(0, 0, 0.05f, size)});
  EXPECT_EQ(frame({at(0, 0, 0.05f, size)}), (Numbers{2}));
}

TEST_F(ObjectMemoryTest, ASizeThatChangesSlowlyIsTheSameObjects) {
  for (int i = 0; i < 100; ++i) {
    const float width_m = 0.1f + 0.001f * static_cast<float>(i);
    ASSERT_EQ(frame({at(0, 0, 0.05f, {width_m, 0.08f, 0.1f})})[0], 1u) << i;
  }
}

TEST_F(ObjectMemoryTest, ABriefChangeOfSizeLeavesTheObject) {
  for (int i = 0; i < 40; ++i) {
    const bool hidden = i % 10 >= 6;  // four frames of ten
    ASSERT_EQ(frame({at(0, 0, 0.05f, {hidden ? 0.05f : 0.1f, 0.08f, 0.1f})})[0], 1u) << i;
  }
}

TEST_F(ObjectMemoryTest, AThingThatFallsIntoPartsNowAndThenKeepsItsNumber) {
  const std::vector<Sighting> parts{at(-0.012f, 0, 0.05f, {0.06f, 0.049f, 0.065f}),
                                    at(0.016f, 0, 0.05f, {0.058f, 0.027f, 0.065f})};
  for (int i = 0; i < 100; ++i) {
    const bool falls = i % 25 == 24;
    const float wander_m = i % 25 == 0 ? 0.006f : 0;  // nearer to the other part than to that which had the number
    const Sighting whole = at(wander_m, 0, 0.05f, {0.085f, 0.06f, 0.065f});
    const Numbers numbers = frame(falls ? parts : std::vector<Sighting>{whole});
    ASSERT_TRUE(falls || numbers[0] == 1) << i;
  }
}

TEST_F(ObjectMemoryTest, AnotherThingOfTheSameSizeIsNoticedWithinHalfASecond) {
  for (int i = 0; i < 60; ++i) {
    frame({at(0, 0)});
    ASSERT_EQ(look(100, 300), 0u);
  }
  int frames = 0;
  do {
    frame({at(0, 0)});
    ASSERT_LT(++frames, 30);
  } while (look(300, 100) != 1);
  EXPECT_LE(frames * kFrame_us, 500000);
  EXPECT_EQ(memory_.numberOf(0), 2u);
  frame({at(0, 0)});
  EXPECT_EQ(memory_.numberOf(0), 2u);
}

TEST_F(ObjectMemoryTest, AThingWhoseOldCategoryIsNoLongerMetIsAnotherOne) {
  const auto lookOnlyAt = [&](std::uint32_t view, std::uint32_t distance) {
    Answer answer;
    answer.count = 1;
    answer.alternatives[0] = {view / 10, view, distance, 500};
    memory_.remember(0, *index_, answer, 0);
  };
  for (int i = 0; i < 60; ++i) {
    frame({at(0, 0)});
    lookOnlyAt(0, 100);
  }
  int frames = 0;
  while (memory_.numberOf(0) == 1) {
    frame({at(0, 0)});
    lookOnlyAt(10, 200);
    ASSERT_LT(++frames, 15);
  }
}

TEST_F(ObjectMemoryTest, NoiseChangesTheLabelAtMostOnceAfterTheFirstSecond) {
  test::Random random(5);
  std::uint32_t label = 9;
  int changes = 0;
  for (int i = 0; i < 900; ++i) {
    frame({at(0, 0)});
    const auto noise = [&] { return static_cast<std::uint32_t>(random.below(60)); };
    const std::uint32_t now = look(100 + noise(), 102 + noise(), 105 + noise());
    if (i > 30) changes += now != label;
    label = now;
  }
  EXPECT_LE(changes, 1);
  EXPECT_EQ(memory_.numberOf(0), 1u);
}

TEST_F(ObjectMemoryTest, ALabelGivesWayToWhatIsBetterByASixteenth) {
  const auto labelAfter = [&](int frames, std::uint32_t first, std::uint32_t second) {
    std::uint32_t label = 0;
    for (int i = 0; i < frames; ++i) {
      frame({at(0, 0)});
      label = look(first, second);
    }
    return label;
  };
  EXPECT_EQ(labelAfter(40, 100, 110), 0u);
  EXPECT_EQ(labelAfter(1500, 100, 97), 0u);  // 50 s: five half-lives
  EXPECT_EQ(labelAfter(1500, 100, 88), 1u);
}

TEST_F(ObjectMemoryTest, EachOfTenThingsAtRestIsDescribedOnceInItsTimeAndEachFrameHasItsShare) {
  params_.memory_describe_ms = 100;
  std::vector<Sighting> ten;
  for (int i = 0; i < 10; ++i) ten.push_back(at(0.2f * static_cast<float>(i), 0));
  std::vector<int> described(ten.size());
  const auto describeWhatIsDue = [&] {
    int due = 0;
    for (std::size_t i = 0; i < ten.size(); ++i) {
      if (!memory_.isDue(i)) continue;
      look(100, 300, 1000, i);
      ++described[i];
      ++due;
    }
    return due;
  };
  frame(ten);
  EXPECT_EQ(describeWhatIsDue(), 10) << "all are new";
  for (int i = 0; i < 90; ++i) {  // three seconds
    frame(ten);
    ASSERT_LE(describeWhatIsDue(), 4) << i;
  }
  for (const int times : described) EXPECT_TRUE(times >= 30 && times <= 31) << times;
}

TEST_F(ObjectMemoryTest, WhatIsNotDueIsWhatItWas) {
  for (int i = 0; i < 30; ++i) {
    frame({at(0, 0)});
    look(100 + static_cast<std::uint32_t>(i), 110);
  }
  frame({at(0, 0)});
  const Answer before = memory_.recall(0, *index_, 0);
  EXPECT_EQ(before.alternatives[0].category, 1u);
  EXPECT_EQ(before.alternatives[0].distance, 110u);
  EXPECT_EQ(before.count, 3);
  frame({at(0, 0)});
  EXPECT_EQ(memory_.recall(0, *index_, 0).score_permille, before.score_permille);
  EXPECT_EQ(memory_.recall(1, *index_, 0).count, 0) << "never seen";
}

TEST_F(ObjectMemoryTest, WhatLooksOtherwiseIsDescribedInEveryFrameAndAnExchangeIsStillNoticed) {
  for (int before = 30; before < 40; ++before) {  // the exchange comes anywhere between two turns
    const Sighting thing = at(static_cast<float>(before), 0);
    std::uint32_t first = 0;
    for (int i = 0; i < before; ++i) {
      first = frame({thing})[0];
      if (memory_.isDue(0)) look(100, 300);
    }
    int frames = 0, described = 0;
    do {
      frame({thing});
      ASSERT_LT(++frames, 30);
      if (memory_.isDue(0)) look(300, 100), ++described;
    } while (memory_.numberOf(0) == first);
    EXPECT_LE(frames * kFrame_us, 500000);
    EXPECT_GE(described, frames - 4) << "it waits for its turn, and then is described in every frame";
  }
}

TEST_F(ObjectMemoryTest, WhatMeasuresOtherwiseIsDue) {
  for (int i = 0; i < 3; ++i) {
    frame({at(0, 0)});
    look(100, 300);
  }
  for (int i = 0; i < 6; ++i) {
    frame({at(0, 0, 0.05f, {0.14f, 0.08f, 0.1f})});
    ASSERT_TRUE(memory_.isDue(0));
    look(100, 300);
  }
}

TEST_F(ObjectMemoryTest, EverythingIsDueWithoutATimeAndWithoutAHalfLife) {
  const auto dueAtRest = [&](const MemoryParams& params) {
    params_ = params;
    int due = 0;
    for (int i = 0; i < 10; ++i) {
      frame({at(0, 0)});
      if (memory_.isDue(0)) look(100, 300), ++due;
    }
    return due;
  };
  MemoryParams at_once, forgetful;
  at_once.memory_describe_ms = 0;
  forgetful.memory_half_life_ms = 0;
  EXPECT_LE(dueAtRest({}), 5);
  EXPECT_EQ(dueAtRest(at_once), 10);
  EXPECT_EQ(dueAtRest(forgetful), 10);
}

TEST_F(ObjectMemoryTest, TimeThatGoesBackForgetsEverything) {
  frame({at(0, 0)});
  now_us_ -= 10 * kFrame_us;
  EXPECT_EQ(frame({at(0, 0)}), (Numbers{2}));
}

TEST_F(ObjectMemoryTest, MoreThanFitGetNoNumber) {
  std::vector<Sighting> many;
  for (int i = 0; i < 150; ++i) many.push_back(at(0.2f * static_cast<float>(i), 0));
  const Numbers numbers = frame(many);
  EXPECT_EQ(numbers[127], 128u);
  EXPECT_EQ(numbers[128], 0u);
  EXPECT_EQ(numbers.size(), 150u);
  EXPECT_EQ(frame({}), Numbers{});
}

}  // namespace
}  // namespace voxid
