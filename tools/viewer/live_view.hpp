// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The page of a run that goes on, served on a thread of its own. The run hands sweeps over and
// never waits for the page: what is not taken in time is dropped, the oldest first.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "adit/tools/viewer/live_scene.hpp"
#include "adit/tools/viewer/live_sweep.hpp"
#include "adit/tools/viewer/view_data.hpp"
#include "adit/tools/viewer/view_server.hpp"

namespace adit {

class LiveView {
 public:
  /// Serves from now on. `title`: what is mapped; `page` must outlive it. Throws UsageError where
  /// the port cannot be listened on.
  LiveView(const std::string& title, std::string_view page, const ViewAccess& access,
           uint16_t port);
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  std::string link() const { return server_.link(); }
  std::string foxglove_link() const { return server_.foxglove_link(); }

  /// In words, what the run is doing now.
  void set_doing(const std::string& doing);
  /// The next sweep.
  void add(const SweepPlaced& placed, const LiveProgress& progress);
  /// The graph is read from that map from now on, beside the run that writes it.
  void show_map(const std::filesystem::path& map);
  /// Not any more: nobody reads the map when this returns.
  void leave_map();
  /// In place of all this, the pages show the result of the run, and say `text`.
  void show_result(std::unique_ptr<ViewData> result, const std::string& text);

  /// False where an error has ended the service; end() throws it.
  bool serves();
  /// Ends the service once `stop` says so, which is asked ten times a second. Throws what has ended
  /// it before.
  ViewCounts end(const std::function<bool()>& stop);

 private:
  /// What the run has handed over.
  struct Handed {
    std::deque<LiveSweep> sweeps{};
    std::optional<std::string> doing{};
    std::unique_ptr<ViewData> result{};
    std::string result_text{};
  };

  ViewSite site(std::string_view page);
  void serve();
  void join();
  bool take();
  void read_graph();
  ViewNews news(uint64_t told);
  std::shared_ptr<FoxgloveFeed> foxglove();

  // The run's side.
  LiveSweepMaker maker_;
  // Of both sides.
  std::mutex mutex_;
  Handed handed_;
  bool ended_ = false;    ///< by end()
  bool failed_ = false;   ///< by an error
  std::mutex map_mutex_;  ///< held while the map is read
  std::filesystem::path map_;
  // The server's side.
  LiveScene scene_;
  std::shared_ptr<FoxgloveFeed> foxglove_;  ///< of the scene
  LiveGraphReader graph_reader_;
  std::chrono::steady_clock::time_point next_read_{};
  bool watched_ = false;  ///< somebody has asked for news since the map was read
  std::unique_ptr<ViewData> result_;
  std::string result_text_;
  ViewCounts counts_;
  std::exception_ptr failure_;

  ViewServer server_;
  std::thread thread_;
};

}  // namespace adit
