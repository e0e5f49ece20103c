// SPDX-License-Identifier: GPL-3.0-or-later
// What the reader did not load, and why: told once a kind, counted, for Scene::leftOut and Scene::lacking.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

namespace wardmis {

class LeftOut {
 public:
  // What the image then lacks, or shows otherwise.
  void add(const std::string& what, const std::string& why) { lacking_.add(what, why); }
  // What the image is the same without.
  void addUnneeded(const std::string& what, const std::string& why) { unneeded_.add(what, why); }

  std::vector<std::string> lacking() const { return lacking_.list(); }
  std::vector<std::string> unneeded() const { return unneeded_.list(); }

 private:
  static constexpr size_t kMost = 200;

  class Entries {
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
    struct Entry {
      std::string what, why;
      size_t count;
    };
    std::vector<Entry> entries_;
    std::unordered_map<std::string, size_t> index_;
    size_t more_ = 0;
  };
  Entries lacking_, unneeded_;
};

}  // namespace wardmis
