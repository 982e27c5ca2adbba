// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/bag_set.h"

#include <algorithm>

namespace rgbd_sfm_fusion {

BagSet::BagSet(const std::vector<std::string>& paths) : name_(paths.at(0)) {
  if (paths.size() > 1) name_ += " and " + std::to_string(paths.size() - 1) + " more";
  for (const std::string& path : paths) {
    const BagFile& bag = *bags_.emplace_back(std::make_unique<BagFile>(path));
    for (std::size_t i = 0; i < bag.connections().size(); ++i) {
      connections_.push_back(bag.connections()[i]);
      sources_.push_back({bags_.size() - 1, i});
    }
  }
}

std::vector<BagSet::Place> BagSet::places(const std::vector<std::size_t>& connections) const {
  std::vector<Place> places;
  for (const std::size_t connection : connections) {
    const Source& source = sources_.at(connection);
    for (const BagFile::Entry& entry : bags_[source.bag]->entries(source.connection))
      places.push_back({connection, entry});
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.entry.time < b.entry.time; });
  return places;
}

std::vector<std::uint8_t> BagSet::read(const Place& place) {
  const Source& source = sources_.at(place.connection);
  return bags_[source.bag]->read(source.connection, place.entry);
}

}  // namespace rgbd_sfm_fusion
