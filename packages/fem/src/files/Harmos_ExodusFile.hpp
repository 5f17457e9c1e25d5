// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellType.hpp"

#include <map>
#include <string>
#include <vector>

namespace Harmos::fem {

/// A mesh as files of Exodus II hold it. Elements are counted through all blocks; all numbers are from 1.
struct ExodusMesh {
  /// Elements of one type; their nodes in the order of shapeOf(type), which is that of Exodus.
  struct Block {
    std::string name;
    CellType type;
    std::vector<long long> nodes;
  };
  struct SideSet {
    std::string name;
    std::vector<long long> elements, sides; ///< sides as in shapeOf(type).sides
  };
  struct NodeSet {
    std::string name;
    std::vector<long long> nodes;
  };

  int dimension = 3;
  std::vector<double> points; ///< x, y, z of each; z = 0 in the plane
  std::vector<Block> blocks;
  std::vector<SideSet> sideSets;
  std::vector<NodeSet> nodeSets;
  std::map<std::string, std::vector<double>> fields; ///< nodal variables at the last time
};

/// Whether a file's name ends with .exo, .e, .ex2, .exii or .g.
bool isExodus(const std::string& path);

/// Reads a file of Exodus II (Schoof, Yarberry: EXODUS II: a finite element data model, SAND92-2137), in
/// netCDF's classic format or in HDF5. Blocks and sets without names are "block_10", "sideset_1",
/// "nodeset_3", by their numbers. Empty ones are left out. Local.
///
/// Guarded by tests/regression/files/test_exodus_meshes.py.
///
/// @throws InputError that names file, place and remedy: if this build has no Exodus (CMake option
/// HARMOS_ENABLE_EXODUS), for files that are none or are damaged, for elements of a type that bodies do not
/// have.
ExodusMesh readExodus(const std::string& path);

} // namespace Harmos::fem
