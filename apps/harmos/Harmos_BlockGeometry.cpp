// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BlockGeometry.hpp"

#include "Harmos_AtomicFile.hpp"

#include <filesystem>
#include <iomanip>
#include <map>
#include <sstream>
#include <unistd.h>

namespace Harmos::app {
namespace {

// Writes entities; their numbers rise over the blocks.
class GeoText {
 public:
  GeoText(int dimension, int order) : dimension_(dimension) {
    text_ << std::setprecision(17) << "Mesh.ElementOrder = " << order << ";\n";
  }

  void add(const SimplexBlock& block) {
    if (dimension_ == 2)
      addRectangle(block);
    else
      addBrick(block);
  }

  std::string finished() {
    const auto group = [&](const std::string& kind, const auto& groups) {
      for (const auto& [name, tags] : groups) {
        text_ << "Physical " << kind << "(\"" << name << "\") = {";
        for (std::size_t k = 0; k < tags.size(); ++k)
          text_ << (k == 0 ? "" : ", ") << tags[k];
        text_ << "};\n";
      }
    };
    group(dimension_ == 2 ? "Surface" : "Volume", bodies_);
    group(dimension_ == 2 ? "Curve" : "Surface", parts_);
    return text_.str();
  }

 private:
  // The corner that is at the end along each axis of which a bit is set.
  int addPoint(const SimplexBlock& block, unsigned bits) {
    text_ << "Point(" << ++points_ << ") = {";
    for (std::size_t d = 0; d < 3; ++d)
      text_ << (dimension_ == 2 && d == 2 ? 0.0 : block.origin[d] + ((bits >> d) & 1U) * block.size[d])
            << ", ";
    text_ << block.length << "};\n";
    return points_;
  }

  int addLine(int from, int to) {
    text_ << "Line(" << ++lines_ << ") = {" << from << ", " << to << "};\n";
    return lines_;
  }

  int addSurface(const std::array<int, 4>& lines) {
    ++surfaces_;
    text_ << "Curve Loop(" << surfaces_ << ") = {" << lines[0] << ", " << lines[1] << ", " << lines[2] << ", "
          << lines[3] << "}; Plane Surface(" << surfaces_ << ") = {" << surfaces_ << "};\n";
    return surfaces_;
  }

  void addRectangle(const SimplexBlock& block) {
    std::array<int, 4> corners{};
    std::array<int, 4> lines{};
    constexpr std::array<unsigned, 4> around = {0, 1, 3, 2};
    for (std::size_t k = 0; k < 4; ++k)
      corners[k] = addPoint(block, around[k]);
    constexpr std::array<const char*, 4> names = {"bottom", "right", "top", "left"};
    for (std::size_t k = 0; k < 4; ++k) {
      lines[k] = addLine(corners[k], corners[(k + 1) % 4]);
      parts_[names[k]].push_back(lines[k]);
    }
    bodies_[block.name].push_back(addSurface(lines));
  }

  void addBrick(const SimplexBlock& block) {
    std::array<int, 8> corners{};
    for (unsigned bits = 0; bits < 8; ++bits)
      corners[bits] = addPoint(block, bits);
    std::map<std::pair<unsigned, unsigned>, int> edges; // from the lower corner
    for (unsigned bits = 0; bits < 8; ++bits)
      for (unsigned axis = 0; axis < 3; ++axis)
        if (const unsigned end = bits | (1U << axis); end != bits)
          edges[{bits, end}] = addLine(corners[bits], corners[end]);
    const auto along = [&](unsigned from, unsigned to) {
      return from < to ? edges.at({from, to}) : -edges.at({to, from});
    };
    constexpr std::array<const char*, 6> names = {"left", "right", "front", "back", "bottom", "top"};
    std::array<int, 6> faces{};
    for (unsigned axis = 0; axis < 3; ++axis)
      for (unsigned side = 0; side < 2; ++side) {
        const unsigned a = 1U << (axis + 1) % 3, b = 1U << (axis + 2) % 3, at = side << axis;
        const std::size_t k = 2 * axis + side;
        faces[k] = addSurface(
            {along(at, at | a), along(at | a, at | a | b), along(at | a | b, at | b), along(at | b, at)});
        parts_[names[k]].push_back(faces[k]);
      }
    ++volumes_;
    text_ << "Surface Loop(" << volumes_ << ") = {" << faces[0];
    for (std::size_t k = 1; k < 6; ++k)
      text_ << ", " << faces[k];
    text_ << "}; Volume(" << volumes_ << ") = {" << volumes_ << "};\n";
    bodies_[block.name].push_back(volumes_);
  }

  int dimension_;
  std::ostringstream text_;
  int points_ = 0, lines_ = 0, surfaces_ = 0, volumes_ = 0;
  std::map<std::string, std::vector<int>> bodies_, parts_;
};

} // namespace

BlockGeometry::BlockGeometry(const std::vector<SimplexBlock>& blocks, int dimension, int order) {
  GeoText text(dimension, order);
  for (const SimplexBlock& block : blocks)
    text.add(block);
  static int count = 0;
  file_ = (std::filesystem::temp_directory_path() /
           ("harmos_blocks_" + std::to_string(::getpid()) + "_" + std::to_string(++count) + ".geo"))
              .string();
  io::writeAtomically(file_, text.finished());
}

BlockGeometry::~BlockGeometry() {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

} // namespace Harmos::app
