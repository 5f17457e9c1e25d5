// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_VtkHdf.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_Exchange.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <hdf5.h>
#include <memory>

namespace Harmos::scene {
namespace {

// Closes what it holds; HDF5 has a close function for each kind.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
    if (id < 0)
      throw InputError("the result file cannot be written: HDF5 failed at " + what +
                       "; check that the directory is writable and the disk is not full");
  }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void require(herr_t status, const std::string& what) {
  if (status < 0)
    throw InputError("the result file cannot be written: HDF5 failed at " + what +
                     "; check that the directory is writable and the disk is not full");
}

template<class T>
hid_t typeOf();
template<>
hid_t typeOf<double>() {
  return H5T_NATIVE_DOUBLE;
}
template<>
hid_t typeOf<long long>() {
  return H5T_NATIVE_LLONG;
}
template<>
hid_t typeOf<int>() {
  return H5T_NATIVE_INT;
}
template<>
hid_t typeOf<unsigned char>() {
  return H5T_NATIVE_UCHAR;
}

// A dataset of rows, of which each rank writes the block from its first row on; all ranks take part. A write
// that fails on one rank (the disk is full) is agreed on before the next collective call.
template<class T>
void writeRows(const Teuchos::Comm<int>& comm, hid_t group, const std::string& name,
               const std::vector<T>& mine, hsize_t width, long long first, long long total) {
  const hsize_t rows = mine.size() / width;
  const std::array<hsize_t, 2> size = {static_cast<hsize_t>(total), width}, count = {rows, width},
                               start = {static_cast<hsize_t>(first), 0};
  const int rank = width > 1 ? 2 : 1;
  std::unique_ptr<Handle> fileSpace, dataset, memorySpace, transfer;
  agree(comm, [&] {
    fileSpace =
        std::make_unique<Handle>(H5Screate_simple(rank, size.data(), nullptr), H5Sclose, "a data space");
    dataset = std::make_unique<Handle>(
        H5Dcreate2(group, name.c_str(), typeOf<T>(), *fileSpace, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose, "dataset " + name);
    memorySpace =
        std::make_unique<Handle>(H5Screate_simple(rank, count.data(), nullptr), H5Sclose, "a data space");
    if (rows > 0) {
      require(H5Sselect_hyperslab(*fileSpace, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
              name);
    } else {
      require(H5Sselect_none(*fileSpace), name);
      require(H5Sselect_none(*memorySpace), name);
    }
    transfer = std::make_unique<Handle>(H5Pcreate(H5P_DATASET_XFER), H5Pclose, "a transfer property list");
    // Independent: each rank writes one block of its own, which gains nothing from aggregation, and a
    // collective write leaves the other ranks waiting inside of MPI when it fails on one.
    require(H5Pset_dxpl_mpio(*transfer, H5FD_MPIO_INDEPENDENT), name);
  });
  const herr_t status =
      rows > 0 ? H5Dwrite(*dataset, typeOf<T>(), *memorySpace, *fileSpace, *transfer, mine.data()) : 0;
  agree(comm, [&] { require(status, "dataset " + name); });
}

void writeAttributes(hid_t group) {
  const std::array<int, 2> version = {1, 0};
  const hsize_t two = 2;
  const Handle versionSpace(H5Screate_simple(1, &two, nullptr), H5Sclose, "a data space");
  const Handle versionAttribute(
      H5Acreate2(group, "Version", H5T_NATIVE_INT, versionSpace, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
      "Version");
  require(H5Awrite(versionAttribute, H5T_NATIVE_INT, version.data()), "Version");
  const std::string type = "UnstructuredGrid";
  const Handle text(H5Tcopy(H5T_C_S1), H5Tclose, "a string type");
  require(H5Tset_size(text, type.size()), "Type");
  require(H5Tset_strpad(text, H5T_STR_NULLPAD), "Type");
  const Handle scalar(H5Screate(H5S_SCALAR), H5Sclose, "a data space");
  const Handle typeAttribute(H5Acreate2(group, "Type", text, scalar, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                             "Type");
  require(H5Awrite(typeAttribute, text, type.c_str()), "Type");
}

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
                 const std::vector<OwnedSubdomain>& owned, const ResultFields& fields) {
  const auto* mpi = dynamic_cast<const Teuchos::MpiComm<int>*>(&comm);
  HARMOS_REQUIRE(mpi != nullptr, "result files need an MPI communicator");

  // This rank's share of each array.
  std::vector<double> points;
  std::vector<long long> pointCounts, cellCounts, linkCounts, links, offsets;
  std::vector<int> subdomains, bodies, regions;
  std::vector<unsigned char> types;
  for (const OwnedSubdomain& item : owned) {
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

  // Before any other call: HDF5 would try again to flush a file that it could not close when the program
  // ends, after MPI has ended.
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const auto removePart = [&] {
    if (comm.getRank() == 0)
      std::remove(partPath(path).c_str());
  };
  try {
    std::unique_ptr<Handle> access, file, root, pointData, cellData;
    const auto makeGroup = [&](std::unique_ptr<Handle>& group, hid_t parent, const char* name) {
      agree(comm, [&] {
        group = std::make_unique<Handle>(H5Gcreate2(parent, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                                         H5Gclose, std::string("group ") + name);
      });
    };
    agree(comm, [&] {
      access = std::make_unique<Handle>(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "a file property list");
      require(H5Pset_fapl_mpio(*access, *mpi->getRawMpiComm(), MPI_INFO_NULL), "MPI access");
    });
    const hid_t id = H5Fcreate(partPath(path).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, *access);
    agree(comm, [&] { file = std::make_unique<Handle>(id, H5Fclose, "opening \"" + partPath(path) + "\""); });
    makeGroup(root, *file, "VTKHDF");
    agree(comm, [&] { writeAttributes(*root); });
    writeRows(comm, *root, "NumberOfPoints", pointCounts, 1, parts.first, parts.total);
    writeRows(comm, *root, "NumberOfCells", cellCounts, 1, parts.first, parts.total);
    writeRows(comm, *root, "NumberOfConnectivityIds", linkCounts, 1, parts.first, parts.total);
    writeRows(comm, *root, "Points", points, 3, nodes.first, nodes.total);
    writeRows(comm, *root, "Connectivity", links, 1, connectivity.first, connectivity.total);
    writeRows(comm, *root, "Offsets", offsets, 1, starts.first, starts.total);
    writeRows(comm, *root, "Types", types, 1, cells.first, cells.total);
    makeGroup(pointData, *root, "PointData");
    writeRows(comm, *pointData, "displacement", vectors(*fields.displacement, fields.components),
              fields.components == 1 ? 1 : 3, nodes.first, nodes.total);
    if (fields.stress != nullptr) {
      std::vector<double> stress, equivalent;
      for (const std::vector<fem::Voigt>& part : *fields.stress)
        for (const fem::Voigt& s : part) {
          stress.insert(stress.end(), s.begin(), s.end());
          equivalent.push_back(vonMises(s));
        }
      writeRows(comm, *pointData, "stress", stress, 6, nodes.first, nodes.total);
      writeRows(comm, *pointData, "von_mises", equivalent, 1, nodes.first, nodes.total);
    }
    if (fields.contact != nullptr) {
      const ContactFields& contact = *fields.contact;
      writeRows(comm, *pointData, "contact_pressure", joined(contact.pressure), 1, nodes.first, nodes.total);
      writeRows(comm, *pointData, "gap", joined(contact.gap), 1, nodes.first, nodes.total);
      writeRows(comm, *pointData, "active_set", joined(contact.activeSet), 1, nodes.first, nodes.total);
    }
    makeGroup(cellData, *root, "CellData");
    writeRows(comm, *cellData, "subdomain", subdomains, 1, cells.first, cells.total);
    writeRows(comm, *cellData, "body", bodies, 1, cells.first, cells.total);
    writeRows(comm, *cellData, "region", regions, 1, cells.first, cells.total);
    const herr_t flushed = H5Fflush(*file, H5F_SCOPE_GLOBAL);
    agree(comm, [&] { require(flushed, "flushing"); });
  } catch (...) {
    removePart();
    throw;
  }
  agree(comm, [&] {
    if (comm.getRank() == 0)
      renamePart(path);
  });
}

} // namespace Harmos::scene
