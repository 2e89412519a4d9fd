#include "base/array.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

namespace raio {
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

TEST(Array, ZeroesAreBorrowedUntilOneChanges) {
  Array<int> a = Array<int>::zeroes(3);
  EXPECT_TRUE(a.is_borrowed());
  EXPECT_THAT(a, ElementsAre(0, 0, 0));
  Array<int> copy = a;
  copy[1] = 2;
  EXPECT_THAT(copy, ElementsAre(0, 2, 0));
  EXPECT_THAT(a, ElementsAre(0, 0, 0));
  EXPECT_TRUE(Array<int>::zeroes(0).empty());
}

TEST(Array, CopiesAndMovesWhatItOwns) {
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

TEST(Array, GathersStridedElements) {
  struct Row {
    float x, y, z;
  };
  const Row rows[] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  const auto y = Array<float>::borrow(&rows[0].y, 3, nullptr, sizeof(Row));
  EXPECT_THAT(y, ElementsAre(2, 5, 8));
  EXPECT_FALSE(y.is_borrowed());
  const auto backwards = Array<float>::borrow(&rows[2].z, 3, nullptr, -ptrdiff_t(sizeof(Row)));
  EXPECT_THAT(backwards, ElementsAre(9, 6, 3));
  const auto same = Array<float>::borrow(&rows[1].x, 4, nullptr, 0);
  EXPECT_THAT(same, ElementsAre(4, 4, 4, 4));
  alignas(4) char bytes[9];
  const float value = 2.5f;
  std::memcpy(bytes + 1, &value, sizeof value);
  std::memcpy(bytes + 5, &value, sizeof value);
  const auto odd = Array<float>::borrow(bytes + 1, 2, nullptr);
  EXPECT_THAT(odd, ElementsAre(2.5f, 2.5f));
  EXPECT_FALSE(odd.is_borrowed());
}

}  // namespace
}  // namespace raio
