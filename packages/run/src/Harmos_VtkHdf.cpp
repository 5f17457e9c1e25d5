// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_VtkHdf.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_Hdf5.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace Harmos::run {
namespace {

template<class T>
std::vector<T> joined(const std::vector<std::vector<T>>& parts) {
  std::vector<T> result;
  for (const std::vector<T>& part : parts)
    result.insert(result.end(), part.begin(), part.end());
  return result;
}

struct VtkCell {
  unsigned char type;
  std::vector<int> nodes; ///< our node at each place of VTK's order
};

// VTK's cells agree with ours but for the order of the nodes of a hexahedron of 27, which is found from where
// they lie (VTK file formats: VTK_TRIQUADRATIC_HEXAHEDRON).
VtkCell vtkCell(fem::CellType type) {
  const fem::CellShape& shape = fem::shapeOf(type);
  VtkCell cell{0, {}};
  for (int k = 0; k < shape.nodes; ++k)
    cell.nodes.push_back(k);
  switch (type) {
  case fem::CellType::Line2:
    cell.type = 3;
    break;
  case fem::CellType::Line3:
    cell.type = 21;
    break;
  case fem::CellType::Triangle3:
    cell.type = 5;
    break;
  case fem::CellType::Triangle6:
    cell.type = 22;
    break;
  case fem::CellType::Quadrilateral4:
    cell.type = 9;
    break;
  case fem::CellType::Quadrilateral9:
    cell.type = 28;
    break;
  case fem::CellType::Tetrahedron4:
    cell.type = 10;
    break;
  case fem::CellType::Tetrahedron10:
    cell.type = 24;
    break;
  case fem::CellType::Hexahedron8:
    cell.type = 12;
    break;
  case fem::CellType::Hexahedron27: {
    cell.type = 29;
    static const std::array<fem::Point, 27> places = {
        {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1},  {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1},
         {-1, 1, 1},   {0, -1, -1}, {1, 0, -1},  {0, 1, -1},  {-1, 0, -1}, {0, -1, 1}, {1, 0, 1},
         {0, 1, 1},    {-1, 0, 1},  {-1, -1, 0}, {1, -1, 0},  {1, 1, 0},   {-1, 1, 0}, {-1, 0, 0},
         {1, 0, 0},    {0, -1, 0},  {0, 1, 0},   {0, 0, -1},  {0, 0, 1},   {0, 0, 0}}};
    for (std::size_t k = 0; k < places.size(); ++k)
      cell.nodes[k] =
          static_cast<int>(std::find(shape.nodeCoordinates.begin(), shape.nodeCoordinates.end(), places[k]) -
                           shape.nodeCoordinates.begin());
    break;
  }
  }
  return cell;
}

// Displacements as VTK wants vectors: three components.
std::vector<double> vectors(const feti::TornVector& displacement, int components) {
  std::vector<double> result;
  for (const std::vector<double>& part : displacement)
    for (std::size_t k = 0; k < part.size(); ++k) {
      result.push_back(part[k]);
      if (components == 2 && k % 2 == 1)
        result.push_back(0.0);
    }
  return result;
}

double vonMises(const fem::Voigt& s) {
  return std::sqrt(0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)) +
                   3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

} // namespace

void writeVtkHdf(const Teuchos::Comm<int>& comm, const std::string& path,
                 const std::vector<scene::OwnedSubdomain>& owned, const ResultFields& fields) {
  // This rank's share of each array.
  std::vector<double> points;
  std::vector<long long> pointCounts, cellCounts, linkCounts, links, offsets;
  std::vector<int> subdomains, bodies, regions;
  std::vector<unsigned char> types;
  for (const scene::OwnedSubdomain& item : owned) {
    const fem::Mesh& mesh = *item.mesh.mesh;
    const VtkCell vtk = vtkCell(mesh.cellType);
    for (int node = 0; node < mesh.numberOfNodes(); ++node)
      for (double coordinate : item.mesh.position(node))
        points.push_back(coordinate);
    for (int c = 0; c < mesh.numberOfCells(); ++c) {
      offsets.push_back(static_cast<long long>(c) * mesh.nodesPerCell());
      for (int node : vtk.nodes)
        links.push_back(mesh.cell(c)[node]);
      regions.push_back(mesh.region(c));
    }
    offsets.push_back(static_cast<long long>(mesh.cells.size()));
    const auto cells = static_cast<std::size_t>(mesh.numberOfCells());
    types.insert(types.end(), cells, vtk.type);
    subdomains.insert(subdomains.end(), cells, static_cast<int>(item.number));
    bodies.insert(bodies.end(), cells, item.body);
    pointCounts.push_back(mesh.numberOfNodes());
    cellCounts.push_back(mesh.numberOfCells());
    linkCounts.push_back(static_cast<long long>(mesh.cells.size()));
  }
  // decompose() gives consecutive subdomains to consecutive ranks, so a rank's first row is a sum over those
  // below.
  struct Extent {
    long long first, total;
  };
  const auto extent = [&](std::size_t rows) {
    return Extent{exclusiveScan(comm, static_cast<long long>(rows)),
                  globalSum(comm, static_cast<long long>(rows))};
  };
  const Extent parts = extent(owned.size()), nodes = extent(points.size() / 3),
               cells = extent(subdomains.size()), connectivity = extent(links.size()),
               starts = extent(offsets.size());

  const auto bytes = [](std::size_t elements, std::size_t size) {
    return static_cast<long long>(elements * size);
  };
  const std::size_t places = points.size() / 3;
  const long long share =
      bytes(points.size() + 3 * places, 8) + (fields.stress != nullptr ? bytes(7 * places, 8) : 0) +
      (fields.contact != nullptr ? bytes(places, 17) : 0) +
      bytes(links.size() + offsets.size() + 3 * owned.size(), 8) + bytes(subdomains.size(), 3 * 4 + 1);
  io::Hdf5Writer file(comm, path, "the result file", globalSum(comm, share));
  file.group("/VTKHDF");
  file.attribute("/VTKHDF", "Version", std::vector<int>{1, 0});
  file.attribute("/VTKHDF", "Type", std::string("UnstructuredGrid"));
  const auto write = [&](const std::string& name, const auto& mine, std::size_t width, const Extent& place) {
    file.rows("/VTKHDF/" + name, mine, width, place.first, place.total);
  };
  write("NumberOfPoints", pointCounts, 1, parts);
  write("NumberOfCells", cellCounts, 1, parts);
  write("NumberOfConnectivityIds", linkCounts, 1, parts);
  write("Points", points, 3, nodes);
  write("Connectivity", links, 1, connectivity);
  write("Offsets", offsets, 1, starts);
  write("Types", types, 1, cells);
  file.group("/VTKHDF/PointData");
  write("PointData/displacement", vectors(*fields.displacement, fields.components),
        fields.components == 1 ? 1 : 3, nodes);
  if (fields.stress != nullptr) {
    std::vector<double> stress, equivalent;
    for (const std::vector<fem::Voigt>& part : *fields.stress)
      for (const fem::Voigt& s : part) {
        stress.insert(stress.end(), s.begin(), s.end());
        equivalent.push_back(vonMises(s));
      }
    write("PointData/stress", stress, 6, nodes);
    write("PointData/von_mises", equivalent, 1, nodes);
  }
  if (fields.contact != nullptr) {
    const ContactFields& contact = *fields.contact;
    write("PointData/contact_pressure", joined(contact.pressure), 1, nodes);
    write("PointData/gap", joined(contact.gap), 1, nodes);
    write("PointData/active_set", joined(contact.activeSet), 1, nodes);
  }
  file.group("/VTKHDF/CellData");
  write("CellData/subdomain", subdomains, 1, cells);
  write("CellData/body", bodies, 1, cells);
  write("CellData/region", regions, 1, cells);
  file.commit();
}

} // namespace Harmos::run
