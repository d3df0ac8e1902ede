#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trigrain {

/// A number that a study finds. With a bar it is an error, and right where |value| <= bar.
struct Metric {
  std::string name; ///< ends with its unit, if it has one
  double value;
  std::optional<double> bar;

  bool within() const; ///< false for values that are not finite
};

/// What a study may be asked for. Not every study uses all of it.
struct StudyRequest {
  std::string contact_rule = "features";
  std::string law = "spring-dashpot";
  std::string control = "fixed";
  int level = -1;                  ///< cuts of an icosphere that stands for a ball; -1: a true sphere
  double value = 1;                ///< the quantity that the study varies; its row says which
  double steps_per_contact = 50.3; ///< N; a whole number would always meet the contact at the same phase
  double stiffness = 1;            ///< times what the study takes by itself
  int particles = 400;             ///< grains
  int vertices = 0;                ///< points of a granulate; 0: spheres
  std::uint64_t seed = 1;
};

/// One question about accuracy or stability, with an answer known from elsewhere.
struct Study {
  std::string_view name;
  std::string_view about;
  std::vector<Metric> (*run)(const StudyRequest& request);
};

std::span<const Study> studies();

} // namespace trigrain
