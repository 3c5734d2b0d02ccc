// Recursive descent parser of selection text.
#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/result_macros.h"
#include "format/selection/selection_terms.h"
#include "format/tasks/task_control.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/// True if unquoted names may contain the character.
bool is_name_character(char c) {
  const bool beyond_ascii = static_cast<unsigned char>(c) >= 0x80;
  return is_ascii_letter_or_digit(c) || beyond_ascii ||
         std::string_view("_./*'").find(c) != std::string_view::npos;
}

/// One function per rule of the grammar in selection.h.
class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  Result<std::vector<SelectionTerm>> selection() {
    std::vector<SelectionTerm> terms;
    skip_blanks();
    if (at_end()) return terms;
    if (next_is('-'))
      return fault("there is nothing to remove from yet; begin with what to show, or \"*\" for all");
    for (bool remove = false;;) {
      check_task();
      SPLATLAS_ASSIGN_OR_RETURN(SelectionTerm next, term(remove));
      terms.push_back(std::move(next));
      skip_blanks();
      if (at_end()) return terms;
      if (!next_is('+') && !next_is('-'))
        return fault("expected \"+\" or \"-\" before the next term; quote names with blanks or signs");
      remove = next_is('-');
      ++at_;
    }
  }

  /// A quoted name or a label, and nothing behind it.
  Result<SelectionTerm> lone_target() {
    SelectionTerm result;
    SPLATLAS_RETURN_IF_ERROR(target(result));
    skip_blanks();
    if (!at_end()) return fault("expected nothing behind the name");
    return result;
  }

 private:
  Result<SelectionTerm> term(bool remove) {
    SelectionTerm result;
    result.remove = remove;
    skip_blanks();
    result.column = at_;
    SPLATLAS_RETURN_IF_ERROR(target(result));
    if (remove && result.target == TermTarget::kRest) {
      return fault_at(result.column,
                      "the rest cannot be removed; leave it out, or quote a structure called \"rest\"");
    }
    if (skip(':')) {
      SPLATLAS_ASSIGN_OR_RETURN(result.mode, mode());
    }
    skip_blanks();
    if (next_is('(')) {
      if (remove) return fault("a removal takes no options; quote a name that holds a \"-\"");
      ++at_;
      SPLATLAS_RETURN_IF_ERROR(options(result));
      if (result.ghost && result.mode == DrawMode::kOff) result.mode = DrawMode::kSurface;
    }
    return result;
  }

  Result<void> target(SelectionTerm& term) {
    if (next_is('#')) return label(term);
    if (next_is('"')) {
      SPLATLAS_ASSIGN_OR_RETURN(term.name, quoted_name());
      return {};
    }
    term.name = word();
    if (term.name.empty()) return fault("expected the name of a structure");
    if (equal_ignoring_case(term.name, "rest")) term.target = TermTarget::kRest;
    return {};
  }

  Result<void> label(SelectionTerm& term) {
    const std::size_t start = at_++;
    if (next_is('-')) ++at_;
    (void)word();
    term.name = text_.substr(start, at_ - start);
    const auto number = parse_number<std::int64_t>(std::string_view(term.name).substr(1));
    if (!number) {
      return fault_at(start, fmt::format("{} is not a label: write # and a whole number, or quote the name",
                                         in_quotes(term.name)));
    }
    term.target = TermTarget::kLabel;
    term.label = *number;
    return {};
  }

  Result<std::string> quoted_name() {
    const std::size_t start = at_++;
    std::string name;
    for (; !at_end(); ++at_) {
      if (next_is('"')) {
        const bool doubled = at_ + 1 < text_.size() && text_[at_ + 1] == '"';
        if (!doubled) break;
        ++at_;
      }
      name += text_[at_];
    }
    if (at_end()) return fault_at(start, "this quote is never closed");
    if (name.empty()) return fault_at(start, "the name is empty");
    ++at_;
    return name;
  }

  Result<DrawMode> mode() {
    skip_blanks();
    const std::size_t start = at_;
    const std::string_view written = word();
    for (const DrawMode mode : {DrawMode::kVolume, DrawMode::kSurface, DrawMode::kBoth}) {
      if (equal_ignoring_case(written, name_of(mode))) return mode;
    }
    return fault_at(start,
                    fmt::format("{} is not a mode: write volume, surface or both", in_quotes(written)));
  }

  /// Options after the opening parenthesis, through the closing one.
  Result<void> options(SelectionTerm& term) {
    do {
      SPLATLAS_RETURN_IF_ERROR(option(term));
    } while (skip(','));
    if (skip(')')) return {};
    return fault("expected \",\" or \")\" after an option");
  }

  Result<void> option(SelectionTerm& term) {
    skip_blanks();
    const std::size_t start = at_;
    const std::string_view key = word();
    const SelectionOption* const option = find_option(key);
    if (option == nullptr) {
      return fault_at(start, fmt::format("{} is not an option: {}", in_quotes(key),
                                         "write ghost, opacity=0.4, color=#ff8800, profile=thin, low=40, "
                                         "high=160 or curve=40:0/160:0.3"));
    }
    if (option->is_given(term)) return fault_at(start, fmt::format("{} is given twice", option->name));
    if (option->is_flag) {
      (void)option->read({}, term);  // a flag
      return {};
    }
    if (!skip('=')) return fault(fmt::format("expected \"=\" after {}", option->name));
    skip_blanks();
    const std::size_t value_start = at_;
    while (!at_end() && !is_blank(text_[at_]) && !next_is(',') && !next_is(')')) ++at_;
    const OptionResult read = option->read(text_.substr(value_start, at_ - value_start), term);
    if (!read) return fault_at(value_start + read.error().offset, read.error().what);
    return {};
  }

  /// The longest sequence of name characters; may be empty.
  std::string_view word() {
    const std::size_t start = at_;
    while (!at_end() && is_name_character(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }

  [[nodiscard]] bool at_end() const { return at_ == text_.size(); }
  [[nodiscard]] bool next_is(char c) const { return !at_end() && text_[at_] == c; }
  void skip_blanks() {
    while (!at_end() && is_blank(text_[at_])) ++at_;
  }
  /// Skips blanks, then `c` if it is next. Returns true if it was.
  bool skip(char c) {
    skip_blanks();
    if (!next_is(c)) return false;
    ++at_;
    return true;
  }

  [[nodiscard]] tl::unexpected<Error> fault(std::string_view what) const { return fault_at(at_, what); }
  [[nodiscard]] tl::unexpected<Error> fault_at(std::size_t column, std::string_view what) const {
    return fail(ErrorCode::kUsage, "selection {}, column {}: {}", in_quotes(text_), column + 1, what);
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

Result<std::vector<SelectionTerm>> parse_selection(std::string_view text) {
  return Parser(text).selection();
}

Result<std::vector<StructureIndex>> StructureGraph::find_named(std::string_view text) const {
  if (!text.starts_with('"') && !text.starts_with('#')) return find(text);
  SPLATLAS_ASSIGN_OR_RETURN(const SelectionTerm term, Parser(text).lone_target());
  return find_target(*this, term);
}

}  // namespace splatlas
