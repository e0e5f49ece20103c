// SPDX-License-Identifier: GPL-3.0-or-later
// The table of operations, and that docs/scene-format.md tells all of it.
#include "program/operation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

namespace wardmis {
namespace {

// The rows of the tables of "## Programs", by the names in their first column.
std::map<std::string, std::string> documented() {
  std::ifstream file(WARDMIS_TEST_DATA "/../docs/scene-format.md");
  std::map<std::string, std::string> rows;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("## ")) inside = line == "## Programs";
    if (!inside || !line.starts_with("| `")) continue;
    const size_t end = line.find(" |", 1);
    for (size_t a = line.find('`'); a < end; a = line.find('`', a)) {
      const size_t b = line.find('`', a + 1);
      rows[line.substr(a + 1, b - a - 1)] = line;
      a = b + 1;
    }
  }
  return rows;
}

TEST(Operations, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const OperationInfo& o : kOperations) {
    EXPECT_TRUE(names.insert(o.name).second) << o.name;
    EXPECT_EQ(o.arguments.find_first_not_of("nv"), std::string_view::npos) << o.name;
  }
}

TEST(Operations, AreAllDocumentedAndNoneBesides) {
  std::map<std::string, std::string> rows = documented();
  for (const OperationInfo& o : kOperations) EXPECT_EQ(rows.erase(std::string(o.name)), 1u) << o.name;
  for (const auto& [name, row] : rows) ADD_FAILURE() << "no such operation: " << name;
}

TEST(Operations, HaveTheirParametersDocumented) {
  std::ifstream file(WARDMIS_TEST_DATA "/../docs/scene-format.md");
  std::stringstream text;
  text << file.rdbuf();
  for (const OperationInfo& o : kOperations)
    for (const Parameter& p : o.parameters) {
      EXPECT_NE(text.str().find(fmt::format("`{}`", p.name)), std::string::npos) << o.name << ": " << p.name;
      for (const std::string_view choice : p.choices) {
        if (choice.empty()) continue;
        EXPECT_NE(text.str().find(fmt::format("`\"{}\"`", choice)), std::string::npos) << o.name << ": " << choice;
      }
    }
}

}  // namespace
}  // namespace wardmis
