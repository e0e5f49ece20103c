// SPDX-License-Identifier: GPL-3.0-or-later
// What the reader did not load, and why: told once a kind, counted, for Scene::leftOut.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

namespace wardmis {

class LeftOut {
 public:
  void add(const std::string& what, const std::string& why) {
    const auto [entry, isNew] = index_.try_emplace(what + '\n' + why, entries_.size());
    if (!isNew)
      entries_[entry->second].count++;
    else if (entries_.size() < kMost)
      entries_.push_back({what, why, 1});
    else {
      index_.erase(entry);
      more_++;
    }
  }

  std::vector<std::string> list() const {
    std::vector<std::string> out;
    for (const Entry& e : entries_)
      out.push_back(e.what + (e.count > 1 ? " (" + std::to_string(e.count) + " times): " : ": ") + e.why);
    if (more_ > 0) out.push_back("and " + std::to_string(more_) + " more");
    return out;
  }

 private:
  static constexpr size_t kMost = 200;
  struct Entry {
    std::string what, why;
    size_t count;
  };
  std::vector<Entry> entries_;
  std::unordered_map<std::string, size_t> index_;
  size_t more_ = 0;
};

}  // namespace wardmis
