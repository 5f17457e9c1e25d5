// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_VtkHdf.hpp"

#include "Harmos_Exchange.hpp"

#include <numeric>

namespace Harmos::io {
namespace {

long long sum(const std::vector<long long>& values) {
  return std::accumulate(values.begin(), values.end(), 0LL);
}

// Of the grid: coordinates, connectivity, offsets, types and the counts of the parts.
long long gridBytes(const VtkParts& parts) {
  const auto number = static_cast<long long>(sizeof(double));
  const auto count = static_cast<long long>(parts.cells.size());
  const long long cells = sum(parts.cells);
  return number * (3 * sum(parts.points) + sum(parts.links) + cells + count + 3 * count) + cells;
}

} // namespace

VtkHdfWriter::VtkHdfWriter(const Teuchos::Comm<int>& comm, const std::string& path, const VtkParts& parts,
                           long long fieldBytes)
    : comm_(comm),
      parts_(extent(static_cast<long long>(parts.cells.size()))),
      points_(extent(sum(parts.points))),
      cells_(extent(sum(parts.cells))),
      file_(comm, path, "the result file", globalSum(comm, gridBytes(parts) + fieldBytes)) {
  file_.group("/VTKHDF");
  file_.attribute("/VTKHDF", "Version", std::vector<int>{1, 0});
  file_.attribute("/VTKHDF", "Type", std::string("UnstructuredGrid"));
  write("NumberOfPoints", parts.points, 1, parts_);
  write("NumberOfCells", parts.cells, 1, parts_);
  write("NumberOfConnectivityIds", parts.links, 1, parts_);
}

VtkHdfWriter::Extent VtkHdfWriter::extent(long long rows) const {
  return {exclusiveScan(comm_, rows), globalSum(comm_, rows)};
}

template<class T>
void VtkHdfWriter::write(const std::string& name, const std::vector<T>& mine, std::size_t width,
                         const Extent& place) {
  file_.rows("/VTKHDF/" + name, mine, width, place.first, place.total);
}

void VtkHdfWriter::points(const std::vector<double>& coordinates) {
  write("Points", coordinates, 3, points_);
}

void VtkHdfWriter::cells(const std::vector<long long>& links, const std::vector<long long>& offsets,
                         const std::vector<unsigned char>& types) {
  write("Connectivity", links, 1, extent(static_cast<long long>(links.size())));
  write("Offsets", offsets, 1, extent(static_cast<long long>(offsets.size())));
  write("Types", types, 1, cells_);
}

void VtkHdfWriter::openGroup(const std::string& name) {
  if (group_ == name)
    return;
  group_ = name;
  file_.group("/VTKHDF/" + name);
}

template<class T>
void VtkHdfWriter::pointData(const std::string& name, const std::vector<T>& values, std::size_t width) {
  openGroup("PointData");
  write("PointData/" + name, values, width, points_);
}

template<class T>
void VtkHdfWriter::cellData(const std::string& name, const std::vector<T>& values, std::size_t width) {
  openGroup("CellData");
  write("CellData/" + name, values, width, cells_);
}

template void VtkHdfWriter::pointData(const std::string&, const std::vector<double>&, std::size_t);
template void VtkHdfWriter::pointData(const std::string&, const std::vector<unsigned char>&, std::size_t);
template void VtkHdfWriter::cellData(const std::string&, const std::vector<int>&, std::size_t);
template void VtkHdfWriter::cellData(const std::string&, const std::vector<double>&, std::size_t);

} // namespace Harmos::io
