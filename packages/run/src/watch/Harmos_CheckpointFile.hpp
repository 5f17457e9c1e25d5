// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Hdf5.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_RCP.hpp>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace Harmos::run {

/// Where a run's checkpoint lies.
std::string checkpointPath(const std::string& directory);

/// Maps a vector of the equality rows to a form independent of their basis, and back. The basis of the rows
/// of G can depend on the number of ranks, because its pivots are compared in floating point; Gᵀμ does not.
struct RowBasis {
  std::function<void(const MultiVector& rows, MultiVector& dual)> toDual;   ///< Gᵀμ
  std::function<void(const MultiVector& dual, MultiVector& rows)> fromDual; ///< G of that
};

/// How many bytes a state takes. All members are local.
class StateSize : public qp::StateArchive<MultiVector> {
 public:
  bool isReading() const override { return false; }
  void numbers(const std::string& name, std::vector<double>& values) override;
  void vector(const std::string& name, MultiVector& x) override;
  void rowVector(const std::string& name, MultiVector& x) override;
  long long bytes() const { return bytes_; }

 private:
  long long bytes_ = 0;
  long long unknowns_ = 0;
};

/// Writes a checkpoint: /vectors, distributed by their global numbers, /texts, /numbers, and the checksums
/// of all of them.
///
/// The checksum of a dataset is the sum modulo 2⁶⁴ of mixed pairs of place and value, so that it does not
/// depend on how many ranks make it. All members are collective, with the errors of Hdf5Writer.
/// Guarded by tests/unit/run/test_checkpoint_file.cpp.
class CheckpointWriter : public qp::StateArchive<MultiVector> {
 public:
  /// @param basis of the vectors of the equality rows. @param bytes of all that is to be written.
  CheckpointWriter(const Teuchos::Comm<int>& comm, const std::string& path, const RowBasis& basis,
                   long long bytes);

  bool isReading() const override { return false; }
  void numbers(const std::string& name, std::vector<double>& values) override;
  void vector(const std::string& name, MultiVector& x) override;
  void rowVector(const std::string& name, MultiVector& x) override;
  void text(const std::string& name, const std::string& value);

  /// Gives the file its name.
  void commit();

 private:
  template<class T>
  void write(const std::string& dataset, const std::vector<T>& mine, std::size_t width, long long first,
             long long total);

  const Teuchos::Comm<int>& comm_;
  RowBasis basis_;
  io::Hdf5Writer file_;
  std::map<std::string, std::vector<double>> numbers_;
  Teuchos::RCP<MultiVector> dualLike_; // a vector of the shape of Gᵀμ
  std::string names_;                  // of the datasets, a line each
  std::vector<long long> sums_;
};

/// Reads a checkpoint, with any number of ranks. The checksums are compared when it is opened.
class CheckpointReader {
 public:
  /// @throws InputError on all ranks if there is none, if it is damaged, or of another version of the format.
  /// @note Collective.
  CheckpointReader(const Teuchos::Comm<int>& comm, const std::string& path);

  const std::string& path() const { return path_; }
  /// Of a text that was written; "" if there is none. Local.
  std::string text(const std::string& name) const;
  bool holds(const std::string& name) const { return numbers_.count(name) > 0; }

  /// Lets whoever described the state have it back. @param basis as at present. @note Collective.
  void restore(const RowBasis& basis,
               const std::function<void(qp::StateArchive<MultiVector>&)>& exchange) const;

 private:
  class Archive;
  void verify() const;

  const Teuchos::Comm<int>& comm_;
  std::string path_;
  std::unique_ptr<io::Hdf5Reader> file_;
  std::map<std::string, std::vector<double>> numbers_;
  std::map<std::string, std::string> texts_;
};

} // namespace Harmos::run
