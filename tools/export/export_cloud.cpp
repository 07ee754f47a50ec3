// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/export_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/core/units.hpp"
#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/clouds/returns.hpp"
#include "adit/tools/coloring/map_coloring.hpp"
#include "adit/tools/export/cloud_classes.hpp"
#include "adit/tools/export/dense_recording.hpp"
#include "adit/tools/map_products/carrier_space.hpp"
#include "adit/tools/map_products/cloud_product.hpp"
#include "adit/tools/map_products/dense_cloud.hpp"
#include "adit/tools/map_products/mixed_pixels.hpp"
#include "adit/tools/map_products/tile_folder.hpp"
#include "adit/tools/map_products/tiled_cloud.hpp"
#include "adit/tools/map_products/trajectory_products.hpp"
#include "adit/tools/setup/device_session.hpp"
#include "adit/tools/support/progress.hpp"

namespace adit {
namespace {

bool has_unix_times(const MapDatabase& map) {
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  return !keyframes.empty() && std::ranges::all_of(keyframes, [](const MapKeyframe& keyframe) {
    return is_unix_time(keyframe.stamp);
  });
}

/// What LAS files say of times, which have to be in GPS time.
std::string times_of(CloudFormat format, const CloudHeading& heading) {
  return !is_las(format)      ? ""
         : heading.unix_times ? ", in adjusted standard GPS time"
                              : ", in the recording's own time";
}

/// What colours the points of a dense cloud, with the device that it works on.
struct Painter {
  Painter(const ExportJob& job, const DenseRecording& recording)
      : cameras(recording.cameras()),
        device(with_notes(job)),
        coloring(*job.map, device.context(), cameras, recording.path(), job.moved,
                 job.memory->submap_bytes()) {}

  static DeviceOptions with_notes(const ExportJob& job) {
    DeviceOptions wanted = job.options->device;
    wanted.notes = job.err;
    return wanted;
  }

  std::vector<CameraSource> cameras;
  DeviceSession device;
  MapColoring coloring;
};

/// "camera /front/image_raw: turned by 0.97 degrees, images 2 ms late: corrected".
std::string text_of(const CameraFinding& finding) {
  if (!finding.determined) {
    return fmt::format("camera {}: its views share too few surfaces to check its mounting\n",
                       finding.camera);
  }
  return fmt::format(
      "camera {}: turned by {:.2f} degrees, images {:.0f} ms {}: {}\n", finding.camera,
      finding.turned() / kDegree, 1e3 * std::abs(finding.late()),
      finding.late() < 0.0 ? "early" : "late",
      finding.corrected ? "corrected" : "its images do not agree better then; left as it is");
}

/// Looks into the cameras' errors and the brightness of their images.
void prepare(Painter& painter, const ExportJob& job) {
  std::optional<Progress> progress;
  const auto update = [&](std::size_t done, std::size_t total) {
    if (!progress) {
      progress.emplace(*job.err, progress_style_of_stderr(), "images", total,
                       Progress::Clock::now(), "views");
    }
    progress->update(done, 0);
    require_within(job);
  };
  const bool corrects = !job.options->as_calibrated;
  for (const CameraFinding& finding : painter.coloring.prepare(corrects, update)) {
    *job.out << text_of(finding);
  }
  if (progress) {
    progress->finish();
  }
}

/// "; 93 % of the points have a colour, by 214 of 600 images of 1 camera".
std::string text_of(const ColoringCounts& counts, std::size_t cameras) {
  std::string text = fmt::format("; {:.0f} % of the points have a colour, by {} of {} images of {}",
                                 100.0 * static_cast<double>(counts.colored) /
                                     static_cast<double>(std::max<uint64_t>(1, counts.points)),
                                 counts.views, counts.images,
                                 cameras == 1 ? "1 camera" : fmt::format("{} cameras", cameras));
  if (counts.damaged > 0) {
    text += fmt::format("; {} images are damaged", counts.damaged);
  }
  if (counts.other_size > 0) {
    text += fmt::format("; {} images have another size than their calibration", counts.other_size);
  }
  return text;
}

/// The returns of a sweep in the sensor's frame, m.
std::vector<Eigen::Vector3d> returns_of(const Sweep& sweep) {
  std::vector<Eigen::Vector3d> returns;
  for (const Point& point : sweep.points) {
    if (is_return(point)) {
      returns.emplace_back(point.x, point.y, point.z);
    }
  }
  return returns;
}

/// Looks through all sweeps for parts of what carries the sensor.
CarrierSpace find_carrier(const ExportJob& job, const DenseRecording& recording,
                          const CloudSelection& selection) {
  Progress progress(*job.err, progress_style_of_stderr(), "carrier", recording.sweeps());
  CarrierSearch search;
  std::size_t done = 0;
  recording.visit([&](const Sweep& sweep, const SensorPath::Stretch& path, const MapSweep& in_map) {
    search.add_keyframe(in_map.keyframe);
    const std::vector<Eigen::Vector3d> returns = returns_of(sweep);
    const std::vector<CloudPoint> placed = placed_points(sweep, path);
    for (std::size_t i = 0; i < returns.size(); ++i) {
      search.add(returns[i], has_moved(selection, placed[i].position), in_map.keyframe);
    }
    progress.update(++done, 0);
    require_within(job);
  });
  progress.finish();
  return search.found();
}

/// What a single sweep shows of its returns, in their order.
struct SweepClasses {
  std::vector<Eigen::Vector3d> returns{};  ///< sensor frame, m
  std::vector<bool> mixed{};

  SweepClasses() = default;
  explicit SweepClasses(const Sweep& sweep)
      : returns(returns_of(sweep)), mixed(mixed_pixels(sweep)) {}
};

/// The carrier is nothing else; a mixed pixel is one where nothing else is known of it.
void classify(const SweepClasses& sweep, const CarrierSpace& carrier, std::size_t i,
              CloudPoint& point) {
  if (i >= sweep.returns.size()) {
    return;
  }
  if (carrier.contains(sweep.returns[i])) {
    point.classification = LasClass::carrier;
    point.moving = false;
  } else if (sweep.mixed[i] && class_of(point) == LasClass::unclassified) {
    point.classification = LasClass::mixed;
  }
}

}  // namespace

std::string export_cloud(const ExportJob& job) {
  const ExportCommandOptions& options = *job.options;
  const CloudFormat format = cloud_format(options.cloud);
  const ProductCoordinates coordinates = coordinates_of(job, is_las(format));
  const CloudClasses classes = find_classes(job, coordinates);
  ClassFilter filter(classes);
  const CloudSelection selection = with_classes(selection_of(job, coordinates), classes);
  CloudHeading heading = heading_of(coordinates);
  heading.classified = classes.any();
  heading.unix_times = has_unix_times(*job.map);
  const std::unique_ptr<CloudProduct> product = make_cloud_product(job.file, format, heading);
  // Of a thinned cloud nobody knows how many pieces it comes in.
  std::optional<Progress> progress;
  if (!options.resolution) {
    progress.emplace(*job.err, progress_style_of_stderr(), "export", job.map->keyframes().size(),
                     Progress::Clock::now(), "keyframes");
  }
  std::size_t pieces = 0;
  const TakeCloud take = [&](std::span<const CloudPoint> points) {
    product->write(filter.pass(points));
    require_within(job);
    if (progress) {
      progress->update(++pieces, 0);
    }
  };
  if (options.resolution) {
    visit_thinned_cloud(*job.map, coordinates, selection, *options.resolution,
                        job.memory->submap_bytes(), take);
  } else {
    visit_cloud(*job.map, coordinates, selection, take);
  }
  if (progress) {
    progress->finish();
  }
  product->close();
  return fmt::format("{} points{}{}{}", product->count(), in_coordinates(coordinates),
                     times_of(format, heading), filter.text());
}

std::string visit_dense(const ExportJob& job, const ProductCoordinates& coordinates,
                        const CloudSelection& selection, const TakeCloud& take) {
  const DenseRecording recording(job);
  std::optional<Painter> painter;
  if (job.options->color) {
    painter.emplace(job, recording);
    prepare(*painter, job);
  }
  const CarrierSpace carrier =
      selection.looks_at_sweeps ? find_carrier(job, recording, selection) : CarrierSpace{};
  Progress progress(*job.err, progress_style_of_stderr(), "export", recording.sweeps());
  std::size_t placed = 0;
  std::string text = recording.visit([&](const Sweep& sweep, const SensorPath::Stretch& path,
                                         const MapSweep& in_map) {
    std::vector<CloudPoint> points;
    std::vector<Eigen::Vector3d> places;
    const SweepClasses in_sweep = selection.looks_at_sweeps ? SweepClasses(sweep) : SweepClasses();
    std::size_t number = 0;
    for (CloudPoint& point : placed_points(sweep, path)) {
      const std::size_t i = number++;
      const Eigen::Vector3d p_map = point.position;
      if (selection.is_gone && selection.is_gone(p_map, in_map.session)) {
        continue;
      }
      point.moving = has_moved(selection, p_map);
      point.position = coordinates.from_map(p_map);
      classify(selection, p_map, point);
      classify(in_sweep, carrier, i, point);
      point.keyframe = in_map.keyframe;
      point.session = in_map.session;
      if (is_wanted(selection, point)) {
        points.push_back(point);
        places.push_back(p_map);
      }
    }
    if (painter) {
      painter->coloring.color(points, places, path.at(0.0).translation());
    }
    take(points);
    progress.update(++placed, 0);
    require_within(job);
  });
  progress.finish();
  if (painter) {
    painter->device.require_no_complaints();
    text += text_of(painter->coloring.counts(), painter->cameras.size());
  }
  return text;
}

std::string export_dense(const ExportJob& job) {
  const CloudFormat format = cloud_format(job.options->dense);
  const ProductCoordinates coordinates = coordinates_of(job, is_las(format));
  CloudHeading heading = heading_of(coordinates);
  CloudClasses classes = find_classes(job, coordinates);
  classes.looks_at_sweeps = !job.options->clean.empty();
  ClassFilter filter(classes);
  heading.measured = true;
  heading.colored = job.options->color;
  heading.classified = classes.any();
  heading.unix_times = has_unix_times(*job.map);
  std::unique_ptr<CloudProduct> product;  // of another recording nothing is written
  const std::string sweeps =
      visit_dense(job, coordinates, with_classes(selection_of(job, coordinates), classes),
                  [&](std::span<const CloudPoint> points) {
                    if (!product) {
                      product = make_cloud_product(job.file, format, heading);
                    }
                    product->write(filter.pass(points));
                  });
  product->close();
  return fmt::format("{} points of {}{}{}{}", product->count(), sweeps, in_coordinates(coordinates),
                     times_of(format, heading), filter.text());
}

std::string export_tiles(const ExportJob& job) {
  const ExportCommandOptions& options = *job.options;
  const CloudFormat format = options.cloud.empty() ? CloudFormat::pcd : cloud_format(options.cloud);
  ProductCoordinates coordinates = coordinates_of(job, true);
  CloudHeading heading = heading_of(coordinates);
  heading.unix_times = has_unix_times(*job.map);
  if (!is_las(format)) {  // Autoware's LocalCartesianUTM
    heading.offset = coordinates.origin();
    coordinates = coordinates.counted_from(heading.offset);
  }
  const CloudClasses classes = find_classes(job, coordinates);
  ClassFilter filter(classes);
  heading.classified = classes.any();
  if (job.file != *options.output) {
    TileFolder::remove(job.file);  // a draft that an interrupted export has left
  }
  TileFolder folder(job.file, format, heading, *options.tiles);
  visit_tiles(*job.map, coordinates,
              {.size = *options.tiles,
               .resolution = options.resolution,
               .selection = with_classes(selection_of(job, coordinates), classes)},
              job.memory->submap_bytes(),
              [&](const TileNumber& tile, std::span<const CloudPoint> points) {
                if (const auto kept = filter.pass(points); !kept.empty()) {
                  folder.write(tile, kept);
                }
                require_within(job);
              });
  folder.close(coordinates, job.georeference);
  return fmt::format(
      "{} points in {} tiles{}{}{}", folder.points(), folder.tiles(), in_coordinates(coordinates),
      is_las(format) || heading.coordinates.empty() ? "" : " less those of the origin",
      filter.text());
}

}  // namespace adit
