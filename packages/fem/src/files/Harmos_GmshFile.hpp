// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BodyMesh.hpp"
#include "Harmos_SizeField.hpp"

#include <memory>
#include <string>
#include <vector>

namespace Harmos::fem {

/// What a body is made of in a mesh file.
struct GmshBody {
  std::string name;
  /// Physical groups of the highest dimension that make it up; each is a region of the body.
  std::vector<std::string> groups;
};

/// How a geometry is meshed; zeros: as Gmsh, or the file, has it.
struct GmshMeshing {
  double size = 0.0; ///< the longest edge, about
  int perCircle = 0; ///< edges around a full circle where the geometry is curved
  int order = 0;     ///< 1 or 2
  /// In the place of what the geometry says of sizes, but for those by curvature; null: none.
  std::shared_ptr<const SizeField> sizes = nullptr;
  bool isGiven() const { return size > 0.0 || perCircle > 0 || order > 0 || sizes != nullptr; }
};

/// Whether this build can read Gmsh's files (CMake option HARMOS_ENABLE_GMSH).
bool canReadGmsh();

/// Reads bodies from a file that Gmsh can open: .msh, .mesh, .bdf, .unv; .geo, .step and other geometries are
/// meshed first; VTK's .vtk and .vtu, see readVtk(); and files of Exodus, see readExodus().
///
/// Bodies share no nodes: a node that two bodies use in the file becomes one of each. Within a body, regions
/// share theirs. Nodes and cells are numbered anew, nodes in the order of the file's tags, cells group by
/// group. Of the physical groups below the highest dimension, those of sides (curves in the plane, surfaces
/// in space) become named boundary parts of every body that has such sides on its boundary, so that one
/// between two bodies belongs to both; of sides inside a body the
/// nodes are named, for prescribed displacements. Those of lower dimension become
/// named nodes. A group without a name is called by its number.
///
/// A file without any physical group (as .step files are) has its geometric entities for groups, called
/// "volume 1", "surface 4", "curve 2", "point 3". Sizes that differ from place to place, and groups, are
/// given by a .geo file that merges the .step file.
///
/// Cells that are numbered in a mirrored way, with negative Jacobians at their corners, are renumbered, each
/// by itself: Gmsh's own surfaces and extruded volumes may be such, and other writers do not care. That cells
/// lie on the same side of one that they share tells a folded mesh, which is refused.
///
/// Groups without cells are left out where no bodies are named.
///
/// Cells that a file holds more than once (format 2, an entity in several groups) count once.
///
/// Node orders are matched by the places of the nodes on the reference cells of both sides. Serial: to be
/// called on one rank, while no other thread writes to standard output: it is shut meanwhile, because
/// OpenCASCADE, which reads .step files for Gmsh, prints to it. Gmsh's messages go into the errors.
///
/// Gmsh itself ends the process on some files (`Exit` in a .geo, expressions that it cannot parse): then this
/// does not return, and the process ends with a sentence and status 2. Who cannot have that reads in a
/// process of its own, as harmos-mesh does.
///
/// Guarded by tests/unit/fem/test_gmsh_file.cpp.
///
/// @param bodies none: each group of the highest dimension is one. @param dimension of the bodies, 2 or 3; 0:
/// 3 if the file has anything of it, else 2. Plane meshes lie in a plane z = constant.
/// @return the bodies in the order that was wanted; of one with cells of several types its blocks, one after
/// the other, with the name of the body each.
/// @throws InputError if this build has no Gmsh; for sizes where the file has cells already; for a file that
/// is missing, broken or empty; for groups it does not have; for a body with cells of a type that Harmos does
/// not have, or of several that do not meet side by side, see joinBlocks(); for cells that belong to two
/// regions; for folded meshes and simplices of no size, naming the cell; for plane meshes that are not in a
/// plane.
std::vector<BodyMesh> readGmsh(const std::string& path, const std::vector<GmshBody>& bodies, int dimension,
                               const GmshMeshing& meshing = {});

} // namespace Harmos::fem
