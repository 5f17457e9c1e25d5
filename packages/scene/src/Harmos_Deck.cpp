// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Deck.hpp"

#include "Harmos_Agreement.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_XMLParameterListCoreHelpers.hpp>
#include <Teuchos_YamlParameterListCoreHelpers.hpp>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace Harmos::scene {
namespace {

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Teuchos' messages begin with file, line and failed condition of its own source: what helps comes last.
std::string lastSentence(const std::string& message) {
  std::istringstream lines(message);
  std::string line, last;
  while (std::getline(lines, line))
    if (line.find_first_not_of(" \t\r") != std::string::npos)
      last = line.substr(line.find_first_not_of(" \t\r"));
  return last;
}

Teuchos::ParameterList parse(const std::string& file) {
  if (std::filesystem::is_directory(file))
    throw InputError("the deck \"" + file + "\" is a directory; name an XML or YAML file", {{"file", file}});
  std::ifstream stream(file);
  if (!stream)
    throw InputError("the deck \"" + file + "\" cannot be read: " + std::strerror(errno) +
                         "; check the path, it is relative to the directory the program was started in",
                     {{"file", file}});
  std::ostringstream text;
  text << stream.rdbuf();
  Teuchos::ParameterList list;
  try {
    if (endsWith(file, ".yaml") || endsWith(file, ".yml"))
      list = *Teuchos::getParametersFromYamlString(text.str());
    else
      Teuchos::updateParametersFromXmlString(text.str(), Teuchos::ptr(&list));
  } catch (const std::exception& error) {
    throw InputError("the deck \"" + file +
                         "\" is not a well-formed ParameterList: " + lastSentence(error.what()),
                     {{"file", file}});
  }
  return list;
}

} // namespace

Teuchos::ParameterList readDeck(const Teuchos::Comm<int>& comm, const std::string& file,
                                const std::vector<std::string>& assignments, const ParameterSpec& spec) {
  std::string text;
  agree(comm, [&] {
    if (comm.getRank() != 0)
      return;
    Teuchos::ParameterList list = parse(file);
    std::string source = file;
    for (const std::string& assignment : assignments) {
      const std::size_t sign = assignment.find('=');
      if (sign == std::string::npos || sign == 0)
        throw InputError("--set \"" + assignment + "\" is not of the form \"List/Name=value\"");
      spec.set(list, assignment.substr(0, sign), assignment.substr(sign + 1), "--set");
    }
    if (!assignments.empty())
      source += " with --set";
    std::ostringstream stream;
    Teuchos::writeParameterListToXmlOStream(spec.validated(list, source), stream);
    text = stream.str();
  });
  int size = static_cast<int>(text.size());
  Teuchos::broadcast<int, int>(comm, 0, 1, &size);
  text.resize(static_cast<std::size_t>(size));
  Teuchos::broadcast<int, char>(comm, 0, size, text.data());
  Teuchos::ParameterList list;
  Teuchos::updateParametersFromXmlString(text, Teuchos::ptr(&list));
  return list;
}

} // namespace Harmos::scene
