// Highway compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "format/codec/value_filter.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include "format/codec/value_filter.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <typename Lane>
HWY_INLINE void FilterValues(const FilterInput<Lane>& input, std::size_t count,
                             const FilterOutput<Lane>& output) {
  const hn::ScalableTag<Lane> d;
  static_assert(HWY_MAX_BYTES <= kFilterPadding);
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    auto sum = hn::Set(d, kWeightUnit / 2), rest = hn::Set(d, kWeightUnit);
    for (std::size_t q = 0; q < kNeighbours.size(); ++q) {
      const auto weight = hn::Set(d, input.weights[q]);
      const auto value = hn::LoadU(d, input.values[q] + n);
      const auto absent = hn::BroadcastSignBit(value);
      sum = hn::Add(sum, hn::Mul(weight, hn::AndNot(absent, value)));
      rest = hn::Sub(rest, hn::AndNot(absent, weight));
    }
    hn::StoreU(sum, d, output.sums + n);
    hn::StoreU(rest, d, output.rest + n);
  }
}

template <typename Lane>
HWY_INLINE void SumErrors(const FilterInput<Lane>& input, std::size_t count,
                          const FilterOutput<Lane>& output) {
  const hn::ScalableTag<std::uint8_t> d;
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    auto sum = hn::LoadU(d, input.errors[0] + n);
    for (std::size_t q = 1; q < kErrorNeighbours; ++q)
      sum = hn::SaturatedAdd(sum, hn::LoadU(d, input.errors[q] + n));
    hn::StoreU(sum, d, output.errors + n);
  }
}

void Filter16(const FilterInput<std::int16_t>& input, std::size_t count,
              const FilterOutput<std::int16_t>& output) {
  FilterValues(input, count, output);
  SumErrors(input, count, output);
}

void Filter32(const FilterInput<std::int32_t>& input, std::size_t count,
              const FilterOutput<std::int32_t>& output) {
  FilterValues(input, count, output);
  SumErrors(input, count, output);
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace splatlas {

HWY_EXPORT(Filter16);
HWY_EXPORT(Filter32);

void filter_run(const FilterInput<std::int16_t>& input, std::size_t count,
                const FilterOutput<std::int16_t>& output) {
  HWY_DYNAMIC_DISPATCH(Filter16)(input, count, output);
}

void filter_run(const FilterInput<std::int32_t>& input, std::size_t count,
                const FilterOutput<std::int32_t>& output) {
  HWY_DYNAMIC_DISPATCH(Filter32)(input, count, output);
}

}  // namespace splatlas
#endif  // HWY_ONCE
