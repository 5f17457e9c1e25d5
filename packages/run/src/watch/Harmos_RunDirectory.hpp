// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CheckpointFile.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_QpTypes.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_StepTable.hpp"

#include <Teuchos_Comm.hpp>

#include <memory>
#include <string>
#include <vector>

namespace Harmos::run {

/// The output directory of a run, and the checkpoint that the run goes on from, which may lie there too.
/// Guarded by tests/regression/test_checkpoint.py.
class RunDirectory {
 public:
  /// Opens the checkpoint of `Checkpoint/restart`, if there is one to go on from.
  /// @throws InputError on all ranks: it is not there, or damaged.
  /// @note Collective.
  RunDirectory(const Teuchos::Comm<int>& comm, const RunOptions& options);

  /// Null without one.
  const CheckpointReader* checkpoint() const { return checkpoint_.get(); }
  /// Where it lies; "" without one.
  std::string restartedFrom() const { return checkpoint_ ? checkpoint_->path() : std::string(); }

  /// @throws InputError on all ranks if it is of another deck. @note Collective.
  void checkDeck() const;

  std::string place(const std::string& file) const { return options_.outputDirectory + "/" + file; }

  /// Makes it. Results of an earlier run are removed, so that they are not taken for this one's if it fails;
  /// a checkpoint that this run does not go on from is put aside. Where the run goes on in its place after
  /// some steps, all stays for the time being (removeOtherResults()); into another directory results of steps
  /// are brought from where the checkpoint lies.
  /// @throws InputError on all ranks. @note Collective.
  void prepare(const Log& log) const;

  /// iterations.csv, whole. @throws InputError on all ranks. @note Collective.
  void writeIterations(const std::vector<qp::IterationRecord>& history) const;

  /// steps.csv, whole; then a row more. @throws InputError on all ranks. @note Collective.
  void writeSteps(const std::vector<StepRow>& rows, const std::vector<std::string>& paths,
                  const std::vector<std::string>& further) const;
  void appendStep(const StepRow& row) const;

  /// The result file of a step, and the series of those that were written: result.vtkhdf.series, in the JSON
  /// that ParaView reads.
  struct Written {
    int step;
    double time;
  };
  static std::string resultOf(int step);
  void writeSeries(const std::vector<Written>& written) const;
  /// Removes results of steps but these, and what tells of them. @note Collective.
  void removeOtherResults(const std::vector<Written>& kept) const;
  /// Those that the checkpoint tells of; none without one. @note Collective.
  std::vector<Written> writtenBefore() const;
  static void exchange(qp::StateArchive<MultiVector>& archive, std::vector<Written>& written);

  /// A file that is of no use any more, or a view of the run: that it stays is no reason to fail. Local.
  void removeQuietly(const std::string& file) const;

  /// The checkpoint has served: there is nothing left to go on to. Local.
  /// @param written whether this run wrote one.
  void removeCheckpoint(bool written) const;

 private:
  bool goesOnInPlace() const;
  // On rank 0 alone: no two ranks are to see different files.
  bool goesOnInSteps() const;
  void keepResults(const std::vector<Written>& kept) const;
  void bringResults() const;
  void putCheckpointAside(const Log& log) const;

  const Teuchos::Comm<int>& comm_;
  const RunOptions& options_;
  std::unique_ptr<CheckpointReader> checkpoint_;
};

} // namespace Harmos::run
