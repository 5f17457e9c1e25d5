// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

namespace Harmos::fem {

/// An unstructured grid as VTK's files hold it.
struct VtkGrid {
  std::vector<double> points;                         ///< x, y, z of each
  std::vector<int> types;                             ///< VTK's number of each cell's type
  std::vector<long long> offsets;                     ///< where each cell's nodes end in `nodes`
  std::vector<long long> nodes;                       ///< of all cells, from 0
  std::map<std::string, std::vector<long long>> data; ///< of cells, by name: those of one integer a cell
};

/// Whether a file's name ends with .vtk or .vtu.
bool isVtk(const std::string& path);

/// Reads legacy files (.vtk, versions up to 5.1, text or binary) and XML files (.vtu: text, base64 or
/// appended, compressed by zlib or not), with one unstructured grid.
///
/// After the VTK User's Guide, "VTK File Formats", and https://docs.vtk.org (version 5.1). Own code because
/// Gmsh 4.8 reads neither version 5.1, which ParaView and meshio write, nor data of cells. Local.
///
/// Guarded by tests/regression/files/test_foreign_meshes.py.
///
/// @throws InputError that names file, place and remedy: for another kind of grid, several pieces, another
/// compressor, a file that ends early, nodes that are not there.
VtkGrid readVtk(const std::string& path);

namespace Details {

/// The XML kind. @param text the whole file.
VtkGrid readVtu(const std::string& path, const std::string& text);

/// Numbers as a file holds them. @param type "Int32", "float", … of either kind of file. @param count of
/// numbers. @param isSwapped of the other byte order. @throws InputError if there are fewer or the type is
/// none.
std::vector<double> realsOf(const std::string& path, const char* bytes, std::size_t size,
                            const std::string& type, std::size_t count, bool isSwapped);
std::vector<long long> integersOf(const std::string& path, const char* bytes, std::size_t size,
                                  const std::string& type, std::size_t count, bool isSwapped);
std::size_t bytesOf(const std::string& path, const std::string& type);
bool isIntegral(const std::string& type);

} // namespace Details
} // namespace Harmos::fem
