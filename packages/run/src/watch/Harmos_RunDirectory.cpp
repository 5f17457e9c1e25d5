// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RunDirectory.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_Deck.hpp"

#include <Teuchos_XMLParameterListHelpers.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <set>
#include <sstream>

namespace Harmos::run {
namespace {

// result_0001.vtkhdf
bool isResultOfStep(const std::string& name) {
  const std::string begin = "result_", end = ".vtkhdf";
  if (name.size() <= begin.size() + end.size() || name.rfind(begin, 0) != 0 ||
      name.compare(name.size() - end.size(), end.size(), end) != 0)
    return false;
  return std::all_of(name.begin() + static_cast<std::ptrdiff_t>(begin.size()),
                     name.end() - static_cast<std::ptrdiff_t>(end.size()),
                     [](char c) { return c >= '0' && c <= '9'; });
}

} // namespace

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
    std::vector<std::string> mayDiffer = {"Output",
                                          "Solver/Tolerance",
                                          "Solver/Maximum iterations",
                                          "Solver/Maximum seconds",
                                          "Solver/Progress frequency",
                                          "Steps/Smallest step",
                                          "Dual operator/Expert/Rates"};
    mayDiffer.insert(mayDiffer.end(), options_.checkpoint.mayDiffer.begin(),
                     options_.checkpoint.mayDiffer.end());
    const std::string difference = scene::firstDifference(
        *Teuchos::getParametersFromXmlString(before), *Teuchos::getParametersFromXmlString(now), mayDiffer);
    if (!difference.empty())
      throw InputError(
          "the checkpoint \"" + checkpoint_->path() + "\" belongs to another deck: " + difference +
              "; restart with the deck that wrote it (tolerance, limits, rates and output may differ)",
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
    if (goesOnInSteps())
      return;
    for (const char* name : {"summary.json", "iterations.csv", "result.vtkhdf", "contact.csv", "ranks.csv"})
      io::removeFile(place(name));
    keepResults({});
    putCheckpointAside(log);
    bringResults();
  });
}

// A checkpoint may still prove to be of another problem.
bool RunDirectory::goesOnInSteps() const {
  return goesOnInPlace() && checkpoint_->holds("result files");
}

void RunDirectory::removeOtherResults(const std::vector<Written>& kept) const {
  agree(comm_, [&] {
    if (comm_.getRank() == 0)
      keepResults(kept);
  });
}

void RunDirectory::keepResults(const std::vector<Written>& kept) const {
  std::set<std::string> names;
  for (const Written& written : kept)
    names.insert(resultOf(written.step));
  for (const char* name : {"summary.json", "steps.csv", "result.vtkhdf.series"})
    io::removeFile(place(name));
  for (const auto& item : std::filesystem::directory_iterator(options_.outputDirectory)) {
    const std::string name = item.path().filename().string();
    if (isResultOfStep(name) && names.count(name) == 0)
      io::removeFile(place(name));
  }
}

void RunDirectory::bringResults() const {
  if (!checkpoint_ || goesOnInPlace())
    return;
  for (const Written& written : writtenBefore()) {
    const std::string file = options_.checkpoint.restart + "/" + resultOf(written.step);
    std::error_code error;
    std::filesystem::copy_file(file, place(resultOf(written.step)),
                               std::filesystem::copy_options::overwrite_existing, error);
    if (error)
      throw InputError("the result file \"" + file + "\" of a step before the checkpoint cannot be copied: " +
                           error.message() + "; restart into the directory of the checkpoint itself",
                       {{"file", file}});
  }
}

std::string RunDirectory::resultOf(int step) {
  std::ostringstream name;
  name << "result_" << std::setw(4) << std::setfill('0') << step << ".vtkhdf";
  return name.str();
}

void RunDirectory::exchange(qp::StateArchive<MultiVector>& archive, std::vector<Written>& written) {
  std::vector<double> values;
  for (const Written& item : written) {
    values.push_back(item.step);
    values.push_back(item.time);
  }
  archive.numbers("result files", values);
  written.clear();
  for (std::size_t k = 0; k + 1 < values.size(); k += 2)
    written.push_back({static_cast<int>(values[k]), values[k + 1]});
}

std::vector<RunDirectory::Written> RunDirectory::writtenBefore() const {
  std::vector<Written> written;
  if (checkpoint_ && checkpoint_->holds("result files"))
    checkpoint_->restore({}, [&](qp::StateArchive<MultiVector>& archive) { exchange(archive, written); });
  return written;
}

void RunDirectory::writeSeries(const std::vector<Written>& written) const {
  agree(comm_, [&] {
    if (comm_.getRank() != 0)
      return;
    nlohmann::ordered_json json;
    json["file-series-version"] = "1.0";
    json["files"] = nlohmann::ordered_json::array();
    for (const Written& item : written)
      json["files"].push_back({{"name", resultOf(item.step)}, {"time", item.time}});
    io::writeAtomically(place("result.vtkhdf.series"), json.dump(2) + "\n");
  });
}

void RunDirectory::appendStep(const StepRow& row) const {
  agree(comm_, [&] {
    if (comm_.getRank() != 0)
      return;
    const std::string path = place("steps.csv");
    std::error_code fault;
    const auto size = std::filesystem::file_size(path, fault);
    bool written = !fault; // not without the line of names
    if (written) {
      std::ofstream file(path, std::ios::app | std::ios::binary);
      file << csvLine(row) << std::flush;
      written = static_cast<bool>(file);
    }
    if (written)
      return;
    if (!fault)
      std::filesystem::resize_file(path, size, fault); // no half of a row
    throw InputError(
        "cannot append a row to the file \"" + path +
            "\"; check that it exists, that the directory is writable and that the disk is not full",
        {{"file", path}});
  });
}

void RunDirectory::writeSteps(const std::vector<StepRow>& rows, const std::vector<std::string>& paths,
                              const std::vector<std::string>& further) const {
  agree(comm_, [&] {
    if (comm_.getRank() == 0)
      io::writeAtomically(place("steps.csv"), toCsv(rows, paths, further));
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
    throw InputError("the checkpoint \"" + path + "\" of an earlier run cannot be renamed: " +
                         error.message() + "; remove it or use another output directory",
                     {{"file", path}});
  log.info("Checkpoint of an earlier run renamed to \"" + aside + "\"");
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
