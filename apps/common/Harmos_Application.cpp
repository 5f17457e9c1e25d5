// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Application.hpp"

#include "Harmos_AdaptiveRounds.hpp"
#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_CheckpointFile.hpp"
#include "Harmos_Deck.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_MpiStart.hpp"
#include "Harmos_Pipeline.hpp"
#include "Harmos_ProcessMemory.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_Signals.hpp"
#include "Harmos_Terminal.hpp"
#include "Harmos_Version.hpp"

#include <CLI/CLI.hpp>
#include <Teuchos_XMLParameterListHelpers.hpp>
#include <Tpetra_Core.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <optional>
#include <sstream>

namespace Harmos::app {
namespace {

constexpr int exitConverged = 0, exitNotConverged = 1, exitBadInput = 2, exitInternalError = 3,
              exitInterrupted = 4;

int exitStatus(const Error& error) {
  switch (error.kind()) {
  case Error::Kind::Input:
    return exitBadInput;
  case Error::Kind::Numerical:
    return exitNotConverged;
  case Error::Kind::Internal:
    return exitInternalError;
  }
  return exitInternalError;
}

void addPlanOptions(CLI::App& cli, CommandLine& line) {
  plan::PlanRequest& request = line.planRequest;
  CLI::Option* plan = cli.add_flag(
      "--plan", line.plan,
      "Recommend ranks and memory without solving, then exit; with --output also write DIR/plan.json");
  cli.add_option("--plan-ranks", request.ranks, "Numbers of ranks to compare, e.g. 1,2,4")
      ->type_name("LIST")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->needs(plan);
  cli.add_option("--plan-memory", request.memoryMiB, "Memory limit per rank")
      ->type_name("MIB")
      ->check(CLI::PositiveNumber)
      ->needs(plan);
  cli.add_option("--plan-rates", request.ratesFile,
                 "JSON file with the rates of this machine, see docs/clusters.md")
      ->type_name("FILE")
      ->needs(plan);
}

// The word behind --print-parameters is a format, a list or parameter, or the deck. Returns what is wrong.
std::string readPrintWord(const ParameterSpec& spec, CommandLine& line) {
  std::string& word = line.printParameters;
  if (word.empty())
    word = "text";
  const std::vector<std::string> formats = {"text", "all", "xml", "markdown"};
  if (std::find(formats.begin(), formats.end(), word) != formats.end())
    return "";
  try {
    std::ostringstream ignored;
    spec.writeText(ignored, word);
    return "";
  } catch (const InputError& error) {
    const std::string ending = std::filesystem::path(word).extension();
    const bool isDeck = ending == ".xml" || ending == ".yaml" || ending == ".yml";
    if (!isDeck || !line.deck.empty())
      return word + " not in {all,text,xml,markdown}: " + error.what();
  }
  line.deck = word;
  word = "text";
  return "";
}

// Every rank parses the same arguments and comes to the same end; rank 0 speaks. Returns an exit status, or
// nothing if the run is to go on.
std::optional<int> parse(int argc, char** argv, const Program& program, bool speaks, CommandLine& line) {
  CLI::App cli(program.description, program.name);
  cli.add_option("deck", line.deck, "Deck: a ParameterList in XML or YAML")->type_name("DECK");
  cli.add_option("--set", line.assignments, "Override a parameter of the deck: \"List/Sublist/Name=value\"")
      ->type_name("PATH=VALUE")
      ->expected(1)
      ->take_all();
  cli.add_option("--output", line.output, "Directory for the results")->type_name("DIR");
  if (program.restarts)
    cli.add_option("--restart", line.restart,
                   "Continue from the checkpoint in the output directory of an earlier run; if no deck is "
                   "given, its deck and overrides are used")
        ->type_name("DIR");
  cli.add_flag("--check", line.check, "Validate the deck, its meshes, materials and contacts, then exit");
  if (program.showsParts)
    cli.add_flag("--parts", line.parts,
                 "List the boundary parts available to effects, then exit; with --output also write "
                 "DIR/parts.vtkhdf for harmos-plot --parts");
  if (program.plans)
    addPlanOptions(cli, line);
  cli.add_option("--print-parameters", line.printParameters,
                 "Print the public parameters, one list or parameter in full, or all of them, then exit")
      ->type_name("LIST|all|xml|markdown")
      ->expected(0, 1)
      ->default_str("text");
  if (program.effects != nullptr)
    cli.add_flag("--list-effects", line.listEffects,
                 "Print the available effects with their parameters, then exit");
  cli.add_flag("--quiet", line.quiet, "Print errors only");
  cli.add_flag("--version", line.version, "Print the version, then exit");
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool isHelp = error.get_exit_code() == 0;
    if (speaks) {
      if (isHelp)
        std::cout << cli.help();
      else
        std::cerr << "error: command line: " << error.what() << "\nUsage: " << program.name
                  << " [OPTIONS] DECK; see --help\n";
    }
    return isHelp ? exitConverged : exitBadInput;
  }
  if (cli.count("--print-parameters") == 0)
    return std::nullopt;
  const std::string fault = readPrintWord(program.deckSpec(), line);
  if (fault.empty())
    return std::nullopt;
  if (speaks)
    std::cerr << "error: command line: --print-parameters: " << fault << "\n";
  return exitBadInput;
}

void printParameters(const ParameterSpec& spec, const std::string& word) {
  if (word == "xml")
    spec.writeXml(std::cout);
  else if (word == "markdown")
    spec.writeMarkdown(std::cout);
  else if (word == "all")
    spec.writeText(std::cout);
  else if (word != "text")
    spec.writeText(std::cout, word);
  else {
    spec.writeOverview(std::cout);
    std::cout << "\nIn full, with types, ranges and choices: --print-parameters LIST, a path from above; all "
                 "lists: "
                 "--print-parameters\nall; a deck with all defaults: --print-parameters xml.\n";
  }
}

// Ends a run of which only this rank knows that it failed: the others may wait for it for ever.
int abortAll(const Teuchos::Comm<int>& comm, const std::string& message) {
  std::cerr << "error: rank " << comm.getRank() << ": " << message << std::endl;
  if (comm.getSize() > 1)
    MPI_Abort(MPI_COMM_WORLD, exitInternalError);
  return exitInternalError;
}

int planDeck(const ProgramContext& context, const scene::Scene& scene, const run::RunOptions& options,
             const plan::PlanRequest& request) {
  const plan::RunPlan plan = plan::makeRunPlan(context.comm, scene, options, request);
  context.log.info(plan::planText(plan));
  agree(*context.comm, [&] {
    if (context.line.output.empty() || context.comm->getRank() != 0)
      return;
    io::makeDirectory(context.line.output);
    io::writeAtomically(context.line.output + "/plan.json", plan::planJson(plan, context.line.deck));
  });
  return exitConverged;
}

// Where a step has been written.
std::string seriesOf(const std::string& directory) {
  const std::string name = "result.vtkhdf.series";
  return std::filesystem::exists(directory + "/" + name) ? ", " + name : "";
}

} // namespace

void leaveSummary(const ProgramContext& context, const run::RunOptions& options, run::RunReport& report,
                  const Error& error) {
  report.converged = false;
  report.reason = error.what();
  try {
    if (standsAlone(*context.comm, error)) // the others may be waiting for something else
      run::writeSummaryAlone(options, report);
    else
      run::writeSummary(*context.comm, options, report);
  } catch (const Error& second) {
    // The first error is the one that matters; the same fault is not told twice.
    if (second.data() != error.data())
      context.log.warning(second.what());
  }
}

// What the run that this one goes on with has chosen. Collective.
std::map<std::string, int> chosenBefore(const Teuchos::Comm<int>& comm, const std::string& restart) {
  std::map<std::string, int> chosen;
  if (restart.empty())
    return chosen;
  std::istringstream stored(run::CheckpointReader(comm, run::checkpointPath(restart)).text("subdomains"));
  for (std::string body, number; std::getline(stored, body, '\0') && std::getline(stored, number, '\0');)
    chosen[body] = std::stoi(number);
  return chosen;
}

namespace {

run::RunOptions optionsOf(const Teuchos::ParameterList& deck, const CommandLine& line) {
  run::RunOptions options = run::RunOptions::fromDeck(deck);
  if (!line.output.empty())
    options.outputDirectory = line.output;
  std::ostringstream text;
  Teuchos::writeParameterListToXmlOStream(deck, text);
  options.checkpoint.deck = text.str();
  options.checkpoint.deckFile = std::filesystem::absolute(line.deck).string(); // from any directory
  options.checkpoint.assignments = line.assignments;
  options.checkpoint.restart = line.restart;
  options.checkpoint.told = Signals::told;
  return options;
}

// What is asked for in the place of a run; nothing if that is. @param programMiB before the scene was made.
std::optional<int> lookOnly(const ProgramContext& context, const scene::Scene& scene,
                            const run::RunOptions& options, double programMiB) {
  const CommandLine& line = context.line;
  if (line.check) {
    run::checkScene(*context.comm, scene);
    if (!line.restart.empty())
      const run::CheckpointReader readable(*context.comm, run::checkpointPath(line.restart));
    context.log.info("The deck \"" + line.deck + "\" is valid.");
    return exitConverged;
  }
  if (!line.plan)
    return std::nullopt;
  plan::PlanRequest planRequest = line.planRequest;
  planRequest.programMiB = programMiB;
  return planDeck(context, scene, options, planRequest);
}

// The run, and what the application and adaptation make of it.
void solveScene(const Application& application, const ProgramContext& context,
                const Teuchos::ParameterList& deck, const scene::Scene& scene, const run::RunOptions& options,
                AdaptiveRounds& rounds, run::RunReport& report) {
  const auto& [comm, line, log, begin] = context;
  report.deck = line.deck;
  try {
    const run::Solution solution = run::runScene(comm, scene, options, log, begin, report);
    // Steps that failed leave a state of no load that the deck tells of.
    const bool isAtEnd = report.converged || !scene.timeline.hasSteps();
    if (application.evaluate && isAtEnd && !report.isInterrupted()) {
      application.evaluate(*comm, deck, report);
      for (const auto& [name, value] : report.results)
        log.info(name + ": " + scientific(value, 6));
    }
    if (rounds.isAsked() && !report.isInterrupted())
      log.info(rounds.judge(scene, solution, report));
  } catch (const Error& error) {
    leaveSummary(context, options, report, error);
    throw;
  } catch (const std::exception& error) { // of a library, or no memory is left
    const InternalError unexpected(error.what());
    leaveSummary(context, options, report, unexpected);
    throw;
  }
  run::writeSummary(*comm, options, report);
}

int tellEnd(const Log& log, const run::RunOptions& options, const run::RunReport& report, bool hasSteps) {
  log.info("Results in \"" + options.outputDirectory + "\": summary.json, iterations.csv" +
           (report.isInterrupted() ? ", checkpoint.h5" : "") + (hasSteps ? ", steps.csv" : "") +
           (!options.writeFields      ? ""
            : hasSteps                ? seriesOf(options.outputDirectory)
            : !report.isInterrupted() ? ", result.vtkhdf"
                                      : ""));
  if (report.isInterrupted() && report.checkpointFault.empty()) {
    log.warning(report.reason);
    return exitInterrupted;
  }
  if (!report.converged)
    log.error("the solver did not converge: " + report.reason);
  return report.converged ? exitConverged : exitNotConverged;
}

// The scene of a round. Of a later one a failure, as of the mesher, leaves what there is: nothing.
std::optional<scene::Scene> sceneOfRound(const Application& application, const ProgramContext& context,
                                         const Teuchos::ParameterList& deck, const AdaptiveRounds& rounds) {
  const auto& [comm, line, log, begin] = context;
  const auto start = std::chrono::steady_clock::now();
  try {
    scene::Scene scene = sceneOf(application, {*comm, deck, directoryOf(line.deck), log,
                                               chosenBefore(*comm, line.restart), rounds.sizes()});
    scene.secondsToMake = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return scene;
  } catch (const Error& error) {
    if (!rounds.hasResults() || standsAlone(*comm, error))
      throw;
    log.warning(std::string("no mesh for another round: ") + error.what() +
                "; the answer is that of the round before");
    return std::nullopt;
  }
}

} // namespace

int runDeck(const Application& application, const ProgramContext& context) {
  const auto& [comm, line, log, begin] = context;
  const Teuchos::ParameterList deck = readDeck(context, deckSpec(application));
  run::RunOptions options = optionsOf(deck, line);
  AdaptiveRounds rounds(comm, deck);
  rounds.setOptions(options);
  const double programMiB = run::peakMemoryMiB();
  run::RunReport report;
  bool hasSteps = false;
  while (!rounds.isOver()) {
    rounds.begin();
    const std::optional<scene::Scene> scene = sceneOfRound(application, context, deck, rounds);
    if (!scene)
      break;
    options.checkpoint.subdomains = scene->chosenSubdomains;
    if (line.parts) {
      run::showParts(*comm, *scene, line.output, log);
      return exitConverged;
    }
    run::checkConsistency(*scene, options);
    rounds.check(*scene, options);
    if (const std::optional<int> status = lookOnly(context, *scene, options, programMiB))
      return *status;
    if (rounds.isAsked() && !rounds.mayGoOn(*scene, options, log, programMiB))
      break;
    report = {};
    hasSteps = scene->timeline.hasSteps();
    solveScene(application, context, deck, *scene, options, rounds, report);
    if (!rounds.isAsked() || report.isInterrupted())
      break;
    rounds.write(options.outputDirectory);
  }
  return tellEnd(log, options, report, hasSteps);
}

Teuchos::ParameterList readDeck(const ProgramContext& context, const ParameterSpec& spec) {
  std::vector<std::string> notes;
  const Teuchos::ParameterList deck =
      scene::readDeck(*context.comm, context.line.deck, context.line.assignments, spec, &notes);
  for (const std::string& note : notes)
    context.log.info("Note: " + note);
  return deck;
}

scene::Scene sceneOf(const Application& application, const DeckContext& context) {
  scene::Timeline timeline = scene::Timeline::fromDeck(context.deck);
  scene::Scene scene = application.makeScene(context);
  timeline.followAsIn(scene.timeline);
  scene.timeline = std::move(timeline);
  if (scene.iterates())
    scene.timeline.bringUp();
  return scene;
}

ParameterSpec deckSpec(const Application& application) {
  ParameterSpec spec(application.name, "Deck of " + application.name + ": " + application.description);
  application.addParameters(spec);
  run::RunOptions::addTo(spec, application.mayBeTransient);
  if (application.mayAdapt)
    addAdaptivityTo(spec);
  return spec;
}

bool standsAlone(const Teuchos::Comm<int>& comm, const Error& error) {
  return comm.getSize() > 1 && error.kind() == Error::Kind::Internal && !error.isAgreed();
}

std::string directoryOf(const std::string& file) {
  const std::size_t slash = file.rfind('/');
  return slash == std::string::npos ? "./" : file.substr(0, slash + 1);
}

namespace {

// The words of the command line, of which Kokkos sees those without --help: it would answer with forty lines
// of its own on every rank. Kokkos takes its own words away.
class Words {
 public:
  Words(int argc, char** argv) : all_(argv, argv + argc) {
    std::copy_if(all_.begin(), all_.end(), std::back_inserter(shown_),
                 [](const char* word) { return !asksForHelp(word); });
    count = static_cast<int>(shown_.size());
    shown_.push_back(nullptr);
    data = shown_.data();
  }
  Words(const Words&) = delete;
  Words& operator=(const Words&) = delete;

  int count;
  char** data;

  /// Those that were not taken away, in their order.
  std::vector<char*> left() const {
    std::vector<char*> words;
    for (char* word : all_)
      if (asksForHelp(word) || std::find(data, data + count, word) != data + count) // the same pointer
        words.push_back(word);
    return words;
  }

 private:
  static bool asksForHelp(const std::string& word) { return word.rfind("--help", 0) == 0 || word == "-h"; }

  std::vector<char*> all_, shown_;
};

} // namespace

int main(int argc, char** argv, const Program& program) {
  Words words(argc, argv);
  prepareMpiStart();
  const Tpetra::ScopeGuard guard(&words.count, &words.data);
  const auto begin = std::chrono::steady_clock::now();
  const Teuchos::RCP<const Teuchos::Comm<int>> comm = Tpetra::getDefaultComm();
  const bool speaks = comm->getRank() == 0;
  CommandLine line;
  std::vector<char*> left = words.left();
  if (const std::optional<int> status =
          parse(static_cast<int>(left.size()), left.data(), program, speaks, line))
    return *status;
  Log log(std::cout, std::cerr, line.quiet ? Log::Verbosity::Quiet : Log::Verbosity::Normal, speaks);
  // From here on: what tells a run to stop is not to end it without a checkpoint.
  std::optional<Signals> signals;
  if (program.restarts && !line.check && !line.plan && !line.parts)
    signals.emplace();
  try {
    if (line.version) {
      if (speaks)
        std::cout << program.name << " (Harmos) " << version() << " " << gitHash() << "\n";
      return exitConverged;
    }
    if (line.listEffects) {
      if (speaks)
        program.effects->write(std::cout);
      return exitConverged;
    }
    if (!line.printParameters.empty()) {
      if (speaks)
        printParameters(program.deckSpec(), line.printParameters);
      return exitConverged;
    }
    if (line.deck.empty() && !line.restart.empty()) {
      const run::CheckpointReader checkpoint(*comm, run::checkpointPath(line.restart));
      line.deck = checkpoint.text("deck file");
      std::istringstream stored(checkpoint.text("assignments"));
      std::vector<std::string> assignments;
      for (std::string assignment; std::getline(stored, assignment, '\0');)
        assignments.push_back(assignment);
      line.assignments.insert(line.assignments.begin(), assignments.begin(), assignments.end());
    }
    if (line.output.empty() && !line.plan && !line.parts)
      line.output = line.restart;
    if (const int width = speaks ? terminalWidth() : 0; width > 0)
      log.showStatus(width);
    if (line.deck.empty())
      throw InputError("command line: no deck given; usage: " + program.name + " [OPTIONS] DECK");
    log.info("Harmos " + version() + " (" + gitHash() + "), " + program.name + " \"" + line.deck + "\"");
    return program.run({comm, line, log, begin});
  } catch (const Error& error) {
    if (standsAlone(*comm, error))
      return abortAll(*comm, error.what());
    log.error(error.what());
    return exitStatus(error);
  } catch (const std::exception& error) {
    return abortAll(*comm, error.what());
  }
}

int main(int argc, char** argv, const Application& application) {
  Program program;
  program.name = application.name;
  program.description = application.description;
  program.deckSpec = [&] { return deckSpec(application); };
  program.effects = application.effects;
  program.restarts = true;
  program.plans = true;
  program.showsParts = true;
  program.run = [&](const ProgramContext& context) { return runDeck(application, context); };
  return main(argc, argv, program);
}

} // namespace Harmos::app
