// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Teuchos_Comm.hpp>

#include <memory>
#include <string>
#include <vector>

namespace Harmos::io {

/// An HDF5 file that all ranks write at once, and that is there whole or not at all: it takes its name when
/// all of it is on the disk, and until then a file of that name is left alone. Elements are double, long
/// long, int or unsigned char.
///
/// A write that fails on one rank (the disk is full) is agreed on before the next collective call. All
/// members are collective. @throws InputError on all ranks, with the name of the file and what to look at.
/// Guarded by tests/unit/io/test_hdf5.cpp.
class Hdf5Writer {
 public:
  /// @param comm an MPI communicator; @param what the file is, for messages: "the result file".
  /// @param bytes of all datasets. There has to be room for them before the first one is written: HDF5 can
  /// neither go on nor close a file whose disk is full.
  Hdf5Writer(const Teuchos::Comm<int>& comm, const std::string& path, const std::string& what,
             long long bytes);
  /// Removes what was not committed.
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  /// A group, by its path: "/VTKHDF/PointData". Its parent is to be there.
  void group(const std::string& path);
  void attribute(const std::string& group, const std::string& name, const std::vector<int>& values);
  void attribute(const std::string& group, const std::string& name, const std::string& text);

  /// A dataset of `total` rows of `width` elements, of which each rank writes the block from its first row
  /// on; a vector of numbers if the width is one.
  template<class T>
  void rows(const std::string& path, const std::vector<T>& mine, std::size_t width, long long first,
            long long total);

  /// Writes what is not written yet, and gives the file its name.
  void commit();

 private:
  struct File;
  const Teuchos::Comm<int>& comm_;
  std::string path_, what_;
  std::unique_ptr<File> file_;
};

/// An HDF5 file that every rank reads for itself. Local. @throws InputError naming the file.
class Hdf5Reader {
 public:
  Hdf5Reader(const std::string& path, const std::string& what);
  ~Hdf5Reader();

  bool has(const std::string& path) const;
  /// Of a dataset: rows, and elements a row.
  struct Shape {
    long long rows = 0;
    std::size_t width = 1;
  };
  Shape shape(const std::string& path) const;
  /// `count` rows from the first one on.
  template<class T>
  std::vector<T> rows(const std::string& path, long long first, long long count) const;
  /// All of them.
  template<class T>
  std::vector<T> all(const std::string& path) const {
    return rows<T>(path, 0, shape(path).rows);
  }

 private:
  struct File;
  std::string path_, what_;
  std::unique_ptr<File> file_;
};

} // namespace Harmos::io
