// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <Teuchos_Comm.hpp>

#include <memory>
#include <string>
#include <vector>

namespace Harmos::fem {

/// A body that is torn into subdomains, as tear() makes them with nodes numbered from 0.
struct CutBody {
  std::string name;
  CellType cellType{};
  long long nodes = 0;              ///< of the body
  std::vector<std::string> regions; ///< their names
  std::vector<PlacedMesh> subdomains;
};

/// Writes bodies that are cut: an HDF5 file whose rows are ordered by subdomain, so that a rank reads those
/// of its own subdomains and no others.
///
/// Its layout, of each body k:
///
///     /bodies                 names, a line each          /body_k/type      name of the cells
///     /body_k/regions         names, a line each          /body_k/nodes     of the whole body
///     /body_k/begin           of each subdomain, and of the end: first rows of coordinates, cells, boundary
///     /body_k/check           of each subdomain: FNV-1a of all that it has
///     /body_k/anchor, coordinates, cells, cell_regions, boundary, boundary_numbers      as in PlacedMesh
///     /body_k/parts           names of boundary parts, a line each; of each part p, with rows begin in
///     part_begin: /body_k/part_p/begin, nodes, sides                  nodes of a subdomain; cell and side
///
/// @param comm of one process. @throws InputError if the file cannot be written.
/// Guarded by tests/unit/fem/test_cut_mesh_file.cpp.
void writeCutMesh(const Teuchos::Comm<int>& comm, const std::string& path,
                  const std::vector<CutBody>& bodies);

/// A file of writeCutMesh(), open. Local: every rank opens it for itself, and asks for its own subdomains.
class CutMeshFile {
 public:
  /// What is known of a body without its subdomains.
  struct Body {
    std::string name;
    CellType cellType{};
    long long nodes = 0;
    int subdomains = 0;
    std::vector<std::string> regions;
  };

  /// @throws InputError if it is not there, or is no such file.
  explicit CutMeshFile(const std::string& path);
  ~CutMeshFile();

  /// Whether the name of a file says that it is such a one: it ends with ".h5".
  static bool isOne(const std::string& path);

  const std::vector<Body>& bodies() const { return bodies_; }

  /// @param firstNode is added to numbers of nodes.
  /// @throws InputError if what is read is not what was written.
  PlacedMesh subdomain(std::size_t body, int number, long long firstNode) const;

 private:
  struct File;
  std::string path_;
  std::unique_ptr<File> file_;
  std::vector<Body> bodies_;
};

} // namespace Harmos::fem
