#include "player/page/place_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace splatlas {
namespace {

constexpr double kImpossible = std::numeric_limits<double>::infinity();
constexpr int kPositionsPerLine = 4;
constexpr std::size_t kMaxExchanges = 400, kNone = std::numeric_limits<std::size_t>::max();
/// Labels spread further apart than their anchors, so that leaders fan out.
constexpr double kFan = 1.15;
/// Distance beyond the middle, relative to the structures' width, from which leaders go to the other column.
constexpr double kMaxCrossover = 0.15;
/// Horizontal over vertical extent of leaders, at least: steeper ones run along other labels.
constexpr double kMinSlope = 0.35;

double turn(PagePoint a, PagePoint b, PagePoint c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// True if two leaders have a common point, or one comes close to the anchor of the other.
bool leaders_meet(const PlacedLabel& a, const PlacedLabel& b, const std::vector<Label>& labels,
                  double clearance) {
  const PagePoint end_a = labels[a.label].anchor, end_b = labels[b.label].anchor;
  return segments_meet(a.port, end_a, b.port, end_b) ||
         distance_to_segment(end_b, a.port, end_a) < clearance ||
         distance_to_segment(end_a, b.port, end_b) < clearance;
}

class Column {
 public:
  Column(const std::vector<Label>& labels, const LabelSpace& space, const FreeSpace& free_space, bool is_left,
         double edge, const std::vector<std::size_t>& members)
      : labels_(labels), space_(space), free_space_(free_space), left_(is_left), edge_(edge) {
    double line = kImpossible;
    for (const Label& label : labels) line = std::min(line, label.height);
    step_ = std::max(1.0, line / kPositionsPerLine);
    for (const std::size_t n : members) add(n);
    std::ranges::sort(entries_, [](const Entry& a, const Entry& b) {
      return std::pair(a.ideal, a.label) < std::pair(b.ideal, b.label);
    });
  }

  /// Possible positions of one label, the best first.
  [[nodiscard]] std::vector<PlacedLabel> candidates(std::size_t n) const {
    std::vector<PlacedLabel> list;
    for (int k = 0; k < positions(); ++k) {
      if (const PlacedLabel one = at(n, center(k)); is_allowed(one)) list.push_back(one);
    }
    const auto away = [&](const PlacedLabel& one) { return std::abs(one.port.y - ideal(n)); };
    std::ranges::stable_sort(list, {}, away);
    return list;
  }

  /// Positions whose leaders do not meet, as far as exchanges of labels find them.
  [[nodiscard]] std::vector<PlacedLabel> placed() {
    std::vector<PlacedLabel> best;
    std::size_t least = kNone;
    for (std::size_t exchange = 0; exchange < kMaxExchanges && !entries_.empty(); ++exchange) {
      auto positions = place_in_order();
      if (!positions) {  // leave one out
        entries_.erase(std::ranges::min_element(
            entries_, {}, [this](const Entry& entry) { return labels_[entry.label].weight; }));
        least = kNone;
        continue;
      }
      const std::vector<std::array<std::size_t, 2>> meeting = meeting_leaders(*positions);
      if (meeting.size() < least) best = *std::move(positions), least = meeting.size();
      if (meeting.empty()) break;
      const auto [a, b] = meeting[exchange % meeting.size()];
      std::swap(entries_[a], entries_[b]);
    }
    return best;
  }

 private:
  struct Entry {
    std::size_t label;
    double ideal;               // vertical centre
    std::vector<bool> allowed;  // by position
  };

  [[nodiscard]] int positions() const { return static_cast<int>(space_.region.height() / step_) + 1; }
  [[nodiscard]] double center(int position) const { return space_.region.top + position * step_; }

  [[nodiscard]] PlacedLabel at(std::size_t n, double y) const {
    const Label& label = labels_[n];
    const double left = left_ ? edge_ - label.width : edge_;
    const PageBox box{left, y - 0.5 * label.height, left + label.width, y + 0.5 * label.height};
    return {n, box, left_, {left_ ? box.right + space_.leader_gap : box.left - space_.leader_gap, y}};
  }

  /// Preferred vertical centre of a label.
  [[nodiscard]] double ideal(std::size_t n) const {
    const double middle = 0.5 * (space_.region.top + space_.region.bottom);
    return middle + kFan * (labels_[n].anchor.y - middle);
  }

  void add(std::size_t n) {
    Entry entry{n, ideal(n), {}};
    for (int k = 0; k < positions(); ++k) entry.allowed.push_back(is_allowed(at(n, center(k))));
    if (std::ranges::find(entry.allowed, true) != entry.allowed.end()) entries_.push_back(std::move(entry));
  }

  [[nodiscard]] bool is_allowed(const PlacedLabel& one) const {
    const PageBox padded = one.box.grown(0.5 * space_.row_gap);
    const PagePoint anchor = labels_[one.label].anchor;
    const double inwards = left_ ? anchor.x - one.port.x : one.port.x - anchor.x;
    if (inwards < kMinSlope * std::abs(anchor.y - one.port.y)) return false;
    return contains(space_.region, one.box) && free_space_.is_free(padded) &&
           std::ranges::none_of(space_.obstacles, [&](const PageBox& other) {
             return overlap(other, padded) || segment_meets(one.port, anchor, other);
           });
  }

  /// Positions of all entries in their order, with the least sum of squared distances to the ideal ones: a
  /// shortest path by dynamic programming. None if they do not fit.
  [[nodiscard]] std::optional<std::vector<PlacedLabel>> place_in_order() const {
    const auto count = static_cast<std::size_t>(positions());
    std::vector<std::vector<int>> from(entries_.size(), std::vector<int>(count, -1));
    std::vector<double> costs(count, 0), next(count);
    std::vector<int> best(count, -1);  // position of the previous label
    for (std::size_t e = 0; e < entries_.size(); ++e) {
      const Entry& entry = entries_[e];
      const std::size_t apart = e == 0 ? 0 : separation(entries_[e - 1], entry);
      double least = e == 0 ? 0 : kImpossible;
      int least_at = -1;
      for (std::size_t k = 0; k < count; ++k) {
        if (e > 0 && k >= apart && costs[k - apart] < least) {
          least = costs[k - apart], least_at = static_cast<int>(k - apart);
        }
        const double away = center(static_cast<int>(k)) - entry.ideal;
        next[k] = entry.allowed[k] ? least + away * away : kImpossible;
        from[e][k] = least_at;
      }
      costs.swap(next);
    }
    const auto end = std::ranges::min_element(costs);
    if (*end == kImpossible) return std::nullopt;
    std::vector<PlacedLabel> placed(entries_.size());
    int k = static_cast<int>(end - costs.begin());
    for (std::size_t e = entries_.size(); e-- > 0;) {
      placed[e] = at(entries_[e].label, center(k));
      k = from[e][static_cast<std::size_t>(k)];
    }
    return placed;
  }

  [[nodiscard]] std::size_t separation(const Entry& a, const Entry& b) const {
    const double pixels = 0.5 * (labels_[a.label].height + labels_[b.label].height) + space_.row_gap;
    return static_cast<std::size_t>(std::ceil(pixels / step_));
  }

  [[nodiscard]] std::vector<std::array<std::size_t, 2>> meeting_leaders(
      const std::vector<PlacedLabel>& placed) const {
    std::vector<std::array<std::size_t, 2>> pairs;
    for (std::size_t a = 0; a < placed.size(); ++a) {
      for (std::size_t b = a + 1; b < placed.size(); ++b) {
        if (leaders_meet(placed[a], placed[b], labels_, space_.dot_clearance)) pairs.push_back({a, b});
      }
    }
    return pairs;
  }

  const std::vector<Label>& labels_;
  const LabelSpace& space_;
  const FreeSpace& free_space_;
  bool left_;
  double edge_;  // vertical line at which all labels of the column end, towards the structures
  double step_ = 1;
  std::vector<Entry> entries_;
};

/// Placed labels that break no rule beside each other.
class PlacedSet {
 public:
  PlacedSet(const std::vector<Label>& labels, const LabelSpace& space) : labels_(labels), space_(space) {}

  /// Adds the label unless it would break a rule.
  bool add(const PlacedLabel& one) {
    const bool fits = std::ranges::none_of(placed_, [&](const PlacedLabel& other) {
      return leaders_meet(one, other, labels_, space_.dot_clearance) || covers(one, other) ||
             covers(other, one);
    });
    if (fits) placed_.push_back(one);
    return fits;
  }
  [[nodiscard]] bool has(std::size_t label) const {
    return std::ranges::find(placed_, label, &PlacedLabel::label) != placed_.end();
  }
  [[nodiscard]] std::vector<PlacedLabel> by_label() && {
    std::ranges::sort(placed_, {}, &PlacedLabel::label);
    return std::move(placed_);
  }

 private:
  /// True if label `a` or its leader covers label `b`.
  [[nodiscard]] bool covers(const PlacedLabel& a, const PlacedLabel& b) const {
    return overlap(a.box.grown(0.999 * space_.row_gap), b.box) ||
           segment_meets(a.port, labels_[a.label].anchor, b.box);
  }

  const std::vector<Label>& labels_;
  const LabelSpace& space_;
  std::vector<PlacedLabel> placed_;
};

/// Vertical line at which a column ends: beside the structures, or further in if the labels are too wide.
double column_edge(const std::vector<Label>& labels, const std::vector<std::size_t>& members,
                   const LabelSpace& space, const PageBox& content, bool is_left) {
  double width = 0;
  for (const std::size_t n : members) width = std::max(width, labels[n].width);
  return is_left ? std::max(content.left - space.column_gap, space.region.left + width)
                 : std::min(content.right + space.column_gap, space.region.right - width);
}

constexpr int kCellsOnShortSide = 1024;

}  // namespace

std::vector<PlacedLabel> place_labels(const std::vector<Label>& labels, const LabelSpace& space,
                                      const FreeSpace& free_space) {
  if (labels.empty()) return {};
  const PageBox content = free_space.content().value_or(space.region);

  // Divide the labels by a vertical line: leaders of both sides never intersect
  std::vector<std::size_t> order;
  for (std::size_t n = 0; n < labels.size(); ++n) {
    if (labels[n].width <= space.region.width()) order.push_back(n);
  }
  std::ranges::sort(order, {},
                    [&](std::size_t n) { return std::pair(labels[n].anchor.x, labels[n].anchor.y); });
  const double middle = 0.5 * (content.left + content.right);
  const auto by_middle =
      std::ranges::count_if(order, [&](std::size_t n) { return labels[n].anchor.x < middle; });
  const auto half = static_cast<std::ptrdiff_t>(order.size() / 2);
  const std::ptrdiff_t slack = half / 4 + 1;  // the columns may differ that much
  const auto split = order.begin() + std::clamp(by_middle, std::max(half - slack, std::ptrdiff_t{0}),
                                                std::min(half + slack, std::ssize(order)));

  // Place both columns, and keep the largest labels that break no rule
  std::vector<Column> columns;
  std::vector<PlacedLabel> proposed;
  for (const bool is_left : {true, false}) {
    const std::vector<std::size_t> members =
        is_left ? std::vector(order.begin(), split) : std::vector(split, order.end());
    const double edge = column_edge(labels, members, space, content, is_left);
    Column& column = columns.emplace_back(labels, space, free_space, is_left, edge, members);
    for (const PlacedLabel& one : column.placed()) proposed.push_back(one);
  }
  const auto weight = [&](std::size_t n) { return labels[n].weight; };
  std::ranges::stable_sort(proposed, std::greater(),
                           [&](const PlacedLabel& one) { return weight(one.label); });
  PlacedSet placed(labels, space);
  for (const PlacedLabel& one : proposed) placed.add(one);

  // Put the others into gaps
  std::ranges::stable_sort(order, std::greater(), weight);
  for (const std::size_t n : order) {
    const double right = labels[n].anchor.x - middle;
    for (const bool is_left : {right < 0, right >= 0}) {
      const bool is_far = (is_left ? right : -right) > kMaxCrossover * content.width();
      if (placed.has(n) || is_far) break;
      const std::vector<PlacedLabel> candidates = columns[is_left ? 0 : 1].candidates(n);
      std::ranges::find_if(candidates, [&](const PlacedLabel& one) { return placed.add(one); });
    }
  }
  return std::move(placed).by_label();
}

bool segments_meet(PagePoint a, PagePoint b, PagePoint c, PagePoint d) {
  const auto side = [](double value) { return (value > 0) - (value < 0); };
  if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x)) return false;
  if (std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y)) return false;
  return side(turn(a, b, c)) * side(turn(a, b, d)) <= 0 && side(turn(c, d, a)) * side(turn(c, d, b)) <= 0;
}

bool segment_meets(PagePoint a, PagePoint b, const PageBox& box) {
  const auto inside = [&](PagePoint p) {
    return p.x >= box.left && p.x <= box.right && p.y >= box.top && p.y <= box.bottom;
  };
  if (inside(a) || inside(b)) return true;
  return segments_meet(a, b, {box.left, box.top}, {box.right, box.bottom}) ||
         segments_meet(a, b, {box.left, box.bottom}, {box.right, box.top});
}

double distance_to_segment(PagePoint point, PagePoint a, PagePoint b) {
  const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
  const double along =
      squared > 0 ? std::clamp(((point.x - a.x) * dx + (point.y - a.y) * dy) / squared, 0.0, 1.0) : 0;
  return std::hypot(point.x - a.x - along * dx, point.y - a.y - along * dy);
}

FreeSpace::FreeSpace(const PictureSize& size)
    : cell_(std::max(1, std::min(size.width, size.height) / kCellsOnShortSide)),
      columns_((size.width + cell_ - 1) / cell_),
      rows_((size.height + cell_ - 1) / cell_),
      corners_{columns_ + 1, rows_ + 1},
      sums_(corners_.pixel(0, rows_ + 1)) {}

FreeSpace::FreeSpace(const Picture& picture, float alpha) : FreeSpace(picture.size) {
  // Mark the cells that show structures
  const auto at = [this](int column, int row) -> std::uint32_t& {
    return sums_[corners_.pixel(column, row)];
  };
  for (int y = 0; y < picture.size.height; ++y) {
    for (int x = 0; x < picture.size.width; ++x) {
      if (picture.at(x, y)[3] > alpha) at(x / cell_ + 1, y / cell_ + 1) = 1;
    }
  }

  // Sum them up, and find their bounding box
  const double side = cell_;
  for (int row = 1; row <= rows_; ++row) {
    for (int column = 1; column <= columns_; ++column) {
      if (at(column, row) != 0) {
        const PageBox cell{side * (column - 1), side * (row - 1), side * column, side * row};
        if (!content_) content_ = cell;
        *content_ = {std::min(content_->left, cell.left), std::min(content_->top, cell.top),
                     std::max(content_->right, cell.right), std::max(content_->bottom, cell.bottom)};
      }
      at(column, row) += at(column - 1, row) + at(column, row - 1) - at(column - 1, row - 1);
    }
  }
}

bool FreeSpace::is_free(const PageBox& box) const {
  const auto cells = [this](double position, int count, bool up) {
    const double n = position / cell_;
    return static_cast<int>(std::clamp(up ? std::ceil(n) : std::floor(n), 0.0, static_cast<double>(count)));
  };
  const int left = cells(box.left, columns_, false), right = cells(box.right, columns_, true);
  const int top = cells(box.top, rows_, false), bottom = cells(box.bottom, rows_, true);
  if (left >= right || top >= bottom) return true;
  const auto sum = [this](int column, int row) { return sums_[corners_.pixel(column, row)]; };
  return sum(right, bottom) + sum(left, top) == sum(left, bottom) + sum(right, top);
}

}  // namespace splatlas
