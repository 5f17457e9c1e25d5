// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Hdf5.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::io {

/// The parts of an unstructured grid that a rank has: an entry each.
struct VtkParts {
  std::vector<long long> points;
  std::vector<long long> cells;
  std::vector<long long> links; ///< entries of the connectivity
};

/// An unstructured grid and fields on it for ParaView: one HDF5 file in VTK's VTKHDF UnstructuredGrid layout
/// (version 1.0; VTK file formats, "HDF file formats"), written by all ranks together. It knows arrays only:
/// each call takes this rank's share, and the caller may let go of it afterwards.
///
/// Parts of lower ranks come first: a grid that is dealt out in the order of its parts gives the same file
/// on any number of ranks. All members are collective.
/// @throws InputError on all ranks if the file cannot be written; what was there before is then untouched.
/// Guarded by tests/regression/test_result_file.py (VTK's own reader).
class VtkHdfWriter {
 public:
  /// @param fieldBytes of all pointData() and cellData() of this rank: there has to be room on the disk.
  VtkHdfWriter(const Teuchos::Comm<int>& comm, const std::string& path, const VtkParts& parts,
               long long fieldBytes);

  /// @param coordinates three a point.
  void points(const std::vector<double>& coordinates);
  /// @param links points of the cells, counted within the part. @param offsets where the links of each cell
  /// of a part begin, and after its last one where they end. @param types VTK's numbers.
  void cells(const std::vector<long long>& links, const std::vector<long long>& offsets,
             const std::vector<unsigned char>& types);

  /// Fields: `width` numbers a point or a cell; after points and cells, those of points first.
  template<class T>
  void pointData(const std::string& name, const std::vector<T>& values, std::size_t width = 1);
  template<class T>
  void cellData(const std::string& name, const std::vector<T>& values, std::size_t width = 1);

  /// Gives the file its name.
  void commit() { file_.commit(); }

 private:
  // Where this rank's rows of a dataset are.
  struct Extent {
    long long first, total;
  };
  Extent extent(long long rows) const;
  template<class T>
  void write(const std::string& name, const std::vector<T>& mine, std::size_t width, const Extent& place);
  void openGroup(const std::string& name);

  const Teuchos::Comm<int>& comm_;
  Extent parts_, points_, cells_;
  Hdf5Writer file_;
  std::string group_; // that fields go to
};

} // namespace Harmos::io
