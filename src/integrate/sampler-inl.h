// The random numbers of sampler.h for many pixels at once, for one sample. Included once per
// instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_SAMPLER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_SAMPLER_INL_H_
#undef RAIO_INTEGRATE_SAMPLER_INL_H_
#else
#define RAIO_INTEGRATE_SAMPLER_INL_H_
#endif

#include "base/wide-inl.h"
#include "integrate/sampler.h"
#include "integrate/screen_keys.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

/// The pixel's place as sampler.h has it. `far`: some pixel's row or column is above 65535.
template <class Tag>
HWY_INLINE hn::Vec<Tag> place_in_picture(Tag tag, hn::Vec<Tag> row, hn::Vec<Tag> column, bool far) {
  const auto near_place = hn::Add(hn::ShiftLeft<16>(row), column);
  if (!far) return near_place;
  const auto group = hn::Or(hn::ShiftLeft<16>(hn::ShiftRight<kGroupShift>(row)),
                            hn::ShiftRight<kGroupShift>(column));
  const auto hash = hash4(tag, {group, hn::Zero(tag), hn::Zero(tag), hn::Zero(tag)}).x;
  const auto within = hn::Set(tag, (kGroup - 1) * 0x10001u);
  const auto far_place = hn::Or(hn::And(near_place, within), hn::AndNot(within, hash));
  return hn::IfThenElse(hn::Eq(hn::ShiftRight<16>(hn::Or(row, column)), hn::Zero(tag)), near_place,
                        far_place);
}

template <class D>
class WideSampler {
 public:
  using V = hn::Vec<D>;
  using U = hn::Vec<Unsigned<D>>;

  WideSampler(const Sampler& sampler, uint32_t sample)
      : s_(sampler),
        sample_(sample),
        permutation_(sampler.kind == SamplerKind::jitter ? sampler.permutation(sample)
                                                         : Sampler::Permutation()) {}

  uint32_t sample() const { return sample_; }

  /// In the unit pixel: its centre for one cell, else a random point in one of its cells, in an
  /// order that depends on the pixel.
  HWY_INLINE Wide2<D> in_pixel(U place) const {
    if (s_.aa == 1) return {hn::Set(d, 0.5f), hn::Set(d, 0.5f)};
    const U branch = hn::Set(du, kEyeBranch);
    if (s_.kind == SamplerKind::sobol) return sobol(place, branch, kPixel);
    const V aa = hn::Set(d, float(s_.aa));
    const V turn = hn::Floor(divide(d, dealt(place, branch, kPixel), s_.per_cell));
    const V row = hn::Floor(divide(d, turn, s_.aa));
    const auto r = random(place, sample_, branch, kPixel);
    return {in_cell(hn::Sub(turn, hn::Mul(row, aa)), r.x, s_.aa), in_cell(row, r.y, s_.aa)};
  }

  /// In the unit square, for the other purposes. The samples of a pixel stratify the square: one
  /// random point in each of `samples` equal cells, in an order shared by the pixel's block, which
  /// keeps rays of neighbours coherent. Each pixel takes its own cells in a different order, so the
  /// pairing of pixel cells with light cells is still random.
  HWY_INLINE Wide2<D> in_square(U place, U branch, uint32_t purpose) const {
    if (s_.kind == SamplerKind::sobol) return sobol(place, branch, purpose);
    const U block = hn::And(hn::ShiftRight<kBlockShift>(place), hn::Set(du, 0x3fff3fffu));
    const V cell = dealt(block, branch, purpose), columns = hn::Set(d, float(s_.columns));
    const V row = hn::Floor(divide(d, cell, s_.columns));
    const auto r = random(place, sample_, branch, purpose);
    return {in_cell(hn::Sub(cell, hn::Mul(row, columns)), r.x, s_.columns),
            in_cell(row, r.y, s_.rows)};
  }

  /// In [0, 1), one random number in each of `samples` equal intervals.
  HWY_INLINE V in_unit(U place, U branch, uint32_t purpose) const {
    if (s_.kind == SamplerKind::sobol) return sobol(place, branch, purpose).x;
    const U block = hn::And(hn::ShiftRight<kBlockShift>(place), hn::Set(du, 0x3fff3fffu));
    const U bits = random(place, sample_, branch, purpose).x;
    return in_cell(dealt(block, branch, purpose), bits, s_.samples);
  }

  /// A random word to start hashes.
  HWY_INLINE U key(U place, U branch, uint32_t purpose) const {
    return random(place, sample_, branch, purpose).x;
  }

 private:
  const D d{};
  const Unsigned<D> du{};
  const Signed<D> di{};

  HWY_INLINE Wide4<Unsigned<D>> random(U key, uint32_t sample, U branch, uint32_t purpose) const {
    return hash4(du, {key, hn::Set(du, sample), branch, hn::Set(du, s_.seed + purpose)});
  }
  // The sample's position in the permutation chosen by `key`: 0 .. samples - 1.
  HWY_INLINE V dealt(U key, U branch, uint32_t purpose) const {
    const auto order = random(key, ~0u, branch, purpose);
    const auto [first, count] = Sampler::share(purpose);
    const U which = hn::Add(hn::And(order.x, hn::Set(du, count - 1)), hn::Set(du, first));
    U place;
    if constexpr (hn::MaxLanes(D()) == Sampler::kPermutations)  // all in one register
      place =
          hn::TableLookupLanes(hn::LoadU(du, permutation_.data()), hn::IndicesFromVec(du, which));
    else
      place = hn::GatherIndex(du, permutation_.data(), hn::BitCast(di, which));
    const V samples = hn::Set(d, float(s_.samples));
    const V turn = hn::Floor(hn::Mul(to_unit(d, order.y), samples));
    const V sum = hn::Add(hn::ConvertTo(d, hn::BitCast(di, place)), turn);
    return hn::IfThenElse(hn::Ge(sum, samples), hn::Sub(sum, samples), sum);
  }

  // The sample's point of Sobol's two-dimensional sequence, shuffled and scrambled after Owen 1995
  // for each group of pixels, branch and purpose, by hashing as in Burley 2020, "Practical
  // Hash-based Owen Scrambling", JCGT 9(4). Any number of samples is nearly optimally even, and
  // different purposes are independent. The pixels of a group complement each other by their keys;
  // each purpose and branch shifts that table cyclically by its own offset.
  HWY_INLINE Wide2<D> sobol(U place, U branch, uint32_t purpose) const {
    const U group = hn::And(hn::ShiftRight<kGroupShift>(place), hn::Set(du, 0x07ff07ffu));
    const auto hash = random(group, ~0u, branch, purpose);
    const U rolled = hn::And(hn::Add(place, hash.w), hn::Set(du, (kGroup - 1) * 0x10001u));
    const U at = hn::Or(rolled, hn::ShiftRight<16 - kGroupShift>(rolled));
    const U key = hn::GatherIndex(du, kScreenKeys.data(),
                                  hn::BitCast(di, hn::And(at, hn::Set(du, kGroup * kGroup - 1))));
    // Bits are in the order of the index, with the first digit of a coordinate lowest. The first
    // coordinate has the index's bits; bit j of the second is the sum modulo 2 of the index's bits
    // k with an odd binomial k over j, that is, where k has all bits of j.
    const U x = reverse_bits(scramble_below(reverse_bits(hn::Set(du, sample_)), hash.x));
    U y = hn::Xor(x, hn::ShiftRight<1>(hn::And(x, hn::Set(du, 0xaaaaaaaau))));
    y = hn::Xor(y, hn::ShiftRight<2>(hn::And(y, hn::Set(du, 0xccccccccu))));
    y = hn::Xor(y, hn::ShiftRight<4>(hn::And(y, hn::Set(du, 0xf0f0f0f0u))));
    y = hn::Xor(y, hn::ShiftRight<8>(hn::And(y, hn::Set(du, 0xff00ff00u))));
    y = hn::Xor(y, hn::ShiftRight<16>(y));
    const auto owen = [&](U bits, U seed) {
      return to_unit(d, reverse_bits(scramble_below(bits, seed)));
    };
    return {owen(hn::Xor(x, hn::And(key, hn::Set(du, 0xffffu))), hash.y),
            owen(hn::Xor(y, hn::ShiftRight<16>(key)), hash.z)};
  }
  // Flips each bit depending on a hash of the lower bits (Laine and Karras 2011; constants from
  // Vegdahl 2021, "Building a Better LK Hash").
  HWY_INLINE U scramble_below(U v, U seed) const {
    v = hn::Xor(v, hn::Mul(v, hn::Set(du, 0x3d20adeau)));
    v = hn::Add(v, seed);
    v = hn::Mul(v, hn::Or(hn::ShiftRight<16>(seed), hn::Set(du, 1)));
    v = hn::Xor(v, hn::Mul(v, hn::Set(du, 0x05526c56u)));
    return hn::Xor(v, hn::Mul(v, hn::Set(du, 0x53a22864u)));
  }
  HWY_INLINE U reverse_bits(U v) const {
    const auto swap = [&]<int kBy>(U a, uint32_t low) {
      const U mask = hn::Set(du, low);
      return hn::Or(hn::ShiftLeft<kBy>(hn::And(a, mask)), hn::And(hn::ShiftRight<kBy>(a), mask));
    };
    v = swap.template operator()<1>(v, 0x55555555u);
    v = swap.template operator()<2>(v, 0x33333333u);
    v = swap.template operator()<4>(v, 0x0f0f0f0fu);
    v = swap.template operator()<8>(v, 0x00ff00ffu);
    return hn::Or(hn::ShiftLeft<16>(v), hn::ShiftRight<16>(v));
  }

  HWY_INLINE V in_cell(V cell, U bits, uint32_t cells) const {
    return divide(d, hn::Add(cell, to_unit(d, bits)), cells);
  }

  const Sampler& s_;
  uint32_t sample_;
  Sampler::Permutation permutation_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
