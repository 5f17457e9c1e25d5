// SPDX-License-Identifier: BSD-3-Clause

/// The part of ParameterSpec that writes the reference of parameters.

#include "Harmos_Errors.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_ParameterText.hpp"

#include <Teuchos_XMLParameterListCoreHelpers.hpp>

#include <algorithm>
#include <ostream>

namespace Harmos {
namespace {

// Markdown takes <...> for HTML, which it does not show.
std::string escaped(const std::string& text) {
  std::string result;
  for (char c : text)
    result += (c == '<' ? "\\" : "") + std::string(1, c);
  return result;
}

constexpr const char* orInteger = " or integer";

constexpr std::size_t lineWidth = 118, meaningColumn = 36;

// In signs, of which UTF-8 marks all bytes but the first.
std::size_t widthOf(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

// At the beginning of a line, Markdown takes these for an item of a list or for a heading.
bool isMark(const std::string& word) {
  const bool isNumber = word.size() > 1 && word.find_first_not_of("0123456789") == word.size() - 1;
  return word == "-" || word == "+" || word == "*" || word == "#" || (isNumber && word.back() == '.');
}

// The end of the word at or after this place, with the marks behind it: no line begins with one.
std::size_t endOfWord(const std::string& text, std::size_t begin) {
  std::size_t end = begin;
  do {
    end = std::min(text.find_first_not_of(' ', end), text.size());
    end = std::min(text.find(' ', end), text.size());
  } while (end < text.size() && isMark(text.substr(end + 1, text.find(' ', end + 1) - end - 1)));
  return end;
}

// Lines of whole words, the first one and the others indented by so many blanks.
std::string wrapped(const std::string& text, std::size_t first, std::size_t others) {
  std::string result, line(first, ' ');
  std::size_t empty = first;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = endOfWord(text, begin);
    const std::string word = text.substr(begin, end - begin); // with the blanks before it
    if (widthOf(line) + widthOf(word) > lineWidth && line.size() > empty) {
      result += line + "\n";
      empty = others;
      line = std::string(others, ' ') + word.substr(std::min(word.find_first_not_of(' '), word.size()));
    } else {
      line += word;
    }
    begin = end;
  }
  return result + line + "\n";
}

std::string inColumns(const std::string& name, const std::string& meaning) {
  const std::size_t used = widthOf(name) + 2;
  const std::size_t blanks = used + 2 > meaningColumn ? 2 : meaningColumn - used;
  return wrapped("  " + name + std::string(blanks, ' ') + meaning, 0, meaningColumn);
}

// Without its full stop.
std::string firstSentence(const std::string& text) {
  const std::string sentence = text.substr(0, text.find(". "));
  return sentence.substr(0, sentence.find_last_not_of('.') + 1);
}

} // namespace

bool ParameterSpec::hasRange(Type type) {
  return type == Type::Integer || type == Type::Real || type == Type::Integers || type == Type::Reals ||
         type == Type::Series;
}

std::string ParameterSpec::typeName(Type type) {
  switch (type) {
  case Type::Integer:
    return "integer";
  case Type::Real:
    return "real";
  case Type::Boolean:
    return "boolean";
  case Type::Text:
    return "string";
  case Type::Choice:
    return "choice";
  case Type::Integers:
    return "integers";
  case Type::Reals:
    return "reals";
  case Type::Series:
    return "reals, any number of them";
  case Type::Texts:
    return "strings";
  }
  return "";
}

void ParameterSpec::writeXml(std::ostream& out) const {
  Teuchos::writeParameterListToXmlOStream(*teuchosList(), out);
}

void ParameterSpec::writeMarkdown(std::ostream& out, const Parameter& parameter) {
  std::string head = "* `" + parameter.name + "`: " + typeName(parameter.type);
  if (parameter.mayBeInteger)
    head += orInteger;
  if (hasRange(parameter.type) || parameter.mayBeInteger)
    head += " in " + parameter.range.text();
  out << wrapped(head + ", default `" + defaultText(parameter) + "`. " + parameter.meaning, 0, 2);
  for (const Choice& choice : parameter.allowed)
    out << wrapped("* `" + choice.first + "`: " + choice.second, 2, 4);
}

void ParameterSpec::writeMarkdown(std::ostream& out, const std::string& path) const {
  out << (path == name_ ? "# Parameters of " : "## ") << escaped(path) << "\n\n"
      << wrapped(meaning_, 0, 0) << "\n";
  for (const Parameter& parameter : parameters_)
    writeMarkdown(out, parameter);
  if (!parameters_.empty())
    out << "\n";
  for (const auto* lists : {&lists_, &family_, &expert_})
    for (const ParameterSpec& sublist : *lists)
      sublist.writeMarkdown(out, path + "/" + sublist.name());
}

void ParameterSpec::writeMarkdown(std::ostream& out) const {
  writeMarkdown(out, name_);
}

void ParameterSpec::writeText(std::ostream& out, const Parameter& parameter) {
  out << "  " << parameter.name << " = " << defaultText(parameter) << "   [" << typeName(parameter.type)
      << (parameter.mayBeInteger ? orInteger : "");
  if (hasRange(parameter.type) || parameter.mayBeInteger)
    out << " in " << parameter.range.text();
  out << "]\n" << wrapped(parameter.meaning, 6, 6);
  for (const Choice& choice : parameter.allowed)
    out << wrapped(quoted(choice.first) + ": " + choice.second, 6, 8);
}

void ParameterSpec::writeLists(std::ostream& out, const std::string& path) const {
  out << wrapped(path + "  -- " + meaning_, 0, 4);
  for (const Parameter& parameter : parameters_)
    writeText(out, parameter);
  out << "\n";
  for (const auto* lists : {&lists_, &family_, &expert_})
    for (const ParameterSpec& sublist : *lists)
      sublist.writeLists(out, path + "/" + sublist.name());
}

void ParameterSpec::writeText(std::ostream& out) const {
  out << meaning_ << "\n\n";
  for (const Parameter& parameter : parameters_)
    writeText(out, parameter);
  for (const auto* lists : {&lists_, &expert_})
    for (const ParameterSpec& sublist : *lists)
      sublist.writeLists(out, sublist.name());
}

void ParameterSpec::writeText(std::ostream& out, const std::string& path) const {
  const ParameterSpec* spec = this;
  std::string place;
  for (std::string rest = path; !rest.empty();) {
    const std::size_t slash = rest.find('/');
    const std::string name = rest.substr(0, slash);
    rest = slash == std::string::npos ? "" : rest.substr(slash + 1);
    if (const ParameterSpec* expert = spec->expertOf(name); expert != nullptr) {
      spec = expert;
      place += std::string(expertName) + "/";
    }
    const Parameter* parameter = spec->find(name);
    if (parameter != nullptr && rest.empty()) {
      out << place << "\n";
      return writeText(out, *parameter);
    }
    const ParameterSpec* next = spec->findList(name);
    if (next == nullptr && !spec->family_.empty())
      next = &spec->family_.front();
    if (next == nullptr)
      throw InputError(spec->unknownName("list or parameter", place, name, spec->names()), {{"path", path}});
    place += next->name() + "/";
    spec = next;
  }
  spec->writeLists(out, place.substr(0, place.size() - 1));
}

std::size_t ParameterSpec::numberOfParameters() const {
  std::size_t number = parameters_.size();
  for (const auto* lists : {&lists_, &family_, &expert_})
    for (const ParameterSpec& sublist : *lists)
      number += sublist.numberOfParameters();
  return number;
}

void ParameterSpec::writeOverviewHead(std::ostream& out, const std::string& path) const {
  std::string head = path + "  -- " + firstSentence(meaning_);
  if (!expert_.empty())
    head += " (+ " + std::to_string(expert_.front().numberOfParameters()) + " in " + path + "/" + expertName +
            ")";
  out << wrapped(head, 0, 4);
}

// Lists of any names: what they are, and their parameters by name alone.
void ParameterSpec::writeOverviewOfFamily(std::ostream& out, const std::string& path) const {
  writeOverviewHead(out, path + "/" + name_);
  std::string all;
  for (const Parameter& parameter : parameters_)
    all += (all.empty() ? "" : ", ") + parameter.name;
  out << wrapped(all, 2, 2);
}

void ParameterSpec::writeOverview(std::ostream& out, const std::string& path) const {
  if (parameters_.empty() && lists_.empty() && !family_.empty())
    return family_.front().writeOverviewOfFamily(out, path);
  writeOverviewHead(out, path);
  for (const Parameter& parameter : parameters_)
    writeOverview(out, parameter);
  for (const ParameterSpec& sublist : lists_)
    if (!parameters_.empty() || sublist.family_.empty())
      sublist.writeOverview(out, path + "/" + sublist.name());
    else
      out << inColumns(sublist.name() + "/" + sublist.family_.front().name(),
                       firstSentence(sublist.family_.front().meaning()));
}

void ParameterSpec::writeOverview(std::ostream& out, const Parameter& parameter) {
  std::string choices;
  for (const Choice& choice : parameter.allowed)
    choices += (choices.empty() ? "" : " | ") + choice.first;
  if (parameter.mayBeInteger)
    choices += " | integer";
  out << inColumns(parameter.name + " = " + defaultText(parameter),
                   firstSentence(parameter.meaning) + (choices.empty() ? "" : " [" + choices + "]"));
}

void ParameterSpec::writeOverview(std::ostream& out) const {
  out << meaning_ << "\n";
  for (const Parameter& parameter : parameters_)
    writeOverview(out, parameter);
  for (const ParameterSpec& sublist : lists_) {
    out << "\n";
    sublist.writeOverview(out, sublist.name());
  }
}

} // namespace Harmos
