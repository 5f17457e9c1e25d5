// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RunDirectory.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_Deck.hpp"

#include <Teuchos_XMLParameterListHelpers.hpp>

#include <filesystem>
#include <sstream>

namespace Harmos::run {

RunDirectory::RunDirectory(const Teuchos::Comm<int>& comm, const RunOptions& options)
    : comm_(comm), options_(options) {
  if (!options.checkpoint.restart.empty())
    checkpoint_ = std::make_unique<CheckpointReader>(comm, checkpointPath(options.checkpoint.restart));
}

void RunDirectory::checkDeck() const {
  if (!checkpoint_)
    return;
  agree(comm_, [&] {
    const std::string before = checkpoint_->text("deck"), &now = options_.checkpoint.deck;
    if (before.empty() || now.empty())
      return; // of an application without decks
    const std::string difference = scene::firstDifference(
        *Teuchos::getParametersFromXmlString(before), *Teuchos::getParametersFromXmlString(now),
        {"Output", "Solver/Tolerance", "Solver/Maximum iterations", "Solver/Maximum seconds",
         "Solver/Progress frequency"});
    if (!difference.empty())
      throw InputError("the checkpoint \"" + checkpoint_->path() + "\" is of another deck: " + difference +
                           "; restart with the deck that wrote it (tolerance, limits and output may differ)",
                       {{"file", checkpoint_->path()}});
  });
}

bool RunDirectory::goesOnInPlace() const {
  std::error_code error;
  return checkpoint_ &&
         std::filesystem::equivalent(checkpoint_->path(), checkpointPath(options_.outputDirectory), error);
}

void RunDirectory::prepare(const Log& log) const {
  agree(comm_, [&] {
    if (comm_.getRank() != 0)
      return;
    io::makeDirectory(options_.outputDirectory);
    for (const char* name : {"summary.json", "iterations.csv", "result.vtkhdf", "contact.csv", "ranks.csv"})
      io::removeFile(place(name));
    putCheckpointAside(log);
  });
}

// A checkpoint of another run is not to be taken for one of this, and not to be lost.
void RunDirectory::putCheckpointAside(const Log& log) const {
  const std::string path = checkpointPath(options_.outputDirectory);
  if (!std::filesystem::exists(path) || goesOnInPlace())
    return;
  const std::string aside = place("checkpoint.previous.h5");
  std::error_code error;
  std::filesystem::rename(path, aside, error);
  if (error)
    throw InputError("the checkpoint \"" + path + "\" of an earlier run cannot be put aside: " +
                         error.message() + "; remove it, or choose another output directory",
                     {{"file", path}});
  log.info("The checkpoint of an earlier run is \"" + aside + "\" now");
}

void RunDirectory::writeIterations(const std::vector<qp::IterationRecord>& history) const {
  agree(comm_, [&] {
    if (comm_.getRank() != 0)
      return;
    std::ostringstream text;
    qp::writeHistory(text, history);
    io::writeAtomically(place("iterations.csv"), text.str());
  });
}

void RunDirectory::removeQuietly(const std::string& file) const {
  if (comm_.getRank() != 0)
    return;
  try {
    io::removeFile(file);
  } catch (const InputError&) {
  }
}

void RunDirectory::removeCheckpoint(bool written) const {
  if (written || goesOnInPlace())
    removeQuietly(checkpointPath(options_.outputDirectory));
}

} // namespace Harmos::run
