// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cameras/find_cameras.hpp"

#include <algorithm>
#include <utility>

#include "adit/tools/cameras/camera_file.hpp"
#include "adit/tools/cameras/camera_topics.hpp"
#include "adit/tools/cameras/image_folder.hpp"
#include "adit/tools/cameras/message_images.hpp"
#include "adit/tools/recordings/message_cameras.hpp"
#include "adit/tools/recordings/message_files.hpp"
#include "adit/tools/recordings/ros_codec.hpp"
#include "adit/tools/recordings/ros_images.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNameACalibration =
    "Record the camera's camera_info too, or write a file of cameras (docs/recordings.md)";

/// A recording that is searched for cameras.
struct Search {
  std::vector<fs::path> paths;
  SharedMessageFiles files;
  std::vector<CameraTopic> topics;

  std::vector<const MessageFile*> all_files() const {
    std::vector<const MessageFile*> all;
    for (const std::unique_ptr<MessageFile>& file : *files) {
      all.push_back(file.get());
    }
    return all;
  }

  [[noreturn]] void fail(const std::string& found, const std::string& remedy) const {
    throw InputError(paths.front(), {}, found, remedy);
  }
};

/// "/a, /b".
std::string names_of(const std::vector<CameraTopic>& topics) {
  std::string names;
  for (const CameraTopic& topic : topics) {
    names += (names.empty() ? "" : ", ") + topic.name;
  }
  return names.empty() ? "none" : names;
}

/// The topic that somebody names.
const CameraTopic& require_topic(const Search& search, const std::string& name) {
  const CameraTopic* const topic = find_camera_topic(search.topics, name);
  if (topic == nullptr) {
    search.fail("it has no images on the topic " + name,
                "Topics with images: " + names_of(search.topics));
  }
  if (!topic->problem.empty()) {
    search.fail("no colours can be had of the topic " + topic->name + ": " + topic->problem,
                "Name another topic; those with images: " + names_of(search.topics));
  }
  return *topic;
}

/// The calibration beside the images; none where there is none.
std::optional<CameraModel> model_beside(const Search& search, const std::string& images) {
  const auto info = find_camera_info(search.all_files(), camera_info_topic(images));
  if (!info) {
    return std::nullopt;
  }
  return ros::to_camera(*info, is_rectified(images));
}

CameraModel require_model_beside(const Search& search, const std::string& images) {
  std::optional<CameraModel> model;
  try {
    model = model_beside(search, images);
  } catch (const ros::CodecError& error) {
    search.fail("of the camera with images on " + images + ": " + error.what(), kNameACalibration);
  }
  if (!model) {
    search.fail("the images on " + images + " have no calibration: no sensor_msgs/CameraInfo on " +
                    camera_info_topic(images),
                kNameACalibration);
  }
  return *model;
}

CameraSource source_of(const CameraTopic& topic, const CameraModel& model) {
  return {.name = topic.name, .model = model, .frame = topic.frame, .images = nullptr};
}

std::vector<CameraSource> named_cameras(const Search& search,
                                        const std::vector<std::string>& names) {
  std::vector<CameraSource> cameras;
  for (const std::string& name : names) {
    const CameraTopic& topic = require_topic(search, name);
    cameras.push_back(source_of(topic, require_model_beside(search, topic.name)));
  }
  return cameras;
}

/// True where the first is the better one of the same camera.
bool is_better(const CameraTopic& a, const CameraTopic& b) {
  const auto rank = [](const CameraTopic& topic) {
    return (topic.pixels == ros::PixelKind::colors ? 2 : 0) + (topic.packed ? 0 : 1);
  };
  return rank(a) > rank(b);
}

/// One topic a camera, in their order; those without colours alone where none has any.
std::vector<CameraSource> calibrated_cameras(const Search& search) {
  std::vector<std::pair<CameraTopic, CameraModel>> best;
  std::string problem;
  for (const CameraTopic& topic : search.topics) {
    if (!topic.problem.empty()) {
      continue;
    }
    try {
      const std::optional<CameraModel> model = model_beside(search, topic.name);
      if (!model) {
        continue;
      }
      const std::string info = camera_info_topic(topic.name);
      const auto same = std::ranges::find_if(
          best, [&](const auto& one) { return camera_info_topic(one.first.name) == info; });
      if (same == best.end()) {
        best.emplace_back(topic, *model);
      } else if (is_better(topic, same->first)) {
        *same = {topic, *model};
      }
    } catch (const ros::CodecError& error) {
      problem = " (" + topic.name + ": " + error.what() + ")";
    }
  }
  const auto has_colors = [](const auto& one) {
    return one.first.pixels == ros::PixelKind::colors;
  };
  const bool any_colors = std::ranges::any_of(best, has_colors);
  std::vector<CameraSource> cameras;
  for (const auto& one : best) {
    if (!any_colors || has_colors(one)) {
      cameras.push_back(source_of(one.first, one.second));
    }
  }
  if (cameras.empty()) {
    search.fail("it has no camera with a calibration" + problem +
                    "; its topics with images: " + names_of(search.topics),
                kNameACalibration);
  }
  return cameras;
}

/// True where the topic is one of those named, or none is named.
bool is_chosen(const std::string& topic, const std::vector<std::string>& names) {
  return names.empty() || std::ranges::any_of(names, [&](const std::string& name) {
           return without_transport(name) == without_transport(topic);
         });
}

/// The images of a camera whose file names none: those on the topic that is named, or the only
/// ones.
const CameraTopic& require_only_topic(const Search& search, const std::vector<std::string>& names) {
  std::vector<CameraTopic> readable = search.topics;
  std::erase_if(readable, [&](const CameraTopic& topic) {
    return !topic.problem.empty() || !is_chosen(topic.name, names);
  });
  if (names.size() != 1 && readable.size() != 1) {
    search.fail("the file of cameras names no topic, and this is not the only one with images: " +
                    names_of(search.topics),
                "Name the topic of the camera");
  }
  return require_topic(search, names.size() == 1 ? names.front() : readable.front().name);
}

/// The camera, without its images where these are on a topic: then its name is still the topic's.
CameraSource source_of(const Search& search, const ListedCamera& listed,
                       const std::vector<std::string>& names) {
  CameraSource source{.name = listed.name,
                      .model = listed.model.value_or(CameraModel{}),
                      .frame = listed.frame,
                      .T_lidar_camera = listed.T_lidar_camera,
                      .T_imu_camera = listed.T_imu_camera,
                      .time_offset = listed.time_offset,
                      .images = nullptr};
  if (!listed.folder.empty()) {
    source.images = open_image_folder(listed.folder);
    return source;
  }
  const CameraTopic& topic = listed.topic.empty() ? require_only_topic(search, names)
                                                  : require_topic(search, listed.topic);
  if (!listed.model) {
    source.model = require_model_beside(search, topic.name);
  }
  if (source.frame.empty()) {
    source.frame = topic.frame;
  }
  source.name = topic.name;
  return source;
}

/// The cameras of a file, those on topics with the topic as their name.
struct FiledCameras {
  std::vector<CameraSource> sources;
  std::vector<std::string> names;
};
FiledCameras filed_cameras(const Search& search, const CameraChoice& choice) {
  FiledCameras cameras;
  const std::vector<ListedCamera> all = read_camera_file(choice.calibration);
  for (const std::string& name : choice.topics) {
    const auto is_it = [&](const ListedCamera& listed) {
      return listed.topic.empty() ? listed.folder.empty() : is_chosen(listed.topic, {name});
    };
    if (std::ranges::none_of(all, is_it)) {
      throw InputError(choice.calibration, {}, "it lists no camera with images on " + name,
                       "Name topics as the file does, or none");
    }
  }
  for (const ListedCamera& listed : all) {
    if (listed.topic.empty() ? listed.folder.empty() || choice.topics.empty()
                             : is_chosen(listed.topic, choice.topics)) {
      cameras.sources.push_back(source_of(search, listed, choice.topics));
      cameras.names.push_back(listed.name);
    }
  }
  return cameras;
}

/// Throws InputError where the first image that can be read is none of this camera.
void require_fitting_size(const CameraSource& camera, const fs::path& file) {
  ColorImage image;
  try {
    image = camera.images->image(0);
  } catch (const InputError&) {
    return;  // damaged, as others may be: reported where they are used
  }
  if (image.width != camera.model.width || image.height != camera.model.height) {
    throw InputError(file, {},
                     "the images of the camera " + camera.name + " have " +
                         std::to_string(image.width) + " x " + std::to_string(image.height) +
                         " pixels, its calibration has " + std::to_string(camera.model.width) +
                         " x " + std::to_string(camera.model.height),
                     "Use the images that were calibrated, or calibrate these");
  }
}

/// The images of those that have none yet, which have their topic as a name.
void add_message_images(const Search& search, std::vector<CameraSource>& cameras) {
  std::vector<std::string> topics;
  for (const CameraSource& camera : cameras) {
    if (!camera.images && std::ranges::count(topics, camera.name) == 0) {
      topics.push_back(camera.name);
    }
  }
  const auto images = read_message_images(search.files, topics);
  for (CameraSource& camera : cameras) {
    const auto topic = std::ranges::find(topics, camera.name);
    if (!camera.images) {
      camera.images = images[static_cast<std::size_t>(topic - topics.begin())];
    }
  }
}

}  // namespace

std::vector<CameraSource> find_cameras(const std::vector<fs::path>& recording,
                                       const CameraChoice& choice) {
  Search search{.paths = recording, .files = {}, .topics = {}};
  search.files = std::make_shared<const std::vector<std::unique_ptr<MessageFile>>>(
      open_message_files(recording));
  search.topics = list_camera_topics(*search.files);
  FiledCameras cameras;
  if (!choice.calibration.empty()) {
    cameras = filed_cameras(search, choice);
  } else if (!choice.topics.empty()) {
    cameras.sources = named_cameras(search, choice.topics);
  } else {
    cameras.sources = calibrated_cameras(search);
  }
  add_message_images(search, cameras.sources);
  for (std::size_t i = 0; i < cameras.sources.size(); ++i) {
    if (i < cameras.names.size()) {
      cameras.sources[i].name = cameras.names[i];
    }
    require_fitting_size(cameras.sources[i], recording.front());
  }
  return std::move(cameras.sources);
}

}  // namespace adit
