// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ResultFile.hpp"

#include "Harmos_VtkCell.hpp"
#include "Harmos_VtkHdf.hpp"

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

using Owned = std::vector<scene::OwnedSubdomain>;

io::VtkParts partsOf(const Owned& owned) {
  io::VtkParts parts;
  for (const scene::OwnedSubdomain& item : owned) {
    const fem::Mesh& mesh = *item.mesh.mesh;
    parts.points.push_back(mesh.numberOfNodes());
    parts.cells.push_back(mesh.numberOfCells());
    parts.links.push_back(static_cast<long long>(mesh.cells.size()));
  }
  return parts;
}

// What writeFields() and writeCellData() write.
long long bytesOf(const Owned& owned, const ResultFields& fields) {
  const int width = (fields.components == 1 ? 1 : 3) + (fields.velocity != nullptr ? 3 : 0) +
                    (fields.stress != nullptr ? 7 : 0) + (fields.plasticStrain != nullptr ? 1 : 0);
  const long long atPoint = 8LL * width + (fields.contact != nullptr ? 17 : 0) +
                            (fields.contact != nullptr && !fields.contact->friction.empty() ? 49 : 0) +
                            (fields.contact != nullptr && !fields.contact->damage.empty() ? 57 : 0);
  const long long ofCell =
      3LL * 4 + (fields.cellStress != nullptr ? 6LL * 8 : 0) + (fields.cellError != nullptr ? 8 : 0);
  long long bytes = 0;
  for (const scene::OwnedSubdomain& item : owned)
    bytes += atPoint * item.mesh.mesh->numberOfNodes() + ofCell * item.mesh.mesh->numberOfCells();
  return bytes;
}

// Nodes or cells of all of them.
std::size_t rowsOf(const Owned& owned, int (fem::Mesh::*count)() const) {
  std::size_t rows = 0;
  for (const scene::OwnedSubdomain& item : owned)
    rows += static_cast<std::size_t>(((*item.mesh.mesh).*count)());
  return rows;
}

void writePoints(io::VtkHdfWriter& file, const Owned& owned) {
  std::vector<double> points;
  points.reserve(3 * rowsOf(owned, &fem::Mesh::numberOfNodes));
  for (const scene::OwnedSubdomain& item : owned)
    for (int node = 0; node < item.mesh.mesh->numberOfNodes(); ++node)
      for (double coordinate : item.mesh.position(node))
        points.push_back(coordinate);
  file.points(points);
}

void writeCells(io::VtkHdfWriter& file, const Owned& owned) {
  std::vector<long long> links, offsets;
  std::vector<unsigned char> types;
  const std::size_t cells = rowsOf(owned, &fem::Mesh::numberOfCells);
  offsets.reserve(cells + owned.size());
  types.reserve(cells);
  std::size_t linkCount = 0;
  for (const scene::OwnedSubdomain& item : owned)
    linkCount += item.mesh.mesh->cells.size();
  links.reserve(linkCount);
  for (const scene::OwnedSubdomain& item : owned) {
    const fem::Mesh& mesh = *item.mesh.mesh;
    const VtkCell vtk = vtkCell(mesh.cellType);
    for (int c = 0; c < mesh.numberOfCells(); ++c) {
      offsets.push_back(static_cast<long long>(c) * mesh.nodesPerCell());
      for (int node : vtk.nodes)
        links.push_back(mesh.cell(c)[node]);
    }
    offsets.push_back(static_cast<long long>(mesh.cells.size()));
    types.insert(types.end(), static_cast<std::size_t>(mesh.numberOfCells()), vtk.type);
  }
  file.cells(links, offsets, types);
}

std::vector<double> flat(const std::vector<std::vector<fem::Voigt>>& stresses) {
  std::vector<double> result;
  for (const std::vector<fem::Voigt>& part : stresses)
    for (const fem::Voigt& s : part)
      result.insert(result.end(), s.begin(), s.end());
  return result;
}

void writeStress(io::VtkHdfWriter& file, const std::vector<std::vector<fem::Voigt>>& stresses) {
  std::vector<double> equivalent;
  for (const std::vector<fem::Voigt>& part : stresses)
    for (const fem::Voigt& s : part)
      equivalent.push_back(vonMises(s));
  file.pointData("stress", flat(stresses), 6);
  file.pointData("von_mises", equivalent);
}

void writeContact(io::VtkHdfWriter& file, const ContactFields& contact, ContactFieldKinds kinds) {
  file.pointData("contact_pressure", joined(contact.pressure));
  file.pointData("gap", joined(contact.gap));
  file.pointData("active_set", joined(contact.activeSet));
  if (kinds.friction) {
    file.pointData("friction_traction", joined(contact.traction), 3);
    file.pointData("slip", joined(contact.slip), 3);
    file.pointData("friction_state", joined(contact.friction));
  }
  if (kinds.adhesion) {
    file.pointData("bound", joined(contact.bound));
    file.pointData("damage", joined(contact.damage));
    file.pointData("jump", joined(contact.jump), 3);
    file.pointData("interface_traction", joined(contact.interfaceTraction), 3);
  }
}

// A number for each cell.
template<class NumberOf>
std::vector<int> cellNumbers(const Owned& owned, const NumberOf& numberOf) {
  std::vector<int> numbers;
  numbers.reserve(rowsOf(owned, &fem::Mesh::numberOfCells));
  for (const scene::OwnedSubdomain& item : owned)
    for (int c = 0; c < item.mesh.mesh->numberOfCells(); ++c)
      numbers.push_back(numberOf(item, c));
  return numbers;
}

} // namespace

void writeResult(const Teuchos::Comm<int>& comm, const std::string& path,
                 const std::vector<scene::OwnedSubdomain>& owned, const ResultFields& fields) {
  // decompose() gives consecutive subdomains to consecutive ranks: these are the parts in their order.
  io::VtkHdfWriter file(comm, path, partsOf(owned), bytesOf(owned, fields));
  writePoints(file, owned);
  writeCells(file, owned);
  file.pointData("displacement", vectors(*fields.displacement, fields.components),
                 fields.components == 1 ? 1 : 3);
  if (fields.velocity != nullptr)
    file.pointData("velocity", vectors(*fields.velocity, fields.components), 3);
  if (fields.stress != nullptr)
    writeStress(file, *fields.stress);
  if (fields.plasticStrain != nullptr)
    file.pointData("equivalent_plastic_strain", joined(*fields.plasticStrain));
  if (fields.contact != nullptr)
    writeContact(file, *fields.contact, fields.kinds);
  if (fields.cellStress != nullptr)
    file.cellData("cell_stress", flat(*fields.cellStress), 6);
  if (fields.cellError != nullptr)
    file.cellData("estimated_error", joined(*fields.cellError));
  using Item = scene::OwnedSubdomain;
  file.cellData("subdomain",
                cellNumbers(owned, [](const Item& item, int) { return static_cast<int>(item.number); }));
  file.cellData("body", cellNumbers(owned, [](const Item& item, int) { return item.body; }));
  file.cellData("region",
                cellNumbers(owned, [](const Item& item, int c) { return item.mesh.mesh->region(c); }));
  file.commit();
}

} // namespace Harmos::run
