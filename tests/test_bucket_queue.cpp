#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "meshops/shape/bucket_queue.hpp"

using namespace tri;

TEST_CASE("bucket queue: hands out every item once, in order of cost to within a hundredth") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-20, 20);
  std::vector<double> costs;
  BucketQueue queue(5000);
  for (std::uint32_t i = 0; i < 5000; ++i) {
    costs.push_back(std::exp(exponent(random)));
    queue.push(i, BucketQueue::bucket_of(costs[i]));
    CHECK(queue.contains(i));
  }
  std::vector<int> seen(5000, 0);
  double last = 0;
  for (int k = 0; k < 5000; ++k) {
    const std::uint32_t item = queue.pop();
    REQUIRE(item < 5000);
    CHECK_FALSE(queue.contains(item));
    ++seen[item];
    CHECK(costs[item] >= last / 1.01);
    last = std::max(last, costs[item]);
  }
  CHECK(queue.pop() == BucketQueue::none);
  CHECK(std::count(seen.begin(), seen.end(), 1) == 5000);
}

TEST_CASE("bucket queue: within a bucket the first to enter leaves first; nothing enters below the current bucket") {
  BucketQueue queue(4);
  queue.push(2, BucketQueue::bucket_of(5));
  queue.push(1, BucketQueue::bucket_of(5));
  CHECK(queue.pop() == 2);
  queue.push(3, BucketQueue::bucket_of(1));
  queue.push(0, BucketQueue::bucket_of(9));
  CHECK(queue.pop() == 1);
  CHECK(queue.pop() == 3);
  queue.push(1, queue.current());
  CHECK(queue.pop() == 1);
  CHECK(queue.pop() == 0);
  CHECK(queue.pop() == BucketQueue::none);
}

TEST_CASE("bucket queue: costs without bound and tiny ones have a bucket") {
  CHECK(BucketQueue::bucket_of(0) == 0);
  CHECK(BucketQueue::bucket_of(1e-300) == 0);
  CHECK(BucketQueue::bucket_of(1e300) == BucketQueue::bucket_of(3.2e38));
  CHECK(BucketQueue::bucket_of(std::nan("")) == BucketQueue::bucket_of(1e300));
}
