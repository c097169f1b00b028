// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "request/presets.h"
#include "request/request.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace vdb_offset::tool {

struct ConfigEntry;

/// An option of a command line that was given, by its long name; a flag has no value.
struct GivenOption {
  std::string name;
  std::optional<std::string> value;
};

/// Options that --help lists together: at most twelve, so that one finds among them.
struct HelpTopic {
  const char *name, *title;
  std::vector<std::string> options;  ///< By their long names; those that a command does not have are left out.
};

// Most letters by which a word differs from what may be meant by it.
inline constexpr std::size_t kMostEdits = 2;
/// How many letters have to be put in, left out or replaced to make one word of the other.
std::size_t edits_between(std::string_view one, std::string_view other);

/// The files and options of a command, as CLI11 finds them. Values are taken once the whole line has been understood,
/// so that --help is answered whatever else is in it: each by the function that was declared with its option, in the
/// order of declaration.
class CommandLine {
 public:
  using Take = std::function<void(const std::string& text)>;

  /// `more` stands below the options in --help; `help` is the call that prints it, for messages.
  CommandLine(const char* name, const char* about, const char* more, const char* help);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// -V and --version, which print `version`.
  void add_version(const std::string& version);
  /// --config, a file with values of options that the line does not have, and --preset, which names one that comes with
  /// the command. One of `alternatives` on the line counts
  /// instead of all of the same set in the file. Names that are `passed_over` are options of other commands. A file
  /// that has a name that is `kept_out` is refused.
  void add_config(std::vector<std::vector<std::string>> alternatives, std::vector<std::string> passed_over = {},
                  std::vector<std::string> kept_out = {});
  /// --unit, the unit of the file's numbers, with which lengths may have units of their own. `unit` gets its name;
  /// where it is not given, the file `input`, which other options name, may state its own.
  /// `lengths` get the unit of the distance, or else of another length, or else of the file as far as it is given.
  void add_unit(std::string& unit, const std::string& input, Lengths& lengths);
  /// --help lists those of `options` alone and says `more`, and which topics there are; `--help TOPIC` lists the
  /// options of a topic, `--help OPTION` one, and `--help all` those of all, by their topics.
  void arrange_help(std::span<const HelpTopic> topics, std::vector<std::string> options, std::string more);
  /// What is declared from here on is not listed in --help.
  void hide_what_follows() { hidden_ = true; }
  /// A file that the command cannot do without, by its position.
  void file(const char* name, const char* about, std::string& path);
  /// One that it can do without; then `path` stays empty.
  void file_or_none(const char* name, const char* about, std::string& path);
  /// An option with a value, given at most once. `type` stands for the value in --help.
  void option(const char* names, const char* type, const char* about, Take take);
  void option(const char* names, const char* type, const char* about, std::string& text);
  /// An option whose value `made_of` makes of the text.
  template <class Value, class Parse>
  void option(const char* names, const char* type, const char* about, Value& value, Parse made_of) {
    option(names, type, about,
           [&value, made_of](const std::string& text) { value = static_cast<Value>(made_of(text)); });
  }
  /// The same, and `text` gets the text.
  template <class Value, class Parse>
  void option(const char* names, const char* type, const char* about, Value& value, Parse made_of, std::string& text) {
    option(names, type, about,
           [&value, &text, made_of](const std::string& given) { value = static_cast<Value>(made_of(text = given)); });
  }
  /// An option with a value that may be given several times.
  void repeated(const char* names, const char* type, const char* about, Take take);
  void flag(const char* names, const char* about, bool& is_set);

  /// False if the line asked only for help or the version, which are then printed.
  /// \throw UsageError for a line that is not understood, for empty values, and as the functions that take values do
  bool parse(int argc, const char* const* argv);

  /// Whether an option was given, by its long name.
  bool has(const char* option) const;
  GivenNames given() const;
  /// An option that was given, by its long name, and is not among these; none if there is none.
  std::optional<std::string> given_besides(std::span<const char* const> known) const;
  /// The file of --config; empty if none was given.
  const std::string& config() const { return config_; }
  /// The options that a preset gave.
  const std::vector<PresetOption>& of_preset() const { return of_preset_; }
  /// The hidden options that were given, those with several values once for each.
  std::vector<GivenOption> given_hidden() const;

 private:
  struct Value {
    CLI::Option* option;
    std::string text;
    std::vector<std::string> texts;  ///< Of one that may be given several times.
    Take take;
  };
  bool understand(std::vector<std::string> reversed);
  /// Prints what --help asks for if it is among the words. Returns whether it was. \throw UsageError
  bool answer_help(const std::vector<std::string>& reversed);
  /// What --help lists for a word: a topic, all, or an option by its long name; empty for any other word.
  std::string topic_of(std::string word) const;
  /// The topic or option of nearly that name; empty if there is none.
  std::string meant_by(std::string word) const;
  /// Puts each option that is to be listed under a title, and takes all others off the list.
  void list_for(const std::string& topic);
  /// What a file of options says of those that were not given, as words. \throw UsageError
  std::vector<std::string> words_of(const std::vector<ConfigEntry>& entries) const;
  void require_values() const;
  void require_known_options() const;
  /// The text of an option as it is to be taken.
  std::string text_of(const CLI::Option& option, const std::string& given);
  /// Declares whether --help lists an option.
  void place(CLI::Option* option);

  std::unique_ptr<CLI::App> app_;
  const char* help_;
  std::string config_, preset_;
  std::vector<PresetOption> of_preset_;
  std::vector<std::vector<std::string>> alternatives_;
  std::vector<std::string> passed_over_, kept_out_;
  const std::string *unit_ = nullptr, *measured_ = nullptr;
  Lengths* lengths_ = nullptr;
  std::size_t lengths_by_ = std::string::npos;  // number of the option in kLengths that their unit is of
  std::span<const HelpTopic> topics_;
  std::vector<std::string> first_options_;
  std::string more_of_all_, more_of_first_;
  bool hidden_ = false;
  std::vector<const CLI::Option*> hidden_options_;
  std::deque<Value> values_;  // CLI11 keeps references to their texts
};

}  // namespace vdb_offset::tool
