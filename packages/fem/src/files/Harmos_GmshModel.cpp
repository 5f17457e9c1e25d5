// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GmshModel.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_GmshLibrary.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <numeric>
#include <unistd.h>

namespace Harmos::fem::Details {
namespace {

void flushOutput() {
  std::fflush(stdout);
} // C++ streams pass it on at once

} // namespace

Silence::Silence() : output_(dup(STDOUT_FILENO)) {
  flushOutput();
  const int nowhere = open("/dev/null", O_WRONLY);
  if (output_ >= 0 && nowhere >= 0)
    dup2(nowhere, STDOUT_FILENO);
  if (nowhere >= 0)
    close(nowhere);
}

Silence::~Silence() {
  flushOutput();
  if (output_ >= 0) {
    dup2(output_, STDOUT_FILENO);
    close(output_);
  }
}

namespace {

volatile std::sig_atomic_t inGmsh = 0;

// Made beforehand: a handler of signals may do next to nothing.
std::string sentence;

[[noreturn]] void endWithSentence() {
  const auto written = write(STDERR_FILENO, sentence.data(), sentence.size());
  constexpr int badInput = 2;
  _exit(written < 0 ? badInput + 1 : badInput);
}

void onSignal(int) {
  endWithSentence();
}

void onExit() {
  if (inGmsh != 0)
    endWithSentence();
}

} // namespace

EndGuard::EndGuard(const std::string& path)
    : aborted_(std::signal(SIGABRT, onSignal)), faulted_(std::signal(SIGSEGV, onSignal)) {
  sentence = isExodus(path)
                 ? "error: the library of Exodus ended the program that reads \"" + path +
                       "\": the file is damaged\n"
                 : "error: Gmsh ended the program that reads \"" + path +
                       "\": the file is damaged, contains Exit or uses an unsupported feature. Open it in "
                       "Gmsh to locate the failure\n";
  static const bool registered = std::atexit(onExit) == 0;
  inGmsh = registered ? 1 : 0;
}

EndGuard::~EndGuard() {
  inGmsh = 0;
  std::signal(SIGABRT, aborted_);
  std::signal(SIGSEGV, faulted_);
}

GmshSession::GmshSession(const std::string& path) : guard_(path) {
  gmsh::initialize();
  gmsh::setNumber("General.Terminal", 0);
  gmsh::setNumber("General.AbortOnError", 2); // throw
  gmsh::setNumber("General.NumThreads", 1);   // the same mesh at every run
}

GmshSession::~GmshSession() {
  gmsh::finalize();
}

const char* entityName(int dimension) {
  static const std::array<const char*, 4> names = {"point", "curve", "surface", "volume"};
  return names[static_cast<std::size_t>(dimension)];
}

Groups groupsOfModel() {
  Groups groups;
  gmsh::Pairs all = gmsh::model::getPhysicalGroups();
  for (const auto& [dimension, tag] : all) {
    const std::string name = gmsh::model::getPhysicalName(dimension, tag);
    const std::vector<int> entities = gmsh::model::getEntitiesForPhysicalGroup(dimension, tag);
    std::vector<int>& group =
        groups[static_cast<std::size_t>(dimension)][name.empty() ? std::to_string(tag) : name];
    group.insert(group.end(), entities.begin(), entities.end());
  }
  if (all.empty()) {
    all = gmsh::model::getEntities();
    for (const auto& [dimension, tag] : all)
      groups[static_cast<std::size_t>(dimension)][entityName(dimension) + (" " + std::to_string(tag))] = {
          tag};
  }
  for (auto& ofDimension : groups)
    for (auto& [name, entities] : ofDimension) {
      std::sort(entities.begin(), entities.end());
      entities.erase(std::unique(entities.begin(), entities.end()), entities.end());
    }
  return groups;
}

bool isSamePlace(const Point& a, const Point& b) {
  constexpr double tolerance = 1e-8; // on a reference cell of size 1
  return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]) < tolerance;
}

std::vector<std::size_t> matched(const std::vector<Point>& places, const std::vector<Point>& others) {
  std::vector<std::size_t> result;
  for (const Point& place : places)
    for (std::size_t k = 0; k < others.size(); ++k)
      if (isSamePlace(place, others[k])) {
        result.push_back(k);
        break;
      }
  return places.size() == others.size() && result.size() == places.size() ? result
                                                                          : std::vector<std::size_t>{};
}

ElementType makeElementType(int type) {
  ElementType result;
  const gmsh::mesh::ElementProperties properties = gmsh::mesh::getElementProperties(type);
  result.name = properties.name;
  result.dimension = properties.dimension;
  result.nodes = static_cast<std::size_t>(properties.nodes);
  result.corners = static_cast<std::size_t>(properties.corners);
  const auto dimension = static_cast<std::size_t>(result.dimension);
  if (result.dimension < 2)
    return result; // sides of plane cells and points: only their corners are used
  std::vector<Point> places(result.nodes);
  for (std::size_t i = 0; i < result.nodes; ++i)
    for (std::size_t d = 0; d < dimension; ++d)
      places[i][d] = properties.coordinates[i * dimension + d];
  for (CellType candidate : bodyCells) {
    const CellShape& shape = shapeOf(candidate);
    if (shape.dimension != result.dimension || shape.corners != properties.corners)
      continue;
    result.order = matched(shape.nodeCoordinates, places);
    if (!result.order.empty()) {
      result.ours = candidate;
      break;
    }
  }
  return result;
}

Elements elementsOf(int dimension, int entity) {
  auto [types, tags, nodes] = gmsh::mesh::getElements(dimension, entity);
  return {std::move(types), std::move(tags), std::move(nodes)};
}

} // namespace Harmos::fem::Details
