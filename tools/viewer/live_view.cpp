// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/live_view.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "adit/tools/support/input_error.hpp"
#include "adit/tools/viewer/foxglove_live_feed.hpp"
#include "adit/tools/viewer/view_protocol.hpp"

namespace adit {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kAskedAgain{100};
constexpr std::size_t kMostHanded = 64;  // sweeps that wait for the server
constexpr std::chrono::milliseconds kBetweenReads{1000};
constexpr int kReadShare = 10;  // of the time goes by between readings of the map, for each of them

}  // namespace

LiveView::LiveView(const std::string& title, std::string_view page, const ViewAccess& access,
                   uint16_t port)
    : scene_(title),
      foxglove_(std::make_shared<FoxgloveLiveFeed>(scene_)),
      server_(site(page), access, port),
      thread_([this] { serve(); }) {}

LiveView::~LiveView() {
  join();
}

/// Ends the thread.
void LiveView::join() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  if (thread_.joinable()) {
    thread_.join();
  }
}

ViewSite LiveView::site(std::string_view page) {
  return {.page = page,
          .greeting = [] { return std::vector<std::string>(); },  // all of it is news
          .answer =
              [this](std::string_view message) {
                return result_ ? answer_to(*result_, message) : answer_while_running(message);
              },
          .tile =
              [this](uint32_t number) {
                // Asked for before the result came, a tile may be of no number that it has.
                std::string message = result_ ? result_->tile(number) : scene_.tile(number);
                return message.empty() ? tile_message(number, {}) : message;
              },
          .news = [this](uint64_t told) { return news(told); },
          .foxglove = [this] { return foxglove(); }};
}

void LiveView::serve() {
  try {
    // Ten times a second the server asks whether to stop: then it takes what was handed over.
    counts_ = server_.run([this] { return take(); });
  } catch (...) {
    failure_ = std::current_exception();
    const std::lock_guard lock(mutex_);
    failed_ = true;
  }
}

/// Returns whether that was all.
bool LiveView::take() {
  Handed handed;
  {
    const std::lock_guard lock(mutex_);
    if (ended_) {
      return true;
    }
    handed = std::exchange(handed_, {});
  }
  for (LiveSweep& sweep : handed.sweeps) {
    scene_.add(std::move(sweep));
  }
  if (handed.doing) {
    scene_.set_doing(*handed.doing);
  }
  if (handed.result) {
    result_ = std::move(handed.result);
    result_text_ = handed.result_text;
  }
  read_graph();
  return false;
}

void LiveView::read_graph() {
  if (!watched_ || result_ || Clock::now() < next_read_) {
    return;
  }
  const std::lock_guard lock(map_mutex_);
  if (map_.empty()) {
    return;
  }
  const auto begun = Clock::now();
  try {
    scene_.set(graph_reader_.read(map_, scene_.span()));
  } catch (const FileError&) {
    // The graph stays as it was read before; if the map is damaged, the run itself says so.
  }
  watched_ = false;
  next_read_ =
      Clock::now() + std::max<Clock::duration>(kBetweenReads, kReadShare * (Clock::now() - begun));
}

ViewNews LiveView::news(uint64_t told) {
  watched_ = true;
  if (!result_) {
    return scene_.news(told);
  }
  const uint64_t version = scene_.version() + 1;
  ViewNews news{.told = version};
  if (told < version) {
    for (const std::string& text :
         {result_->scene(), result_->graph(), adit::told(result_text_, false)}) {
      news.texts.push_back(std::make_shared<const std::string>(text));
    }
  }
  return news;
}

std::shared_ptr<FoxgloveFeed> LiveView::foxglove() {
  watched_ = true;
  return result_ ? result_->foxglove() : foxglove_;
}

void LiveView::set_doing(const std::string& doing) {
  const std::lock_guard lock(mutex_);
  handed_.doing = doing;
}

void LiveView::add(const SweepPlaced& placed, const LiveProgress& progress) {
  LiveSweep sweep = maker_.make(placed, progress);
  const std::lock_guard lock(mutex_);
  handed_.sweeps.push_back(std::move(sweep));
  if (handed_.sweeps.size() > kMostHanded) {
    handed_.sweeps.pop_front();
  }
}

void LiveView::show_map(const std::filesystem::path& map) {
  const std::lock_guard lock(map_mutex_);
  map_ = map;
}

void LiveView::leave_map() {
  show_map({});
}

void LiveView::show_result(std::unique_ptr<ViewData> result, const std::string& text) {
  const std::lock_guard lock(mutex_);
  handed_.result = std::move(result);
  handed_.result_text = text;
}

bool LiveView::serves() {
  const std::lock_guard lock(mutex_);
  return !failed_;
}

ViewCounts LiveView::end(const std::function<bool()>& stop) {
  while (!stop() && serves()) {
    std::this_thread::sleep_for(kAskedAgain);  // a signal sets a flag, and wakes nobody
  }
  join();
  if (failure_) {
    std::rethrow_exception(std::exchange(failure_, nullptr));
  }
  return counts_;
}

}  // namespace adit
