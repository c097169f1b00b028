// SPDX-License-Identifier: Apache-2.0
// Implements CommandLine with CLI11.
#include "request/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>
#include <utility>

#include "messages.h"
#include "request/option_values.h"
#include "request/request.h"

namespace vdb_offset::tool {
namespace {

/// The words behind the name of a program or subcommand in reverse order, as CLI11 takes them. Words behind `--` are
/// names of files, whatever they begin with.
std::vector<std::string> reversed_arguments(int argc, const char* const* argv) {
  std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  const auto mark = std::find(arguments.begin(), arguments.end(), "--");
  if (mark != arguments.end()) {
    // CLI11 understands `--` as the end of the values of the option before it. So it is left out, and names behind it
    // become ./NAME, which does not look like an option.
    for (auto name = mark + 1; name != arguments.end(); ++name)
      if (name->starts_with('-') && *name != "-") name->insert(0, "./");
    arguments.erase(mark);
  }
  std::reverse(arguments.begin(), arguments.end());
  return arguments;
}

}  // namespace

CommandLine::CommandLine(const char* name, const char* about, const char* more, const char* help)
    : app_(std::make_unique<CLI::App>(about, name)), help_(help) {
  app_->footer(more);
}
CommandLine::~CommandLine() = default;

void CommandLine::add_version(const std::string& version) { app_->set_version_flag("-V,--version", version); }

void CommandLine::file(const char* name, const char* about, std::string& path) {
  app_->add_option(name, path, about)->required();
}

void CommandLine::option(const char* names, const char* type, const char* about, Take take) {
  Value& value = values_.emplace_back();
  value.take = std::move(take);
  value.option = app_->add_option(names, value.text, about)->type_name(type);
}

void CommandLine::option(const char* names, const char* type, const char* about, std::string& text) {
  option(names, type, about, [&text](const std::string& given) { text = given; });
}

void CommandLine::repeated(const char* names, const char* type, const char* about, Take take) {
  Value& value = values_.emplace_back();
  value.take = std::move(take);
  value.option =
      app_->add_option(names, value.texts, about)->type_name(type)->expected(1)->allow_extra_args(false)->take_all();
}

void CommandLine::flag(const char* names, const char* about, bool& is_set) { app_->add_flag(names, is_set, about); }

bool CommandLine::parse(int argc, const char* const* argv) {
  try {
    app_->parse(reversed_arguments(argc, argv));
  } catch (const CLI::Success& asked) {
    std::ostringstream text;
    app_->exit(asked, text, text);
    fmt::print(Printout(), "{}", text.str());
    return false;
  } catch (const CLI::ParseError& error) {
    throw UsageError(fmt::format("{} ({} lists the options)", error.what(), help_));
  }
  require_values();
  for (const Value& value : values_) {
    if (value.option->count() == 0) continue;
    if (value.texts.empty()) value.take(value.text);
    for (const std::string& text : value.texts) value.take(text);
  }
  return true;
}

bool CommandLine::has(const char* option) const { return app_->get_option(option)->count() > 0; }

/// \throw UsageError for an empty value: it comes from a script's empty variable, and is never intended.
void CommandLine::require_values() const {
  for (const CLI::Option* const option : app_->get_options())
    for (const std::string& value : option->results())
      require(!value.empty(), option->get_name() + ": expected a value, got ''");
}

}  // namespace vdb_offset::tool
