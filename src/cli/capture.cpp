// SPDX-License-Identifier: BSD-3-Clause
// voxid capture: which cameras are there, and their frames into a file.
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "command.h"
#include "voxid/capture/record.h"

namespace voxid::cli {
namespace {

struct ListOptions {
  bool json = false;
};

struct RecordOptions {
  std::string out;
  DeviceOptions device;
  RecordLimits limits;
  bool json = false;
};

std::atomic<bool> stop_recording{false};

/// The first Ctrl-C ends the recording in good order, the second one the program.
void onInterrupt(int signal) {
  stop_recording = true;
  std::signal(signal, SIG_DFL);
}

Status list(const ListOptions& options) {
  const auto devices = listDevices();
  if (!devices.ok()) return devices.status;
  if (options.json) {
    nlohmann::ordered_json array = nlohmann::ordered_json::array();
    for (const DeviceDescription& d : devices.value)
      array.push_back({{"uri", d.uri}, {"vendor", d.vendor}, {"name", d.name}, {"serial", d.serial}});
    std::cout << array.dump() << "\n";
  } else {
    int number = 0;
    for (const DeviceDescription& d : devices.value)
      std::printf("#%d  %s %s  serial %s  %s\n", ++number, d.vendor.c_str(), d.name.c_str(),
                  d.serial.empty() ? "-" : d.serial.c_str(), d.uri.c_str());
  }
  return chooseDevice("", devices.value).status;
}

void printProgress(int frames) {
  if (isatty(STDERR_FILENO)) std::fprintf(stderr, "\r\033[K%s", counted(frames, "frame").c_str());
}

void printDone(const RecordOptions& options, const RecordReport& report) {
  if (isatty(STDERR_FILENO)) std::fprintf(stderr, "\r\033[K");
  if (options.json)
    std::cout
        << nlohmann::ordered_json{{"file", options.out}, {"frames", report.frames}, {"seconds", report.seconds}}.dump()
        << "\n";
  else
    std::printf("%s: %s in %.1f s\n", options.out.c_str(), counted(report.frames, "frame").c_str(), report.seconds);
}

Status recordFile(RecordOptions& options) {
  const auto device = Device::open(options.device);
  if (!device.ok()) return device.status;
  if (options.device.colour && !device.value->hasColour())
    return Status::cannotDo("device " + device.value->description().uri +
                            " has no colour stream; record without --color");
  std::signal(SIGINT, onInterrupt);
  std::signal(SIGTERM, onInterrupt);
  options.limits.stop = &stop_recording;
  RecordReport report;
  const Status status = record(*device.value, options.out, options.limits, report, printProgress);
  if (report.frames > 0) printDone(options, report);
  return status;
}

}  // namespace

Run addCapture(CLI::App& app) {
  const auto list_options = std::make_shared<ListOptions>();
  const auto record_options = std::make_shared<RecordOptions>();
  app.require_subcommand(1);
  CLI::App* lister = app.add_subcommand("list", "The devices that OpenNI2 sees");
  lister->add_flag("--json", list_options->json, "One array of uri, vendor, name, serial");
  CLI::App* recorder =
      app.add_subcommand("record", "Record depth without loss to an .oni file, until a limit or Ctrl-C");
  recorder->add_option("--out", record_options->out, "The file; appears once it is whole")
      ->required()
      ->type_name("FILE.oni");
  recorder
      ->add_option("--device", record_options->device.device,
                   "#N, serial number, URI or .oni file (default: the first)")
      ->type_name("D");
  recorder->add_flag("--color", record_options->device.colour, "Record registered colour too");
  auto* frames = recorder->add_option("--frames", record_options->limits.frames, "Stop after so many depth frames")
                     ->check(CLI::Range(1, 100000000));
  recorder->add_option("--seconds", record_options->limits.seconds, "Stop after so many seconds")
      ->check(realRange(0.1, 1e6))
      ->excludes(frames);
  recorder->add_flag("--json", record_options->json, "Print file, frames, seconds as an object");
  return [=] { return *lister ? list(*list_options) : recordFile(*record_options); };
}

}  // namespace voxid::cli
