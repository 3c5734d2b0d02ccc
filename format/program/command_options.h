// Typed command-line options on top of CLI11.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "format/result.h"
#include "format/text/ascii_text.h"

namespace splatlas {

/// Binds an option to `value`. parse(text) returns an optional value; without one, parsing ends with
/// CLI::ValidationError: --size "10": must be WIDTHxHEIGHT.
template <typename Value, typename Parse>
CLI::Option* add_parsed(CLI::App& app, const std::string& names, Value& value, Parse parse,
                        const std::string& must_be, const std::string& help) {
  const std::string name = names.substr(names.find("--"));
  const auto assign = [name, &value, parse, must_be](const std::string& text) {
    auto parsed = parse(text);
    if (!parsed) throw CLI::ValidationError(fmt::format("{} {}", name, in_quotes(text)), must_be);
    value = *std::move(parsed);
  };
  return app.add_option_function<std::string>(names, assign, help);
}

/// Appends each text of a repeatable option to `values`. Errors of parse(text) become CLI::ValidationError.
template <typename Value, typename Parse>
CLI::Option* add_repeated(CLI::App& app, const std::string& names, std::vector<Value>& values, Parse parse,
                          const std::string& help) {
  const auto append = [&values, parse](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      auto parsed = parse(text);
      if (!parsed) throw CLI::ValidationError(parsed.error().message);
      values.push_back(*std::move(parsed));
    }
  };
  return app.add_option_function<std::vector<std::string>>(names, append, help);
}

/// A text that is not empty, for add_parsed().
template <typename Value>
[[nodiscard]] std::optional<Value> non_empty(std::string_view text) {
  return text.empty() ? std::nullopt : std::optional<Value>(text);
}

/// Names of an option's values, for help, parsing and errors.
template <typename Value>
using Choices = std::vector<std::pair<std::string, Value>>;

/// "draft, normal or high".
template <typename Value>
[[nodiscard]] std::string list_names(const Choices<Value>& choices) {
  std::string list;
  for (const auto& choice : choices) {
    if (!list.empty()) list += &choice == &choices.back() ? " or " : ", ";
    list += choice.first;
  }
  return list;
}

/// Binds an option to one of several named values; its default is the present `value`.
template <typename Value>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Value& value,
                        const Choices<std::type_identity_t<Value>>& choices, const std::string& help = "") {
  const auto find = [choices](std::string_view text) -> std::optional<Value> {
    const auto found = std::ranges::find(choices, text, &Choices<Value>::value_type::first);
    return found == choices.end() ? std::nullopt : std::optional(found->second);
  };
  const std::string list = list_names(choices);
  CLI::Option* option =
      add_parsed(app, name, value, find, "must be " + list, help.empty() ? list : list + ": " + help);
  if constexpr (std::equality_comparable<Value>) {
    const auto present = std::ranges::find(choices, value, &Choices<Value>::value_type::second);
    if (present != choices.end()) option->default_str(present->first);
  }
  return option;
}

/// Binds --surfaces to a rule or choice of surfaces.
template <typename Surfaces>
CLI::Option* add_surfaces(
    CLI::App& app, Surfaces& surfaces,
    const std::string& help = "surfaces that follow from the voxels; as in the atlas if not given") {
  return add_choice(app, "--surfaces", surfaces,
                    {{"smooth", Surfaces::kSmooth}, {"voxels", Surfaces::kVoxels}}, help);
}

/// Message of a failed parse. CLI11 lists unexpected arguments in reverse order.
[[nodiscard]] inline std::string fault_of_usage(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> words = app.remaining(true);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr || words.size() < 2) return error.what();
  return fmt::format("The following arguments were not expected: {}", fmt::join(words, " "));
}

/// Check of an option or argument that names a file: refuses "".
[[nodiscard]] inline CLI::Validator names_a_file() {
  return CLI::Validator([](const std::string& text) { return text.empty() ? "\"\": must name a file" : ""; },
                        "");
}

/// Binds an option or argument that names a file, or several.
template <typename Value>
CLI::Option* add_path(CLI::App& app, const std::string& name, Value& value, const std::string& help) {
  return app.add_option(name, value, help)->check(names_a_file());
}

/// Binds --threads to `threads`; 0 stands for one thread per core.
inline CLI::Option* add_threads(CLI::App& app, unsigned& threads, const std::string& help) {
  constexpr unsigned kMaxThreads = 1024;
  return app.add_option("--threads", threads, help)
      ->check(CLI::Range(0u, kMaxThreads).description(""))
      ->capture_default_str();
}

/// Binds --memory, in MiB, to a number of bytes.
inline CLI::Option* add_memory(CLI::App& app, std::uint64_t& bytes) {
  constexpr int kMiBBits = 20;
  constexpr std::uint64_t kMinMiB = 16, kMaxMiB = std::uint64_t{1} << 30;
  const auto parse = [](std::string_view text) -> std::optional<std::uint64_t> {
    const auto mib = parse_number<std::uint64_t>(text);
    if (!mib || *mib < kMinMiB || *mib > kMaxMiB) return std::nullopt;
    return *mib << kMiBBits;
  };
  return add_parsed(app, "--memory", bytes, parse,
                    fmt::format("must be a number of MiB from {} to {}", kMinMiB, kMaxMiB),
                    "MiB that decoded parts and pictures may take; half of the machine's if not given");
}

/// Binds --max-work to the factor of AtlasOptions.
inline CLI::Option* add_max_work(CLI::App& app, double& max_work) {
  constexpr double kMinWork = 0.001, kMaxWork = 1e9;
  const auto parse = [](std::string_view text) {
    const auto factor = parse_number<double>(text);
    return factor && *factor >= kMinWork && *factor <= kMaxWork ? factor : std::nullopt;
  };
  return add_parsed(
             app, "--max-work", max_work, parse, "must be a number from 0.001 to 1e9",
             "limit of time and memory for the file, in multiples of the usual one (30 s of one core, 2 GiB, "
             "more for large files): below 1 for untrusted files, above 1 for very large ones")
      ->default_str(fmt::to_string(max_work));
}

}  // namespace splatlas
