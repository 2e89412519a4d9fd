#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "base/strided_array.h"

namespace raio::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Numbers that report when their last owner is gone.
struct Kept {
  std::shared_ptr<std::vector<int>> numbers =
      std::make_shared<std::vector<int>>(std::vector{1, 2, 3});
  std::weak_ptr<std::vector<int>> alive = numbers;

  Array<int> borrow() { return Array<int>::borrow(numbers->data(), numbers->size(), numbers); }
};

TEST(Array, OwnsLikeAVector) {
  Array<int> a = {1, 2};
  EXPECT_FALSE(a.is_borrowed());
  a.push_back(3);
  a.emplace_back(4) = 5;
  EXPECT_THAT(a, ElementsAre(1, 2, 3, 5));
  EXPECT_EQ(a.back(), 5);
  a.pop_back();
  const std::vector more = {7, 8};
  a.insert(a.end(), more.begin(), more.end());
  EXPECT_THAT(a, ElementsAre(1, 2, 3, 7, 8));
  a.insert(a.begin() + 1, size_t(2), 6);
  EXPECT_THAT(a, ElementsAre(1, 6, 6, 2, 3, 7, 8));
  a.insert(a.end(), {4, 4});
  EXPECT_EQ(a.at(8), 4);
  EXPECT_THROW(std::ignore = a.at(9), std::out_of_range);
  a = {1, 2, 3};
  a.resize(2);
  a.resize(3, 9);
  EXPECT_THAT(a, ElementsAre(1, 2, 9));
  std::ranges::sort(a, std::greater());
  EXPECT_THAT(a, ElementsAre(9, 2, 1));
  a.reserve(100);
  EXPECT_GE(a.capacity(), 100u);
  EXPECT_THAT(a, ElementsAre(9, 2, 1));
  a.assign(2, 4);
  EXPECT_EQ(a, Array<int>(std::vector{4, 4}));
  EXPECT_FALSE(a == Array<int>({4, 5}));
  a.clear();
  EXPECT_TRUE(a.empty());
}

TEST(Array, CopiesShareUntilOneChanges) {
  Array<int> a = {1, 2, 3};
  const Array<int> copy = a;
  EXPECT_EQ(copy.data(), std::as_const(a).data());
  EXPECT_TRUE(copy.shares(a));
  a[1] = 7;
  EXPECT_FALSE(copy.shares(a));
  EXPECT_THAT(copy, ElementsAre(1, 2, 3));
  EXPECT_THAT(a, ElementsAre(1, 7, 3));
  // Alone again, it changes in place.
  const int* const place = std::as_const(a).data();
  a[0] = 4;
  EXPECT_EQ(std::as_const(a).data(), place);
}

TEST(Array, AppendsShareIfThereIsNothingBefore) {
  const Array<int> more = {1, 2};
  Array<int> a;
  a.append(more);
  EXPECT_TRUE(a.shares(more));
  a.append(more);
  EXPECT_THAT(a, ElementsAre(1, 2, 1, 2));
  EXPECT_THAT(more, ElementsAre(1, 2));
}

TEST(Array, CopiesAndMovesOwnedElements) {
  Array<int> a = {1, 2, 3};
  Array<int> copy = a;
  copy[0] = 9;
  EXPECT_THAT(a, ElementsAre(1, 2, 3));
  const int* const place = std::as_const(a).data();
  const Array<int> moved = std::move(a);
  EXPECT_EQ(moved.data(), place);
  EXPECT_THAT(a, IsEmpty());  // NOLINT(bugprone-use-after-move): that is what is asked
  a.push_back(5);
  EXPECT_THAT(a, ElementsAre(5));
  EXPECT_THAT(moved, ElementsAre(1, 2, 3));
}

TEST(Array, BorrowsInPlaceAndKeepsAlive) {
  Kept kept;
  {
    const Array<int> a = kept.borrow();
    EXPECT_TRUE(a.is_borrowed());
    EXPECT_EQ(a.data(), kept.numbers->data());
    const Array<int> copy = a;
    EXPECT_EQ(copy.data(), a.data());
    kept.numbers.reset();
    EXPECT_THAT(copy, ElementsAre(1, 2, 3));
    EXPECT_FALSE(kept.alive.expired());
  }
  EXPECT_TRUE(kept.alive.expired());
}

TEST(Array, CopiesBorrowedElementsOnWrite) {
  const auto unchanged = [](const char* what, auto change, const std::vector<int>& expected) {
    SCOPED_TRACE(what);
    Kept kept;
    Array<int> a = kept.borrow();
    change(a);
    EXPECT_EQ(a, Array<int>(expected));
    EXPECT_EQ(*kept.numbers, (std::vector{1, 2, 3}));
    EXPECT_FALSE(a.is_borrowed());
    kept.numbers.reset();
    EXPECT_TRUE(kept.alive.expired()) << "what is no longer read is let go";
  };
  unchanged("element", [](auto& a) { a[1] = 5; }, {1, 5, 3});
  unchanged("iterator", [](auto& a) { *a.begin() = 5; }, {5, 2, 3});
  unchanged("back", [](auto& a) { a.back() = 5; }, {1, 2, 5});
  unchanged("push_back", [](auto& a) { a.push_back(4); }, {1, 2, 3, 4});
  unchanged("resize", [](auto& a) { a.resize(2); }, {1, 2});
  const std::vector more = {7, 8};
  unchanged("insert", [&](auto& a) { a.insert(a.end(), more.begin(), more.end()); },
            {1, 2, 3, 7, 8});
  unchanged("assign", [](auto& a) { a.assign(1, 6); }, {6});
  unchanged("clear", [](auto& a) { a.clear(); }, {});
  unchanged("moved into", [](auto& a) { a = Array<int>{8}; }, {8});
}

TEST(Array, AppendsItsOwnElement) {
  Kept kept;
  Array<int> a = kept.borrow();
  kept.numbers.reset();
  const Array<int>& same = a;
  a.push_back(same[1]);
  EXPECT_THAT(a, ElementsAre(1, 2, 3, 2));
}

TEST(Array, CopiesUnalignedMemory) {
  alignas(4) char bytes[9];
  const float value = 2.5f;
  std::memcpy(bytes + 1, &value, sizeof value);
  std::memcpy(bytes + 5, &value, sizeof value);
  const auto odd = Array<float>::borrow(bytes + 1, 2, nullptr);
  EXPECT_THAT(odd, ElementsAre(2.5f, 2.5f));
  EXPECT_FALSE(odd.is_borrowed());
}

struct Ball {
  float x = 0, y = 0, radius = 0;
  friend bool operator==(const Ball&, const Ball&) = default;
};

}  // namespace

template <>
inline constexpr std::array kMemberOffsets<Ball> = {offsetof(Ball, x), offsetof(Ball, radius)};

namespace {

TEST(StridedArray, ReadsMembersInPlace) {
  auto places = std::make_shared<std::vector<float>>(std::vector<float>{1, 2, 0, 3, 4, 0});
  const std::weak_ptr alive = places;
  const float radii[] = {5, 6};
  {
    // Every third number, and from the end to the beginning.
    const auto balls = StridedArray<Ball>::borrow(
        {{{places->data(), 3 * sizeof(float)}, {radii + 1, -ptrdiff_t(sizeof(float))}}}, 2, places);
    places.reset();
    EXPECT_THAT(balls, ElementsAre(Ball{1, 2, 6}, Ball{3, 4, 5}));
    EXPECT_TRUE(balls.is_borrowed());
    EXPECT_EQ(balls.bytes(), 2 * sizeof(Ball));
    EXPECT_EQ(*static_cast<const float*>(balls.address(1)), 3);
    StridedArray<Ball> changed = balls;
    EXPECT_TRUE(changed.shares(balls));
    changed[1].radius = 9;
    EXPECT_THAT(std::as_const(changed), ElementsAre(Ball{1, 2, 6}, Ball{3, 4, 9}));
    EXPECT_THAT(balls, ElementsAre(Ball{1, 2, 6}, Ball{3, 4, 5}));
    EXPECT_FALSE(changed.is_borrowed());
    EXPECT_FALSE(alive.expired());
    changed.append(balls);
    EXPECT_EQ(changed.size(), 4u);
    EXPECT_EQ(std::as_const(changed)[3], (Ball{3, 4, 5}));
  }
  EXPECT_TRUE(alive.expired()) << "what is no longer read is let go";
}

TEST(StridedArray, ContiguousStructsAreAnArray) {
  const Ball balls[] = {{1, 2, 3}, {4, 5, 6}};
  const auto all = StridedArray<Ball>::borrow(
      {{{&balls[0].x, sizeof(Ball)}, {&balls[0].radius, sizeof(Ball)}}}, 2, nullptr);
  EXPECT_EQ(all.address(0), balls);
  EXPECT_EQ(all.packed().is_borrowed(), true);
  EXPECT_THAT(all, ElementsAre(balls[0], balls[1]));
}

TEST(StridedArray, OneValueForAllTakesTheMemoryOfOne) {
  StridedArray<uint32_t> ids;
  ids.assign(1000, 7);
  EXPECT_EQ(ids.size(), 1000u);
  EXPECT_EQ(ids.bytes(), sizeof(uint32_t));
  ids.resize(2000, 7);
  EXPECT_EQ(ids.bytes(), sizeof(uint32_t));
  EXPECT_EQ(std::as_const(ids)[1999], 7u);
  EXPECT_EQ(ids, StridedArray<uint32_t>(std::vector<uint32_t>(2000, 7)));
  ids.resize(2001, 8);
  EXPECT_EQ(ids.bytes(), 2001 * sizeof(uint32_t));
  EXPECT_EQ(std::as_const(ids)[1999], 7u);
  EXPECT_EQ(std::as_const(ids)[2000], 8u);
  EXPECT_THAT(StridedArray<Ball>::uniform(2, {1, 2, 3}), ElementsAre(Ball{1, 2, 3}, Ball{1, 2, 3}));
}

TEST(StridedArray, IsARandomAccessRange) {
  const auto balls = StridedArray<int>(std::vector{3, 1, 2});
  static_assert(std::ranges::random_access_range<const StridedArray<int>>);
  EXPECT_EQ(std::ranges::max(balls), 3);
  EXPECT_EQ(balls.end() - balls.begin(), 3);
  EXPECT_EQ((balls.begin() + 2)[-1], 1);
  EXPECT_TRUE(StridedArray<int>().empty());
}

}  // namespace
}  // namespace raio::core
