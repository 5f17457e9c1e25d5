// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellType.hpp"
#include "Harmos_ExodusFile.hpp"
#include "Harmos_GmshFile.hpp"
#include "Harmos_UniversalGroups.hpp"
#include "Harmos_VtkFile.hpp"

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// What Gmsh's interface tells of the model it has open, in our terms, and models for it of files that it
/// does not read (Harmos_GmshForeign.cpp). Internal to Harmos_GmshFile.cpp; only compiled with Gmsh.
namespace Harmos::fem::Details {

using Tag = std::size_t; ///< of a node or an element

/// Nothing reaches standard output while this lives: OpenCASCADE, which reads .step files for Gmsh, prints to
/// it whatever Gmsh's options say.
class Silence {
 public:
  Silence();
  ~Silence();
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  int output_;
};

/// Gmsh ends the program that it is in where a file says so (Exit) or an expression of it cannot be parsed,
/// by exit() or abort(): while this lives, that ends with a sentence and exit status 2.
class EndGuard {
 public:
  /// @param path of the file, for the sentence.
  explicit EndGuard(const std::string& path);
  ~EndGuard();
  EndGuard(const EndGuard&) = delete;
  EndGuard& operator=(const EndGuard&) = delete;

 private:
  using Handler = void (*)(int);
  Handler aborted_, faulted_;
};

/// Gmsh has one global state; this is its life time.
class GmshSession {
 public:
  /// @param path of the file that will be read.
  explicit GmshSession(const std::string& path);
  ~GmshSession();
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;

 private:
  EndGuard guard_;
  Silence silence_;
};

/// Has Gmsh open a file, or gives it the cells of one that it does not read; geometries are meshed.
/// @param dimension 0: 3 if the file has anything of it, else 2. @return the dimension.
/// @throws InputError as readGmsh() has it.
int openModel(const std::string& path, int dimension, const GmshMeshing& meshing);

/// With what helps, where Gmsh's own words do not say so.
[[noreturn]] void throwGmshError(const std::string& path, const std::string& reason);

/// Gives Gmsh the cells of a grid in the place of a file that it opens: an entity for each region and
/// dimension. Regions are what integers of the cells say, "gmsh:physical" and the like first, or the only
/// ones there are; their groups are called by these numbers. Without any, all cells of a dimension are one
/// entity without group.
/// @throws InputError for cells of a type that Gmsh does not know; for several integers none of which is
/// known.
void loadGrid(const std::string& path, const VtkGrid& grid);

/// Likewise of a mesh of Exodus: an entity and a group for each block, each side set and each node set, and a
/// view of each field.
/// @throws InputError for sides that an element does not have.
void loadExodus(const std::string& path, const ExodusMesh& mesh);

/// Adds groups of a universal file to the model that Gmsh has read from it, which knows the properties of
/// elements only: an entity for each group and dimension. Where groups have elements of a dimension, its
/// groups by property go.
/// @throws InputError for numbers that no node or element of the file has.
void addGroups(const std::string& path, const std::vector<UniversalGroup>& groups);

/// "point", "curve", "surface", "volume".
const char* entityName(int dimension);

/// The geometric entities of each group, by dimension and name.
using Groups = std::array<std::map<std::string, std::vector<int>>, 4>;

/// Physical groups; all entities, each by itself, if there are none.
Groups groupsOfModel();

/// An element type of Gmsh, and ours if there is one.
struct ElementType {
  std::string name;
  int dimension = 0;
  std::size_t nodes = 0;
  std::size_t corners = 0;
  std::optional<CellType> ours;
  std::vector<std::size_t> order; // our node i is Gmsh's order[i]
};

ElementType makeElementType(int type);

/// The elements of an entity, type by type.
struct Elements {
  std::vector<int> types;
  std::vector<std::vector<Tag>> tags;
  std::vector<std::vector<Tag>> nodes;
};

Elements elementsOf(int dimension, int entity);

bool isSamePlace(const Point& a, const Point& b);

/// For each of the places, which one of the others it is; empty if they are not the same places.
std::vector<std::size_t> matched(const std::vector<Point>& places, const std::vector<Point>& others);

} // namespace Harmos::fem::Details
