// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

namespace Harmos::app {

/// A rectangle or a brick, to be meshed by simplices.
struct SimplexBlock {
  std::string name; ///< of the body
  std::array<double, 3> origin, size;
  double length; ///< of the cells' edges
};

/// A geometry of blocks for Gmsh, in a file that is there as long as this: a physical volume, in the plane a
/// surface, of each name; boundary parts have the names of fem::StructuredBlock. On one rank.
/// Guarded by tests/verification/accuracy/test_adaptivity.py.
class BlockGeometry {
 public:
  /// @param order of the elements. @throws InputError where it cannot be written.
  BlockGeometry(const std::vector<SimplexBlock>& blocks, int dimension, int order);
  ~BlockGeometry();
  BlockGeometry(const BlockGeometry&) = delete;
  BlockGeometry& operator=(const BlockGeometry&) = delete;

  const std::string& file() const { return file_; }

 private:
  std::string file_;
};

} // namespace Harmos::app
