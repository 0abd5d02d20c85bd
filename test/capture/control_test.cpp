// SPDX-License-Identifier: BSD-3-Clause
#include "openni2_replay/control.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "fixtures.h"
#include "openni2_replay/config.h"

namespace voxid::replay {
namespace {

TEST(ReplayControl, UnderstandsItsCommands) {
  Command c;
  ASSERT_TRUE(parseCommand("unplug", c));
  EXPECT_EQ(c.kind, Command::Kind::Unplug);
  EXPECT_EQ(c.amount, 0);
  ASSERT_TRUE(parseCommand("unplug 250", c));
  EXPECT_EQ(c.amount, 250);
  ASSERT_TRUE(parseCommand("stall 3000", c));
  EXPECT_EQ(c.kind, Command::Kind::Stall);
  EXPECT_EQ(c.amount, 3000);
}

TEST(ReplayControl, RefusesTheRest) {
  Command c;
  for (const char* bad : {"", "stall", "stall x", "drop 0", "drop -1", "unplug x", "plug"})
    EXPECT_FALSE(parseCommand(bad, c)) << bad;
}

TEST(ReplayControl, ReadsOnlyWholeLinesThatCameLater) {
  TempFolder folder;
  std::ofstream(folder / "control") << "unplug\n";
  ControlFile control(folder / "control");
  EXPECT_TRUE(control.poll().empty());
  std::ofstream(folder / "control", std::ios::app) << "drop 1\nsta" << std::flush;
  EXPECT_EQ(control.poll(), std::vector<std::string>{"drop 1"});
  std::ofstream(folder / "control", std::ios::app) << "ll 5\n" << std::flush;
  EXPECT_EQ(control.poll(), std::vector<std::string>{"stall 5"});
}

TEST(ReplayControl, ReadsAFifo) {
  TempFolder folder;
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  ControlFile control(folder / "fifo");
  std::ofstream(folder / "fifo") << "replug\n" << std::flush;
  EXPECT_EQ(control.poll(), std::vector<std::string>{"replug"});
}

TEST(ReplayConfig, ReadsAUri) {
  std::string problem;
  const auto config = configFromUri("replay:/some/where?fps=15&loop=0&hold=3&serial=X&unit=100um&mirror=1", problem);
  ASSERT_TRUE(config) << problem;
  EXPECT_EQ(config->folder, "/some/where");
  EXPECT_EQ(config->fps, 15);
  EXPECT_FALSE(config->loop);
  EXPECT_EQ(config->hold, 3);
  EXPECT_EQ(config->serial, "X");
  EXPECT_EQ(config->coding, DepthCoding::TenthMm);
  EXPECT_TRUE(config->mirror);
}

TEST(ReplayConfig, SaysWhatItDoesNotUnderstand) {
  std::string problem;
  EXPECT_FALSE(configFromUri("replay:/x?fps=0", problem));
  EXPECT_NE(problem.find("'fps=0' is not understood"), std::string::npos) << problem;
  problem.clear();
  EXPECT_FALSE(configFromUri("usb://x", problem));
  EXPECT_EQ(problem, "");
}

}  // namespace
}  // namespace voxid::replay
