// Parts of C++20's library that the sources use and libc++ 13 does not have. Included ahead of all sources.
#pragma once

#include <algorithm>
#include <atomic>
#include <charconv>
#include <compare>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <limits>
#include <ranges>
#include <string>
#include <system_error>
#include <type_traits>
#include <vector>

namespace std {

template <typename To, typename From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

template <typename T>
auto operator<=>(const vector<T>& a, const vector<T>& b) -> decltype(a[0] <=> b[0]) {
  for (size_t n = 0; n < a.size() && n < b.size(); ++n)
    if (const auto order = a[n] <=> b[n]; order != 0) return order;
  return a.size() <=> b.size();
}

/// Decimal numbers, as std::from_chars reads them: no blank, no "+", no hexadecimal, in the C locale.
template <typename T>
requires is_floating_point_v<T> from_chars_result from_chars(const char* first, const char* last, T& value) {
  const char* begin = first != last && *first == '-' ? first + 1 : first;
  const bool is_word = begin != last && (*begin == 'i' || *begin == 'I' || *begin == 'n' || *begin == 'N');
  const bool is_number = begin != last && ((*begin >= '0' && *begin <= '9') || *begin == '.');
  if (!is_word && !is_number) return {first, errc::invalid_argument};
  string text(first, last);
  if (const size_t x = text.find_first_of("xX"); x != string::npos) text.resize(x);
  char* end = nullptr;
  const T number =
      is_same_v<T, float> ? strtof(text.c_str(), &end) : static_cast<T>(strtod(text.c_str(), &end));
  if (end == text.c_str()) return {first, errc::invalid_argument};
  const char* const behind = first + (end - text.c_str());
  if (is_number && abs(number) > numeric_limits<T>::max()) return {behind, errc::result_out_of_range};
  value = number;
  return {behind, errc()};
}

template <>
struct atomic<double> {
  double operator=(double value) noexcept { return value_ = value; }
  double operator+=(double value) noexcept { return value_ += value; }
  operator double() const noexcept { return value_; }
  constexpr atomic(double value = 0) noexcept : value_(value) {}

 private:
  double value_;
};

namespace ranges {

/// comp(projection(a), projection(b)) as a function of (a, b).
template <typename Compare, typename Projection>
auto projected_order(Compare& comp, Projection& projection) {
  return [&](const auto& a, const auto& b) {
    return invoke(comp, invoke(projection, a), invoke(projection, b));
  };
}

#define SPLATLAS_TEST(name)                                                          \
  template <typename Range, typename Test, typename Projection = identity>           \
  constexpr auto name(Range&& range, Test test, Projection projection = {}) {        \
    return std::name(std::begin(range), std::end(range),                             \
                     [&](auto&& a) { return invoke(test, invoke(projection, a)); }); \
  }
SPLATLAS_TEST(all_of)
SPLATLAS_TEST(any_of)
SPLATLAS_TEST(none_of)
SPLATLAS_TEST(count_if)
SPLATLAS_TEST(find_if)
SPLATLAS_TEST(for_each)
#undef SPLATLAS_TEST

template <typename Range, typename T, typename Projection = identity>
constexpr auto find(Range&& range, const T& value, Projection projection = {}) {
  return ranges::find_if(
      range, [&](const auto& a) { return a == value; }, projection);
}
template <typename Range, typename T, typename Projection = identity>
constexpr auto count(Range&& range, const T& value, Projection projection = {}) {
  return ranges::count_if(
      range, [&](const auto& a) { return a == value; }, projection);
}

#define SPLATLAS_ORDER(name)                                                                         \
  template <typename Range, typename Compare = less, typename Projection = identity>                 \
  constexpr auto name(Range&& range, Compare comp = {}, Projection projection = {}) {                \
    return std::name(std::begin(range), std::end(range), ranges::projected_order(comp, projection)); \
  }
SPLATLAS_ORDER(sort)
SPLATLAS_ORDER(stable_sort)
SPLATLAS_ORDER(is_sorted)
SPLATLAS_ORDER(max_element)
SPLATLAS_ORDER(min_element)
#undef SPLATLAS_ORDER

template <typename Range>
constexpr auto max(const Range& range) {
  return *std::max_element(std::begin(range), std::end(range));
}

template <input_or_output_iterator It, typename T, typename Compare = less, typename Projection = identity>
constexpr It lower_bound(It first, It last, const T& value, Compare comp = {}, Projection projection = {}) {
  return std::lower_bound(first, last, value,
                          [&](const auto& a, const T& b) { return invoke(comp, invoke(projection, a), b); });
}
template <typename Range, typename T, typename Compare = less, typename Projection = identity>
requires(!input_or_output_iterator<remove_cvref_t<Range>>) constexpr auto lower_bound(
    Range&& range, const T& value, Compare comp = {}, Projection projection = {}) {
  return ranges::lower_bound(std::begin(range), std::end(range), value, comp, projection);
}
template <typename Range, typename T, typename Compare = less, typename Projection = identity>
constexpr auto upper_bound(Range&& range, const T& value, Compare comp = {}, Projection projection = {}) {
  return std::upper_bound(std::begin(range), std::end(range), value,
                          [&](const T& a, const auto& b) { return invoke(comp, a, invoke(projection, b)); });
}

template <typename Range, typename Out>
constexpr Out copy(Range&& range, Out out) {
  return std::copy(std::begin(range), std::end(range), out);
}

}  // namespace ranges
}  // namespace std
