// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Hdf5.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

#include <array>
#include <cstdio>
#include <hdf5.h>
#include <unistd.h>

namespace Harmos::io {
namespace {

// Closes what it holds; HDF5 has a close function for each kind.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0)
      close_(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

struct Faults {
  std::string path, what, verb, remedy;

  [[noreturn]] void raise(const std::string& place) const {
    throw InputError(what + " \"" + path + "\" cannot be " + verb + ": HDF5 failed at " + place + "; " +
                         remedy,
                     {{"file", path}});
  }
  Handle handle(hid_t id, herr_t (*close)(hid_t), const std::string& place) const {
    if (id < 0)
      raise(place);
    return Handle(id, close);
  }
  void require(herr_t status, const std::string& place) const {
    if (status < 0)
      raise(place);
  }
};

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

// Before any other call: HDF5 would try again to flush a file that it could not close when the program ends,
// after MPI has ended.
void quieten() {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

} // namespace

struct Hdf5Writer::File {
  Faults faults;
  std::unique_ptr<Handle> file;
};

Hdf5Writer::Hdf5Writer(const Teuchos::Comm<int>& comm, const std::string& path, const std::string& what,
                       long long bytes)
    : comm_(comm), path_(path), what_(what), file_(std::make_unique<File>()) {
  const auto* mpi = dynamic_cast<const Teuchos::MpiComm<int>*>(&comm);
  HARMOS_REQUIRE(mpi != nullptr, "files of all ranks need an MPI communicator");
  quieten();
  file_->faults = {path, what, "written", "check that the directory is writable and the disk is not full"};
  const Faults& faults = file_->faults;
  agree(comm, [&] {
    // For HDF5's own book-keeping.
    constexpr long long margin = 65536;
    if (comm.getRank() == 0)
      makePart(path, bytes + bytes / 50 + margin);
  });
  // A file that one rank alone cannot open would leave the others waiting inside of MPI.
  agree(comm, [&] { requirePart(path); });
  std::unique_ptr<Handle> access;
  agree(comm, [&] {
    access =
        std::make_unique<Handle>(faults.handle(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "a file property list"));
    faults.require(H5Pset_fapl_mpio(*access, *mpi->getRawMpiComm(), MPI_INFO_NULL), "MPI access");
  });
  const hid_t id = H5Fcreate(partPath(path).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, *access);
  agree(comm, [&] {
    file_->file = std::make_unique<Handle>(faults.handle(id, H5Fclose, "opening \"" + partPath(path) + "\""));
  });
}

Hdf5Writer::~Hdf5Writer() {
  if (file_ == nullptr)
    return;
  // Room for what HDF5 still wants to write before it lets go of the file.
  if (comm_.getRank() == 0 && ::truncate(partPath(path_).c_str(), 0) != 0)
    file_->faults.remedy.clear(); // there is no such file: nothing to make room in
  file_.reset();
  if (comm_.getRank() == 0)
    std::remove(partPath(path_).c_str());
}

void Hdf5Writer::group(const std::string& path) {
  const Faults& faults = file_->faults;
  agree(comm_, [&] {
    faults.handle(H5Gcreate2(*file_->file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                  "group " + path);
  });
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name,
                           const std::vector<int>& values) {
  const Faults& faults = file_->faults;
  agree(comm_, [&] {
    const hsize_t size = values.size();
    const Handle parent =
        faults.handle(H5Gopen2(*file_->file, group.c_str(), H5P_DEFAULT), H5Gclose, "group " + group);
    const Handle space = faults.handle(H5Screate_simple(1, &size, nullptr), H5Sclose, "a data space");
    const Handle attribute = faults.handle(
        H5Acreate2(parent, name.c_str(), H5T_NATIVE_INT, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
    faults.require(H5Awrite(attribute, H5T_NATIVE_INT, values.data()), name);
  });
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name, const std::string& text) {
  const Faults& faults = file_->faults;
  agree(comm_, [&] {
    const Handle parent =
        faults.handle(H5Gopen2(*file_->file, group.c_str(), H5P_DEFAULT), H5Gclose, "group " + group);
    const Handle type = faults.handle(H5Tcopy(H5T_C_S1), H5Tclose, "a string type");
    faults.require(H5Tset_size(type, text.size()), name);
    faults.require(H5Tset_strpad(type, H5T_STR_NULLPAD), name);
    const Handle scalar = faults.handle(H5Screate(H5S_SCALAR), H5Sclose, "a data space");
    const Handle attribute = faults.handle(
        H5Acreate2(parent, name.c_str(), type, scalar, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
    faults.require(H5Awrite(attribute, type, text.c_str()), name);
  });
}

template<class T>
void Hdf5Writer::rows(const std::string& path, const std::vector<T>& mine, std::size_t width, long long first,
                      long long total) {
  const Faults& faults = file_->faults;
  const hsize_t count = mine.size() / width;
  const std::array<hsize_t, 2> size = {static_cast<hsize_t>(total), width}, block = {count, width},
                               start = {static_cast<hsize_t>(first), 0};
  const int rank = width > 1 ? 2 : 1;
  std::unique_ptr<Handle> fileSpace, dataset, memorySpace, transfer;
  agree(comm_, [&] {
    fileSpace = std::make_unique<Handle>(
        faults.handle(H5Screate_simple(rank, size.data(), nullptr), H5Sclose, "a data space"));
    dataset =
        std::make_unique<Handle>(faults.handle(H5Dcreate2(*file_->file, path.c_str(), typeOf<T>(), *fileSpace,
                                                          H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                                               H5Dclose, "dataset " + path));
    memorySpace = std::make_unique<Handle>(
        faults.handle(H5Screate_simple(rank, block.data(), nullptr), H5Sclose, "a data space"));
    if (count > 0) {
      faults.require(
          H5Sselect_hyperslab(*fileSpace, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr),
          path);
    } else {
      faults.require(H5Sselect_none(*fileSpace), path);
      faults.require(H5Sselect_none(*memorySpace), path);
    }
    transfer = std::make_unique<Handle>(
        faults.handle(H5Pcreate(H5P_DATASET_XFER), H5Pclose, "a transfer property list"));
    // Independent: each rank writes one block of its own, which gains nothing from aggregation, and a
    // collective write leaves the other ranks waiting inside of MPI when it fails on one.
    faults.require(H5Pset_dxpl_mpio(*transfer, H5FD_MPIO_INDEPENDENT), path);
  });
  const herr_t status =
      count > 0 ? H5Dwrite(*dataset, typeOf<T>(), *memorySpace, *fileSpace, *transfer, mine.data()) : 0;
  agree(comm_, [&] { faults.require(status, "dataset " + path); });
}

void Hdf5Writer::commit() {
  const Faults& faults = file_->faults;
  const herr_t flushed = H5Fflush(*file_->file, H5F_SCOPE_GLOBAL);
  agree(comm_, [&] { faults.require(flushed, "flushing"); });
  file_->file.reset();
  agree(comm_, [&] {
    if (comm_.getRank() != 0)
      return;
    syncPart(path_);
    renamePart(path_);
  });
  file_.reset();
}

struct Hdf5Reader::File {
  Faults faults;
  std::unique_ptr<Handle> file;

  Handle dataset(const std::string& path) const {
    return faults.handle(H5Dopen2(*file, path.c_str(), H5P_DEFAULT), H5Dclose, "dataset " + path);
  }
};

Hdf5Reader::Hdf5Reader(const std::string& path, const std::string& what)
    : path_(path), what_(what), file_(std::make_unique<File>()) {
  quieten();
  file_->faults = {path, what, "read", "its contents differ from those written, or another program wrote it"};
  file_->file = std::make_unique<Handle>(
      file_->faults.handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "opening it"));
}

Hdf5Reader::~Hdf5Reader() = default;

bool Hdf5Reader::has(const std::string& path) const {
  return H5Lexists(*file_->file, path.c_str(), H5P_DEFAULT) > 0;
}

Hdf5Reader::Shape Hdf5Reader::shape(const std::string& path) const {
  const Faults& faults = file_->faults;
  const Handle dataset = file_->dataset(path);
  const Handle space = faults.handle(H5Dget_space(dataset), H5Sclose, "the data space of " + path);
  const int dimensions = H5Sget_simple_extent_ndims(space);
  std::array<hsize_t, 2> size = {0, 1};
  if (dimensions < 1 || dimensions > 2)
    faults.raise("the shape of " + path);
  faults.require(H5Sget_simple_extent_dims(space, size.data(), nullptr), "the shape of " + path);
  return {static_cast<long long>(size[0]), static_cast<std::size_t>(size[1])};
}

template<class T>
std::vector<T> Hdf5Reader::rows(const std::string& path, long long first, long long count) const {
  const Faults& faults = file_->faults;
  const Shape whole = shape(path);
  if (first < 0 || count < 0 || first + count > whole.rows)
    faults.raise("the rows of " + path);
  std::vector<T> values(static_cast<std::size_t>(count) * whole.width);
  if (count == 0)
    return values;
  const Handle dataset = file_->dataset(path);
  const Handle space = faults.handle(H5Dget_space(dataset), H5Sclose, "the data space of " + path);
  const std::array<hsize_t, 2> start = {static_cast<hsize_t>(first), 0},
                               block = {static_cast<hsize_t>(count), whole.width};
  const int rank = H5Sget_simple_extent_ndims(space);
  const Handle memory =
      faults.handle(H5Screate_simple(rank, block.data(), nullptr), H5Sclose, "a data space");
  faults.require(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr),
                 path);
  faults.require(H5Dread(dataset, typeOf<T>(), memory, space, H5P_DEFAULT, values.data()), "dataset " + path);
  return values;
}

template void Hdf5Writer::rows(const std::string&, const std::vector<double>&, std::size_t, long long,
                               long long);
template void Hdf5Writer::rows(const std::string&, const std::vector<long long>&, std::size_t, long long,
                               long long);
template void Hdf5Writer::rows(const std::string&, const std::vector<int>&, std::size_t, long long,
                               long long);
template void Hdf5Writer::rows(const std::string&, const std::vector<unsigned char>&, std::size_t, long long,
                               long long);
template std::vector<double> Hdf5Reader::rows(const std::string&, long long, long long) const;
template std::vector<long long> Hdf5Reader::rows(const std::string&, long long, long long) const;
template std::vector<int> Hdf5Reader::rows(const std::string&, long long, long long) const;
template std::vector<unsigned char> Hdf5Reader::rows(const std::string&, long long, long long) const;

} // namespace Harmos::io
