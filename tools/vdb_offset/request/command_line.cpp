// SPDX-License-Identifier: Apache-2.0
// Implements CommandLine with CLI11.
#include "request/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <numeric>
#include <sstream>
#include <utility>

#include "messages.h"
#include "request/config_file.h"
#include "request/option_values.h"
#include "request/presets.h"
#include "request/request.h"
#include "request/units.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

// Options whose values are lengths. The unit of the first of these that has one is that of what is printed.
constexpr const char* kLengths[] = {"distance",     "distance-xy",     "distance-z",  "inner",         "clearance",
                                    "first-height", "total-thickness", "last-height", "voxel-size",    "tolerance",
                                    "weld",         "flatten",         "deflection",  "fit-tolerance", "blend",
                                    "fill-max"};

// What other programs call it, and the option that is meant.
constexpr std::pair<const char*, const char*> kCalledOtherwise[] = {{"--offset", "--distance"},
                                                                    {"--thickness", "--distance"},
                                                                    {"--amount", "--distance"},
                                                                    {"--join", "--corners"},
                                                                    {"--hollow", "--shell"}};

/// The one of several names that a word most likely stands for: that begins with it, or else differs from it by few
/// letters.
class NearestName {
 public:
  explicit NearestName(std::string_view word) : word_(word) {}

  void offer(std::string_view name) {
    const std::pair far(!name.starts_with(word_), edits_between(word_, name));
    if (far >= far_) return;
    far_ = far;
    name_ = name;
  }
  /// Whatever else has been offered.
  void take(std::string_view name) { name_ = name; }
  /// Empty if there is none.
  const std::string& name() const { return name_; }

 private:
  std::string_view word_;
  std::pair<bool, std::size_t> far_{true, kMostEdits + 1};  // whether it begins otherwise, and how many letters differ
  std::string name_;
};

// In the place of a preset's name.
constexpr const char* kAllPresets = "help";

/// The words behind the name of a program or subcommand in reverse order, as CLI11 takes them. Words behind `--` are
/// names of files, whatever they begin with.
std::vector<std::string> reversed_arguments(const CLI::App& app, int argc, const char* const* argv) {
  constexpr std::size_t kShortAndSign = 3;  // letters of -d=
  std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  const auto mark = std::find(arguments.begin(), arguments.end(), "--");
  if (mark != arguments.end()) {
    // CLI11 understands `--` as the end of the values of the option before it. So it is left out, and names behind it
    // become ./NAME, which does not look like an option.
    for (auto name = mark + 1; name != arguments.end(); ++name)
      if (name->starts_with('-') && *name != "-") name->insert(0, "./");
    arguments.erase(mark);
  }
  // -d=1 is -d 1: CLI11 has the sign for a part of the value.
  for (std::string& word : arguments)
    if (word.size() > kShortAndSign && word[0] == '-' && word[1] != '-' && word[2] == '=')
      if (const CLI::Option* const option = app.get_option_no_throw(word.substr(0, 2));
          option && option->get_expected_max() > 0)
        word.erase(2, 1);
  std::reverse(arguments.begin(), arguments.end());
  return arguments;
}

}  // namespace

std::size_t edits_between(std::string_view one, std::string_view other) {
  std::vector<std::size_t> row(other.size() + 1), before;  // for the letters of `one` so far
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (const char letter : one) {
    before = row;
    ++row[0];
    for (std::size_t i = 0; i < other.size(); ++i)
      row[i + 1] = std::min({before[i] + (letter != other[i]), before[i + 1] + 1, row[i] + 1});
  }
  return row.back();
}

CommandLine::CommandLine(const char* name, const char* about, const char* more, const char* help)
    : app_(std::make_unique<CLI::App>(about, name)), help_(help), more_of_all_(more), more_of_first_(more) {
  app_->set_help_flag("-h,--help", "Print this and exit");
}
CommandLine::~CommandLine() = default;

void CommandLine::add_version(const std::string& version) { app_->set_version_flag("-V,--version", version); }

void CommandLine::file(const char* name, const char* about, std::string& path) {
  app_->add_option(name, path, about)->required();
}

void CommandLine::file_or_none(const char* name, const char* about, std::string& path) {
  app_->add_option(name, path, about);
}

std::optional<std::string> CommandLine::given_besides(std::span<const char* const> known) const {
  for (const CLI::Option* const option : app_->get_options())
    if (option->count() > 0 && !option->get_positional() &&
        std::find(known.begin(), known.end(), "--" + option->get_lnames().front()) == known.end())
      return "--" + option->get_lnames().front();
  return std::nullopt;
}

void CommandLine::option(const char* names, const char* type, const char* about, Take take) {
  Value& value = values_.emplace_back();
  value.take = std::move(take);
  value.option = app_->add_option(names, value.text, about)->type_name(type);
  place(value.option);
}

void CommandLine::option(const char* names, const char* type, const char* about, std::string& text) {
  option(names, type, about, [&text](const std::string& given) { text = given; });
}

void CommandLine::repeated(const char* names, const char* type, const char* about, Take take) {
  Value& value = values_.emplace_back();
  value.take = std::move(take);
  value.option =
      app_->add_option(names, value.texts, about)->type_name(type)->expected(1)->allow_extra_args(false)->take_all();
  place(value.option);
}

void CommandLine::flag(const char* names, const char* about, bool& is_set) {
  place(app_->add_flag(names, is_set, about));
}

void CommandLine::arrange_help(std::span<const HelpTopic> topics, std::vector<std::string> options, std::string more) {
  topics_ = topics;
  first_options_ = std::move(options);
  more_of_first_ = "\nMore options, by topic:\n";
  const auto is_there = [this](const std::string& name) { return app_->get_option_no_throw("--" + name) != nullptr; };
  for (const HelpTopic& topic : topics)
    if (std::ranges::any_of(topic.options, is_there))
      more_of_first_ += fmt::format("  {:<27} {}\n", fmt::format("--help {}", topic.name), topic.title);
  more_of_first_ += fmt::format("  {:<27} All of them\n{}", "--help all", more);
}

void CommandLine::list_for(const std::string& topic) {
  for (const HelpTopic& each : topics_)
    for (const std::string& name : each.options)
      if (CLI::Option* const option = app_->get_option_no_throw("--" + name))
        option->group(topic == "all" || topic == each.name || topic == name ? each.title : "");
  if (!topic.empty()) return;
  for (const std::string& name : first_options_) app_->get_option("--" + name)->group("Options");
}

std::string CommandLine::topic_of(std::string word) const {
  while (word.starts_with('-')) word.erase(0, 1);
  const auto is_listed = [&](const std::string& name) {
    return std::ranges::any_of(topics_,
                               [&](const HelpTopic& each) { return std::ranges::count(each.options, name) > 0; });
  };
  for (const CLI::Option* const option : app_->get_options()) {
    if (option->get_lnames().empty()) continue;
    const std::string& name = option->get_lnames().front();
    if (is_listed(name) && (name == word || std::ranges::count(option->get_snames(), word) > 0)) return name;
  }
  return word == "all" || std::ranges::any_of(topics_, [&](const HelpTopic& each) { return each.name == word; }) ? word
                                                                                                                 : "";
}

std::string CommandLine::meant_by(std::string word) const {
  while (word.starts_with('-')) word.erase(0, 1);
  NearestName nearest(word);
  for (const HelpTopic& each : topics_) {
    nearest.offer(each.name);
    for (const std::string& name : each.options)
      if (app_->get_option_no_throw("--" + name)) nearest.offer(name);
  }
  return nearest.name();
}

bool CommandLine::answer_help(const std::vector<std::string>& reversed) {
  const auto asked = std::find_if(reversed.rbegin(), reversed.rend(),
                                  [](const std::string& word) { return word == "-h" || word == "--help"; });
  if (asked == reversed.rend()) return false;
  const std::string word = asked + 1 == reversed.rend() ? "" : asked[1], topic = topic_of(word);
  // What is neither a topic nor an option is a file where there is more, and on a line of its own a mistake.
  if (reversed.size() == 2 && asked == reversed.rbegin() && !topics_.empty() && topic.empty()) {
    std::string topics;
    for (const HelpTopic& each : topics_) topics += fmt::format("{}, ", each.name);
    const std::string meant = meant_by(word);
    throw UsageError(fmt::format("--help: expected {}all or the name of an option, got '{}'{}", topics, word,
                                 meant.empty() ? "" : fmt::format("; did you mean --help {}?", meant)));
  }
  list_for(topic);
  app_->footer(topic.empty() ? more_of_first_ : topic == "all" ? more_of_all_ : "");
  fmt::print(Printout(), "{}", app_->help());
  return true;
}

void CommandLine::place(CLI::Option* option) {
  if (!hidden_) return;
  option->group("");
  hidden_options_.push_back(option);
}

void CommandLine::add_config(std::vector<std::vector<std::string>> alternatives, std::vector<std::string> passed_over,
                             std::vector<std::string> kept_out) {
  alternatives_ = std::move(alternatives);
  passed_over_ = std::move(passed_over);
  kept_out_ = std::move(kept_out);
  app_->add_option("--config", config_,
                   "Take options from FILE, too, in TOML by their long names, as in 'distance = \"1%\"' and 'strict = "
                   "true'; what is given here counts instead")
      ->type_name("FILE");
  const auto take = [this](const std::string& name) {
    preset_ = name;
    if (name == kAllPresets) throw CLI::Success();
  };
  app_->add_option_function<std::string>(
          "--preset", take,
          "Options for a purpose: 'part', 'scan', 'fit', 'hollow', 'kerf' or 'layers'; 'help' shows what each "
          "of them is. What is given here, or in a file of --config, counts instead")
      ->type_name("NAME");
}

/// False if the line asked only for help or the version, which are then printed.
bool CommandLine::understand(std::vector<std::string> reversed) {
  try {
    app_->parse(std::move(reversed));
    return true;
  } catch (const CLI::Success& asked) {
    std::ostringstream text;
    app_->exit(asked, text, text);
    fmt::print(Printout(), "{}", preset_ == kAllPresets ? presets_in_words() : text.str());
    return false;
  } catch (const CLI::ParseError& error) {
    require_known_options();
    throw UsageError(fmt::format("{} ({} lists the options)", error.what(), help_));
  }
}

/// \throw UsageError for a word that looks like an option and is none, with the one that is meant
void CommandLine::require_known_options() const {
  for (const std::string& word : app_->remaining()) {
    const std::string unit = unit_meant_by(word);
    require(unit.empty(), fmt::format("{}: expected the unit without a space, as in 0.2{}", word, unit));
    if (!word.starts_with('-') || word == "-") continue;
    const std::string name = word.substr(0, word.find('='));
    NearestName nearest(name);
    for (const CLI::Option* const option : app_->get_options())
      for (const std::string& known : option->get_lnames()) nearest.offer("--" + known);
    for (const auto& [called, option] : kCalledOtherwise)
      if (called == name && app_->get_option_no_throw(option)) nearest.take(option);
    const std::string& meant = nearest.name();
    throw UsageError(meant.empty() ? fmt::format("unknown option {} ({} lists the options)", name, help_)
                                   : fmt::format("unknown option {}; did you mean {}?", name, meant));
  }
}

std::vector<std::string> CommandLine::words_of(const std::vector<ConfigEntry>& entries) const {
  const auto is_among = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const auto has_alternative = [&](const std::string& name) {
    return std::ranges::any_of(alternatives_, [&](const std::vector<std::string>& set) {
      return is_among(set, name) &&
             std::ranges::any_of(set, [this](const std::string& other) { return has(("--" + other).c_str()); });
    });
  };
  std::vector<std::string> words;
  for (const ConfigEntry& entry : entries) {
    require(!is_among(kept_out_, entry.name),
            fmt::format("{}: {}: expected on the command line alone, as a file may come from somebody else",
                        entry.place, entry.name));
    if (is_among(passed_over_, entry.name) || has_alternative(entry.name)) continue;
    const CLI::Option* const option = app_->get_option_no_throw("--" + entry.name);
    const bool is_known = option && option->get_positional() == false && entry.name != "config" &&
                          entry.name != "help" && entry.name != "version";
    require(is_known, fmt::format("{}: expected the long name of an option, got '{}'", entry.place, entry.name));
    const bool is_flag = option->get_expected_max() == 0;
    require(is_flag == entry.is_switch, fmt::format("{}: {}: expected {}", entry.place, entry.name,
                                                    is_flag ? "true or false" : "a value, not true or false"));
    if (option->count() > 0) continue;
    if (entry.is_on) words.push_back("--" + entry.name);
    for (const std::string& value : entry.values) {
      require(!value.empty(), fmt::format("{}: {}: expected a value, got ''", entry.place, entry.name));
      words.push_back("--" + entry.name + "=" + value);
    }
  }
  return words;
}

void CommandLine::add_unit(std::string& unit, const std::string& input, Lengths& lengths) {
  unit_ = &unit;
  lengths_ = &lengths;
  measured_ = &input;
  option("--unit", "UNIT",
         "What the numbers of the file are: 'um', 'mm', 'cm', 'm', 'in' or 'ft'; then distances and other lengths may "
         "have a unit, as in 0.2mm [the file's own, if it states one]",
         [&unit](const std::string& text) {
           const std::string meant = unit_meant_by(text);
           require(micrometres_of(text).has_value(),
                   fmt::format("--unit: expected 'um', 'mm', 'cm', 'm', 'in' or 'ft', got '{}'{}", text,
                               meant.empty() ? "" : fmt::format("; did you mean {}?", meant)));
           unit = text;
         });
}

namespace {

/// The unit that a file states for its numbers, if it does. `format` is that of files with other endings; may be empty.
/// \throw ReadError, InvalidInput as its reader
std::optional<double> unit_of_file(const std::string& path, const std::string& format) {
  std::error_code unknown;
  // Of a folder of models, each is asked when its turn comes.
  if (path.empty() || std::filesystem::is_directory(path, unknown)) return micrometres_of("mm");
  const auto known = io::format_of(path) ? io::format_of(path) : io::format_of("." + format);
  if (known == io::Format::Glb || known == io::Format::Gltf) return io::unit_micrometres(path, known);
  // What is no file can be read once.
  if (std::filesystem::exists(path, unknown) && !std::filesystem::is_regular_file(path, unknown)) return std::nullopt;
  if (known) return path == "-" ? std::nullopt : io::unit_micrometres(path, known);
  return io::curve_format_of(path) ? io::unit_of_curves(path) : std::nullopt;
}

}  // namespace

std::string CommandLine::text_of(const CLI::Option& option, const std::string& given) {
  const std::string& name = option.get_lnames().front();
  const auto number = static_cast<std::size_t>(std::find(std::begin(kLengths), std::end(kLengths), name) - kLengths);
  const bool is_of_part = name == "distance-of" || name == "layers-of";
  if (!unit_ || (number == std::size(kLengths) && !is_of_part)) return given;
  const auto file_unit = [this] {
    if (!unit_->empty()) return micrometres_of(*unit_);
    const CLI::Option* const format = app_->get_option_no_throw("--format");
    return unit_of_file(*measured_, format && format->count() > 0 ? format->results().front() : std::string());
  };
  const std::size_t at = is_of_part ? given.rfind(':') + 1 : 0;
  std::optional<Lengths> found;
  std::string text = given.substr(0, at) + in_file_units("--" + name, given.substr(at), *measured_, file_unit, found);
  if (found && number < lengths_by_) {
    *lengths_ = *found;
    lengths_by_ = number;
  }
  return text;
}

bool CommandLine::parse(int argc, const char* const* argv) {
  std::vector<std::string> reversed = reversed_arguments(*app_, argc, argv);
  if (answer_help(reversed)) return false;
  if (!understand(reversed)) return false;
  require_values();
  const auto add = [&](const std::vector<ConfigEntry>& entries) {
    const std::vector<std::string> more = words_of(entries);
    reversed.insert(reversed.begin(), more.rbegin(), more.rend());
    for (Value& value : values_) value.texts.clear();
    const bool goes_on = understand(reversed);
    require_values();
    return goes_on;
  };
  if (!config_.empty() && !add(read_config(config_))) return false;
  // One that the file names counts as well, and what the file says itself comes first.
  if (!preset_.empty()) {
    const GivenNames without = given();
    add(parse_config("--preset " + preset_, std::string(preset_of(preset_).text)));
    for (const std::string& name : given())
      if (!without.contains(name) && name.find(' ') == std::string::npos)
        of_preset_.push_back({name, app_->get_option(name)->get_expected_max() == 0, preset_});
  }
  for (const Value& value : values_) {
    if (value.option->count() == 0) continue;
    if (value.texts.empty()) value.take(text_of(*value.option, value.text));
    for (const std::string& text : value.texts) value.take(text_of(*value.option, text));
  }
  if (unit_ && !unit_->empty() && lengths_by_ == std::string::npos) *lengths_ = Lengths(*unit_, 1);
  return true;
}

bool CommandLine::has(const char* option) const { return app_->get_option(option)->count() > 0; }

GivenNames CommandLine::given() const {
  GivenNames names;
  for (const CLI::Option* const option : app_->get_options()) {
    if (option->count() == 0 || option->get_lnames().empty()) continue;
    const bool is_flag = option->get_expected_max() == 0;
    if (is_flag && !option->as<bool>()) continue;
    const std::string name = "--" + option->get_lnames().front();
    names.insert(name);
    for (const std::string& value : option->results()) names.insert(fmt::format("{} {}", name, value));
  }
  return names;
}

std::vector<GivenOption> CommandLine::given_hidden() const {
  std::vector<GivenOption> given;
  for (const CLI::Option* const option : hidden_options_) {
    if (option->count() == 0) continue;
    const std::string name = "--" + option->get_lnames().front();
    const bool is_flag = option->get_expected_max() == 0;
    if (is_flag) given.push_back({name, {}});
    else
      for (const std::string& value : option->results()) given.push_back({name, value});
  }
  return given;
}

/// \throw UsageError for an empty value: it comes from a script's empty variable, and is never intended.
void CommandLine::require_values() const {
  for (const CLI::Option* const option : app_->get_options())
    for (const std::string& value : option->results())
      require(!value.empty(), option->get_name() + ": expected a value, got ''");
}

}  // namespace vdb_offset::tool
