#include "meshops/holes/elimination_order.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <span>

#include "meshops/holes/sparse_cholesky.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

constexpr double least_share = 0.3;  ///< of a piece: the smaller of its two parts, at least

class Dissection {
 public:
  Dissection(const SparseColumns& a, const EliminationLimits& limits, const Context& context)
      : a_(a), limits_(limits), context_(context), pace_(context), order_(static_cast<std::size_t>(a.columns())),
        piece_(order_.size(), 0), nearness_(order_.size(), 0), level_(order_.size(), unreached) {
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<std::int32_t>(i);
  }

  std::vector<std::int32_t> run() {
    // Places in `order_` that hold a piece, whose unknowns carry the number of the piece.
    std::vector<Range> waiting{{0, order_.size(), 0}};
    while (!waiting.empty()) {
      const Range range = waiting.back();
      waiting.pop_back();
      if (range.end == range.begin) continue;
      context_.checkpoint();
      if (entries_of(range) <= (range.divided ? limits_.few : limits_.at_once) || !divide(range, waiting))
        order_at_once(range);
    }
    return std::move(order_);
  }

 private:
  static constexpr std::int32_t unreached = -1;
  struct Range {
    std::size_t begin, end;
    std::int32_t piece;
    bool divided = false;  ///< it has something beside it that comes later
  };

  std::span<std::int32_t> in(const Range& range) {
    return std::span(order_).subspan(range.begin, range.end - range.begin);
  }
  std::span<const std::int32_t> neighbors(std::int32_t i) const {
    return std::span(a_.row.data() + a_.first[i], a_.row.data() + a_.first[i + 1]);
  }
  std::int64_t entries_of(const Range& range) {
    std::int64_t sum = 0;
    for (const std::int32_t i : in(range)) sum += a_.first[i + 1] - a_.first[i];
    return sum;
  }

  /// Appends those of a piece that hang together with one, by their distance from it.
  void reach(std::int32_t start, const Range& range) {
    std::size_t k = reached_.size();
    reached_.push_back(start);
    level_[start] = 0;
    for (; k < reached_.size(); ++k) {
      pace_();
      const std::int32_t i = reached_[k];
      for (const std::int32_t j : neighbors(i)) {
        if (piece_[j] != range.piece || level_[j] != unreached) continue;
        level_[j] = level_[i] + 1;
        reached_.push_back(j);
      }
    }
  }
  void search(std::int32_t start, const Range& range) {
    for (const std::int32_t i : reached_) level_[i] = unreached;
    reached_.clear();
    reach(start, range);
  }

  /// What does not hang together becomes several pieces, small ones together. The search has reached the first.
  void separate(const Range& range, std::vector<Range>& waiting) {
    std::vector<std::size_t> ends;  // of pieces, in `reached_`
    std::int64_t entries = 0;
    std::size_t counted = 0;
    const auto count = [&] {
      std::int64_t more = 0;
      for (std::size_t k = counted; k < reached_.size(); ++k) more += a_.first[reached_[k] + 1] - a_.first[reached_[k]];
      if (entries > 0 && 4 * (entries + more) > limits_.at_once) ends.push_back(counted), entries = 0;
      entries += more;
      counted = reached_.size();
    };
    count();
    for (const std::int32_t i : in(range)) {
      if (level_[i] != unreached) continue;
      reach(i, range);
      count();
    }
    ends.push_back(reached_.size());
    std::size_t k = 0;
    for (const std::size_t end : ends) {
      waiting.push_back({range.begin + k, range.begin + end, ++pieces_, range.divided});
      for (; k < end; ++k) piece_[reached_[k]] = pieces_, order_[range.begin + k] = reached_[k];
    }
  }

  /// Parts a piece into two that have no entry in common and what is needed between them. @return whether that is
  /// possible
  bool divide(const Range& range, std::vector<Range>& waiting) {
    search(order_[range.begin], range);
    const std::size_t size = range.end - range.begin;
    if (reached_.size() < size) {
      separate(range, waiting);
      return true;
    }
    // Nearer to one of two that are far apart, or to the other: between them the cut is short.
    search(reached_.back(), range);
    for (const std::int32_t i : reached_) nearness_[i] = level_[i];
    search(reached_.back(), range);
    const std::int32_t most = level_[reached_.back()];
    for (const std::int32_t i : reached_) nearness_[i] += most - level_[i];
    const auto shifted = [&](std::int32_t i) { return static_cast<std::size_t>(nearness_[i]); };
    std::vector<std::size_t> count(2 * static_cast<std::size_t>(most) + 2, 0);
    for (const std::int32_t i : reached_) ++count[shifted(i)];
    std::size_t below = 0, best = count.size(), fewest = size;
    const auto least = static_cast<std::size_t>(least_share * static_cast<double>(size));
    for (std::size_t c = 0; c + 1 < count.size(); ++c) {
      below += count[c];
      if (below < least || size - below < least || count[c] + count[c + 1] >= fewest) continue;
      fewest = count[c] + count[c + 1];
      best = c;
    }
    if (best == count.size()) return false;
    const auto cut = static_cast<std::int32_t>(best);
    const auto beside = [&](std::int32_t i) {
      const bool low = nearness_[i] <= cut;
      return std::ranges::any_of(
          neighbors(i), [&](std::int32_t j) { return piece_[j] == range.piece && (nearness_[j] <= cut) != low; });
    };
    std::size_t beside_low = 0, beside_high = 0;
    for (const std::int32_t i : reached_) {
      pace_();
      if (beside(i)) ++(nearness_[i] <= cut ? beside_low : beside_high);
    }
    const bool from_low = beside_low <= beside_high;
    part(range, waiting, [&](std::int32_t i) {
      const bool low = nearness_[i] <= cut;
      return low == from_low && beside(i) ? 2 : low ? 0 : 1;
    });
    return true;
  }

  /// @param part_of  0 or 1: one of two parts, which wait; 2: comes after both, in the order that there is
  template <class PartOf>
  void part(const Range& range, std::vector<Range>& waiting, const PartOf& part_of) {
    std::vector<std::int32_t> parts[3];
    for (const std::int32_t i : in(range)) {
      pace_();
      parts[part_of(i)].push_back(i);
    }
    std::size_t at = range.begin;
    for (int p = 0; p < 3; ++p) {
      const std::int32_t number = ++pieces_;
      if (p < 2) waiting.push_back({at, at + parts[p].size(), number, true});
      for (const std::int32_t i : parts[p]) piece_[i] = number, order_[at++] = i;
    }
  }

  /// By approximate minimum degree.
  void order_at_once(const Range& range) {
    const std::vector<std::int32_t> given(in(range).begin(), in(range).end());
    std::vector<std::int32_t>& number = level_;  // of the unknowns within the piece
    for (std::size_t k = 0; k < given.size(); ++k) number[given[k]] = static_cast<std::int32_t>(k);
    Eigen::SparseMatrix<double> pattern(static_cast<Eigen::Index>(given.size()),
                                        static_cast<Eigen::Index>(given.size()));
    std::vector<std::int32_t> rows;
    pattern.reserve(static_cast<Eigen::Index>(entries_of(range)));
    for (std::size_t k = 0; k < given.size(); ++k) {
      rows.clear();
      for (const std::int32_t j : neighbors(given[k]))
        if (piece_[j] == range.piece) rows.push_back(number[j]);
      std::sort(rows.begin(), rows.end());
      pattern.startVec(static_cast<Eigen::Index>(k));
      for (const std::int32_t r : rows) pattern.insertBack(r, static_cast<Eigen::Index>(k)) = 1;
    }
    pattern.finalize();
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> found;
    Eigen::AMDOrdering<int>()(pattern, found);
    for (std::size_t k = 0; k < given.size(); ++k) {
      order_[range.begin + k] = given[static_cast<std::size_t>(found.indices()[static_cast<Eigen::Index>(k)])];
      number[given[k]] = unreached;
    }
  }

  const SparseColumns& a_;
  const EliminationLimits limits_;
  const Context& context_;
  Pace pace_;
  std::vector<std::int32_t> order_;
  std::vector<std::int32_t> piece_;     ///< of each unknown
  std::vector<std::int32_t> nearness_;  ///< to one side of the piece that is being divided
  std::vector<std::int32_t> level_;     ///< of each unknown that the last search reached
  std::vector<std::int32_t> reached_;   ///< by it, in its order
  std::int32_t pieces_ = 0;
};

}  // namespace

std::vector<std::int32_t> elimination_order(const SparseColumns& a, const Context& context,
                                            const EliminationLimits& limits) {
  return Dissection(a, limits, context).run();
}

}  // namespace tri
