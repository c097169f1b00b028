// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/distances.h"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "ground/system/parallel.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

constexpr std::array<const char*, 9> kVariableNames = {"x", "y", "z", "nx", "ny", "nz", "u", "v", "edge"};
constexpr std::array<std::pair<const char*, double>, 2> kConstants = {
    {{"pi", std::numbers::pi}, {"e", std::numbers::e}}};

// Most bytes of an expression, and how deep its parentheses and conditions may be nested. muParser takes 20,000 bytes,
// and what is written for it is up to seven times as long as the expression.
constexpr std::size_t kLongestText = 2000;
constexpr int kDeepest = 100;

// Vertices for which one parser is set up, which takes as long as evaluating the expression for some hundreds.
constexpr std::size_t kBlock = std::size_t{1} << 14;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_utf8_tail(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

/// Reads numbers in place of muParser's own reader, which depends on the locale.
int read_number(const char* text, int* position, double* value) {
  if (!is_digit(*text) && *text != '.') return 0;
  const auto [end, error] = std::from_chars(text, text + std::char_traits<char>::length(text), *value);
  if (error != std::errc()) return 0;
  *position += static_cast<int>(end - text);
  return 1;
}

/// A compiled expression with variables of its own. Each thread needs one: evaluating changes muParser's parser.
struct Evaluator {
  explicit Evaluator(const std::string& code) {
    parser.AddValIdent(read_number);
    // The optimizer folds `0.5 && 1` into 0, and changes the order of sums and products, and so their last bits.
    parser.EnableOptimizer(false);
    parser.ClearConst();
    for (const auto& [name, constant] : kConstants) parser.DefineConst(name, constant);
    for (std::size_t i = 0; i < value.size(); ++i) parser.DefineVar(kVariableNames[i], &value[i]);
    parser.SetExpr(code);
  }
  Evaluator(const Evaluator&) = delete;
  Evaluator& operator=(const Evaluator&) = delete;

  double operator()() const { return parser.Eval(); }

  std::array<double, kVariableNames.size()> value{};
  mu::Parser parser;
};

/// Names of functions, and how many arguments each takes: -1 for one or more.
const std::map<std::string, int, std::less<>>& functions() {
  static const auto kKnown = [] {
    std::map<std::string, int, std::less<>> arguments;
    const mu::Parser parser;
    for (const auto& [name, callback] : parser.GetFunDef()) arguments[name] = callback.GetArgc();
    return arguments;
  }();
  return kKnown;
}

std::string known_names() {
  std::string names = fmt::format("{}", fmt::join(kVariableNames, ", "));
  for (const auto& [name, constant] : kConstants) names += std::string(", ") + name;
  return names;
}

/// Reads an expression token by token and writes it for muParser. Errors are found here, not by muParser: that also
/// accepts assignments, strings and lists of results, and reports where it noticed an error, not where the error is.
class ExpressionReader {
 public:
  explicit ExpressionReader(const std::string& text) : text_(text) {}

  void read() {
    if (text_.size() > kLongestText) {
      at_ = kLongestText;
      fail(fmt::format("at most {} bytes", kLongestText), fmt::format("{}", text_.size()));
    }
    next();
    expression();
    percent = token_ == "%";
    if (percent) next();
    if (!token_.empty()) fail(percent ? "nothing behind '%'" : "an operator or the end");
  }

  std::string code;
  std::vector<std::string> names;
  bool percent = false;

 private:
  /// Goes on to the next token, which is empty at the end of the text.
  void next() {
    at_ += token_.size();
    while (at_ < text_.size() && (text_[at_] == ' ' || (text_[at_] >= '\t' && text_[at_] <= '\r'))) ++at_;
    token_ = text_.substr(at_, token_length());
  }
  std::size_t token_length() const {
    const std::string_view rest = text_.substr(at_);
    if (rest.empty()) return 0;
    const auto is_in_name = [](char c) { return is_letter(c) || is_digit(c); };
    if (is_letter(rest[0]))
      return static_cast<std::size_t>(std::find_if_not(rest.begin(), rest.end(), is_in_name) - rest.begin());
    if (is_digit(rest[0]) || (rest[0] == '.' && rest.size() > 1 && is_digit(rest[1]))) {
      double value = 0;
      return static_cast<std::size_t>(std::from_chars(rest.data(), rest.data() + rest.size(), value).ptr - rest.data());
    }
    for (const std::string_view pair : {"<=", ">=", "==", "!=", "&&", "||"})
      if (rest.starts_with(pair)) return 2;
    // All bytes of one UTF-8 character, so that a message can show it.
    return static_cast<std::size_t>(std::find_if_not(rest.begin() + 1, rest.end(), is_utf8_tail) - rest.begin());
  }

  void expression() {
    const Level level(*this);
    const std::size_t begin = code.size();
    operand();
    while (is_operator()) {
      write(token_);
      next();
      operand();
    }
    if (token_ != "?") return;
    // With parentheses, how conditions within conditions are grouped does not depend on muParser.
    code.insert(begin, " ((");
    write(") ? (");
    next();
    expression();
    take(":");
    write(") : (");
    expression();
    write("))");
  }

  bool is_operator() const {
    constexpr std::string_view kOperators[] = {"+", "-", "*", "/", "^", "<", ">", "<=", ">=", "==", "!=", "&&", "||"};
    return std::find(std::begin(kOperators), std::end(kOperators), token_) != std::end(kOperators);
  }

  void operand() {
    bool negative = false;
    for (; token_ == "+" || token_ == "-"; next()) negative ^= token_ == "-";
    if (negative) write("-");  // muParser accepts only one sign
    if (token_ == "(") {
      write("(");
      next();
      expression();
      take(")");
      write(")");
    } else if (!token_.empty() && is_letter(token_[0])) {
      name();
    } else if (!token_.empty() && (is_digit(token_[0]) || (token_[0] == '.' && token_.size() > 1))) {
      number();
    } else {
      fail("a number, a name, a function or '('");
    }
  }

  void number() {
    double value = 0;
    const auto [end, error] = std::from_chars(token_.data(), token_.data() + token_.size(), value);
    if (error != std::errc()) fail("a number that a double can hold");
    write(token_);
    next();
  }

  void name() {
    const std::string_view name = token_;
    const std::size_t at = at_;
    next();
    if (is_value(name)) {
      names.emplace_back(name);
      write(name);
      return;
    }
    if (token_ == "(") return call(name, at);
    if (functions().contains(name)) fail(fmt::format("'(' behind the function '{}'", name));
    fail_at(at, fmt::format("unknown name '{}' (there are {})", name, known_names()));
  }

  static bool is_value(std::string_view name) {
    return std::find(kVariableNames.begin(), kVariableNames.end(), name) != kVariableNames.end() ||
           std::any_of(kConstants.begin(), kConstants.end(), [&](const auto& known) { return known.first == name; });
  }

  /// Reads the arguments of a function. \pre '(' is the current token
  void call(std::string_view name, std::size_t at) {
    const auto function = functions().find(name);
    if (function == functions().end()) {
      std::vector<std::string> known;
      for (const auto& [other, count] : functions()) known.push_back(other);
      fail_at(at, fmt::format("unknown function '{}' (there are {})", name, fmt::join(known, ", ")));
    }
    write(std::string(name) + "(");  // muParser accepts no blank between name and parenthesis
    next();
    int count = 0;
    while (token_ != ")") {
      expression();
      ++count;
      if (token_ != ",") break;
      write(",");
      next();
      if (token_ == ")") fail("an argument");
    }
    const int wanted = function->second;
    if (token_ == ")" && (wanted < 0 ? count == 0 : count != wanted))
      fail_at(at, fmt::format("expected {} of '{}', got {}",
                              wanted < 0 ? "one argument or more"
                                         : fmt::format("{} argument{}", wanted, wanted == 1 ? "" : "s"),
                              name, count));
    take(")", "an operator, ',' or ')'");
    write(")");
  }

  void take(std::string_view wanted, const std::string& expected = {}) {
    if (token_ != wanted) fail(expected.empty() ? fmt::format("an operator or '{}'", wanted) : expected);
    next();
  }

  void write(std::string_view piece) {
    code += ' ';
    code += piece;
  }

  bool is_double_star() const { return token_ == "*" && at_ > 0 && text_[at_ - 1] == '*'; }

  [[noreturn]] void fail(const std::string& expected) const {
    const char* const hint = token_ == "="      ? " (nothing is assigned here; '==' compares)"
                             : token_ == ","    ? " (the decimal point is '.'; ',' stands between arguments)"
                             : token_ == "%"    ? " (it stands behind the whole expression)"
                             : is_double_star() ? " (powers are written with '^')"
                                                : "";
    fail(expected, shown(token_) + hint);
  }
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    fail_at(at_, fmt::format("expected {}, got {}", expected, found));
  }
  [[noreturn]] void fail_at(std::size_t at, const std::string& what) const {
    const auto before = text_.substr(0, at);
    const auto column = 1 + std::count_if(before.begin(), before.end(), [](char c) { return !is_utf8_tail(c); });
    throw InvalidExpression(fmt::format("distance '{}': column {}: {}", shortened(text_), column, what));
  }
  static std::string shown(std::string_view token) {
    return token.empty() ? "the end" : fmt::format("'{}'", shortened(token));
  }
  /// The text as a message of one line can show it: cut off, without control characters.
  static std::string shortened(std::string_view text) {
    constexpr std::size_t kShown = 200;  // bytes; a longer message is hard to read
    std::string line(text.substr(0, kShown));
    std::replace_if(
        line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
    return text.size() > kShown ? line + "..." : line;
  }

  /// Counts how deep expressions are nested, as each level takes stack.
  struct Level {
    explicit Level(ExpressionReader& reader) : depth(reader.depth_) {
      if (++depth > kDeepest) reader.fail(fmt::format("at most {} levels of parentheses", kDeepest));
    }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;
    ~Level() { --depth; }
    int& depth;
  };

  std::string_view text_, token_;
  std::size_t at_ = 0;  // first byte of the token
  int depth_ = 0;
};

void require_for_each(const std::string& text, const VertexVariables& at, const char* what, std::size_t count) {
  if (count != at.positions.size())
    throw InvalidInput(
        fmt::format("distance '{}': expected {} {}, which it uses, got {}", text, at.positions.size(), what, count));
}

}  // namespace

DistanceExpression::DistanceExpression(std::string text) : text_(std::move(text)) {
  ExpressionReader reader(text_);
  reader.read();
  code_ = std::move(reader.code);
  names_ = std::move(reader.names);
  percent_ = reader.percent;
  try {
    Evaluator{code_}();
  } catch (const mu::ParserError& error) {  // not a std::exception; thrown only if ExpressionReader has missed an error
    throw InvalidExpression(
        fmt::format("distance '{}': expected what muParser takes, got '{}'", text_, error.GetMsg()));
  }
}

bool DistanceExpression::uses(std::string_view name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

std::vector<double> DistanceExpression::operator()(const VertexVariables& at) const {
  const bool normals = uses_normals(), texture = uses_texture(), edges = uses_edges();
  if (normals) require_for_each(text_, at, "normals", at.normals.size());
  if (texture) require_for_each(text_, at, "texture coordinates", at.texture.size());
  if (edges) require_for_each(text_, at, "lengths of edges", at.edges.size());
  const std::size_t count = at.positions.size();
  std::vector<double> distance(count);
  std::atomic<std::uint64_t> first_unusable = count;
  const auto evaluate = [&](std::size_t block) {
    Evaluator evaluator(code_);
    auto& value = evaluator.value;
    for (std::size_t v = block * kBlock; v < std::min(count, (block + 1) * kBlock); ++v) {
      for (std::size_t k = 0; k < 3; ++k) value[k] = at.positions[v][static_cast<int>(k)];
      for (std::size_t k = 0; normals && k < 3; ++k) value[3 + k] = at.normals[v][static_cast<int>(k)];
      for (std::size_t k = 0; texture && k < 2; ++k) value[6 + k] = at.texture[v][static_cast<int>(k)];
      if (edges) value[8] = at.edges[v];
      distance[v] = percent_ ? evaluator() / 100 * at.diagonal : evaluator();
      if (!std::isfinite(distance[v])) lower_to(first_unusable, v);
    }
  };
  for_each_index((count + kBlock - 1) / kBlock, evaluate, 1);
  if (first_unusable < count)
    throw InvalidInput(fmt::format("distance '{}': expected a finite number at vertex {} (counted from 0), got {}",
                                   text_, first_unusable.load(), distance[first_unusable]));
  return distance;
}

std::function<double(const PointVariables&)> DistanceExpression::at_points(double diagonal) const {
  return [evaluator = std::make_shared<Evaluator>(code_), text = text_, is_share = percent_,
          diagonal](const PointVariables& at) {
    auto& value = evaluator->value;
    for (std::size_t k = 0; k < 3; ++k) {
      value[k] = at.position[static_cast<int>(k)];
      value[3 + k] = at.normal[static_cast<int>(k)];
      if (k < 2) value[6 + k] = at.texture[static_cast<int>(k)];
    }
    value[8] = at.edge;
    const double distance = is_share ? (*evaluator)() / 100 * diagonal : (*evaluator)();
    if (!std::isfinite(distance))
      throw InvalidInput(fmt::format("distance '{}': expected a finite number at u = {:g}, v = {:g}, got {}", text,
                                     at.texture[0], at.texture[1], distance));
    return distance;
  };
}

}  // namespace vdb_offset
