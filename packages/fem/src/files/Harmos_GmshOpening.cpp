// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GmshModel.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_GmshLibrary.hpp"

#include <exception>
#include <filesystem>
#include <new>

namespace Harmos::fem::Details {
namespace {

// What helps, where Gmsh's own words do not say so.
std::string remedyFor(const std::string& reason) {
  for (const char* word : {"overlapping facets", "intersect", "PLC", "self-intersect", "boundary mesh"})
    if (reason.find(word) != std::string::npos)
      return ". The surface triangles cut each other because cells are too large for the geometry; use "
             "smaller cells (--size) or more cells on curved parts (--per-circle)";
  return ". Open the file in Gmsh to locate the failure";
}

// Whether there are cells or shapes of a dimension.
bool has(int dimension) {
  return !gmsh::mesh::getElementTypes(dimension).empty() || !gmsh::model::getEntities(dimension).empty();
}

void openByGmsh(const std::string& path) {
  if (std::filesystem::path(path).extension() == ".inp")
    throw InputError(
        "\"" + path +
        "\" is an input of CalculiX or Abaqus, which is a model; convert it to a deck and a mesh: "
        "harmos-inp, with --sets for all sets");
  gmsh::open(path);
  if (isUniversal(path))
    addGroups(path, readUniversalGroups(path));
}

void prescribe(const GmshMeshing& meshing) {
  if (meshing.size > 0.0)
    gmsh::setNumber("Mesh.MeshSizeMax", meshing.size);
  if (meshing.perCircle > 0)
    gmsh::setNumber("Mesh.MeshSizeFromCurvature", meshing.perCircle);
  if (meshing.order > 0)
    gmsh::setNumber("Mesh.ElementOrder", meshing.order);
  if (meshing.sizes == nullptr)
    return;
  for (const char* source : {"Mesh.MeshSizeFromPoints", "Mesh.MeshSizeExtendFromBoundary"})
    gmsh::setNumber(source, 0.0);
  // Gmsh shakes points by 1e-9 of the body, so that no four lie on a circle: where cells are 1e-5 of it,
  // three points of a straight edge then make a triangle without area.
  constexpr double shake = 1e-12;
  gmsh::setNumber("Mesh.RandomFactor", shake);
  gmsh::mesh::setSizeCallback([sizes = meshing.sizes](double x, double y, double z) {
    return (*sizes)({x, y, z});
  });
}

} // namespace

void throwGmshError(const std::string& path, const std::string& reason) {
  throw InputError("Gmsh cannot read or mesh \"" + path +
                   "\": " + (reason.empty() ? "no reason given" : reason) + remedyFor(reason));
}

int openModel(const std::string& path, int dimension, const GmshMeshing& meshing) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure))
    throw InputError("mesh file not found: \"" + path + "\"; check its path");
  if (!std::filesystem::is_regular_file(path, failure))
    throw InputError("\"" + path + "\" is not a file; give the path of a mesh file");
  std::vector<int> types;
  try {
    if (isVtk(path))
      loadGrid(path, readVtk(path));
    else if (isExodus(path))
      loadExodus(path, readExodus(path));
    else
      openByGmsh(path);
    if (dimension == 0)
      dimension = has(3) ? 3 : 2;
    types = gmsh::mesh::getElementTypes(dimension);
    if (!types.empty() && meshing.isGiven())
      throw InputError(
          "\"" + path +
          "\" is already meshed, so size and order have no effect; set them in the mesh generator");
    if (types.empty()) {
      prescribe(meshing);
      if (!gmsh::model::getEntities(dimension).empty())
        gmsh::mesh::generate(dimension);
      types = gmsh::mesh::getElementTypes(dimension);
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throwGmshError(path, error.what());
  }
  if (types.empty())
    throw InputError("\"" + path + "\" holds no cells of dimension " + std::to_string(dimension) +
                     " and no geometry to mesh: it " +
                     (dimension == 3 && has(2)
                          ? "is a plane mesh of dimension 2 or the surface of a solid without volume mesh"
                          : "is not a mesh or has another dimension"));
  return dimension;
}

} // namespace Harmos::fem::Details
