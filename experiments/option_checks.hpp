#pragma once
#include "kernels/name_table.hpp"
#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <optional>
#include <string>

namespace trigrain {

/// Refuses what is no finite number or does not fit; CLI11's own checks print the largest double instead.
inline CLI::Validator number_that(const std::string& is_expected, const std::string& shown, bool (*fits)(double)) {
  const auto check = [is_expected, fits](const std::string& text) {
    double value = 0;
    const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && fits(value);
    return good ? std::string() : is_expected + " is expected, not '" + text + "'";
  };
  return {check, shown};
}

inline const CLI::Validator above_zero =
    number_that("a number above 0", "POSITIVE", [](double value) { return value > 0; });
inline const CLI::Validator not_negative =
    number_that("a number of 0 or more", "NONNEGATIVE", [](double value) { return value >= 0; });

/// What is wrong on the command line of `app`, in one sentence.
inline InputError command_line_error(const CLI::App& app, const CLI::ParseError& error) {
  std::string problem = error.what();
  for (const std::string& word : app.remaining())
    if (word.starts_with('-')) problem = "unknown option '" + word + "'";
  return InputError(problem + " (command line). See " + app.get_name() + " --help.");
}

/// Reads the command line; the exit code if that was all: help was asked for, or an option is wrong, which is told.
inline std::optional<int> exit_code_of_parsing(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    std::cerr << command_line_error(app, error).what() << '\n';
    return 3;
  }
  return {};
}

} // namespace trigrain
