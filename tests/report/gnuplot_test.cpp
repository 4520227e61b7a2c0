// SPDX-License-Identifier: MIT
#include "offline/report/gnuplot.hpp"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include <gtest/gtest.h>
#include <pugixml.hpp>

namespace {

using namespace mdhcal::offline;

void collect(pugi::xml_node node, std::multiset<std::string>& ids) {
  if (node.attribute("id")) ids.insert(node.attribute("id").value());
  for (const pugi::xml_node child : node.children()) collect(child, ids);
}

TEST(Gnuplot, DrawsFiguresThatCanShareAPage) {
  std::vector<std::vector<double>> rows;
  for (int i = 0; i < 20000; ++i) rows.push_back({i * 1.0, std::sin(i * 0.01)});  // more than a pipe holds
  rows[3][1] = std::nan("");
  std::string reason;
  const Figure one{"First", data_block("d", rows) + "plot $d with lines title 'sine'"};
  const Figure two{"Second", data_block("d", {{1, 2}, {3, 4}}) + "plot $d with points"};
  const auto drawn = draw({one, two}, reason);
  ASSERT_EQ(drawn.size(), 2u) << reason;
  std::multiset<std::string> ids;
  for (const std::string& svg : drawn) {
    pugi::xml_document document;
    ASSERT_TRUE(document.load_string(svg.c_str()));
    collect(document, ids);
  }
  EXPECT_GT(ids.size(), 10u);
  for (const std::string& id : ids) EXPECT_EQ(ids.count(id), 1u) << id;
  EXPECT_NE(drawn[0].find("<title>First</title>"), std::string::npos);
  EXPECT_NE(drawn[0].find("sine"), std::string::npos);
  EXPECT_EQ(drawn, draw({one, two}, reason));
}

TEST(Gnuplot, SaysWhyNothingWasDrawn) {
  std::string reason;
  EXPECT_TRUE(draw({{"Broken", "plot nonsense(x)"}}, reason).empty());
  EXPECT_NE(reason, "");
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  reason.clear();
  EXPECT_TRUE(draw({{"Any", "plot x"}}, reason).empty());
  setenv("PATH", path.c_str(), 1);
  EXPECT_NE(reason.find("gnuplot"), std::string::npos);
}

// Programs of that name that never end, in every way: they are stopped, with all that they started, and the reason says so.
TEST(Gnuplot, ThatNeverEndsIsStopped) {
  const std::string path = std::getenv("PATH");
  std::string pattern = "gnuplot-test-XXXXXX";
  ASSERT_NE(mkdtemp(pattern.data()), nullptr);
  const auto folder = std::filesystem::absolute(pattern);
  for (const char* script : {"sleep 1000", "cat >/dev/null; exec 1>&-; sleep 1000", "while :; do echo x; sleep 0.02; done",
                             "sleep 1000 & wait"}) {
    std::ofstream(folder / "gnuplot") << "#!/bin/sh\n" << script << '\n';
    std::filesystem::permissions(folder / "gnuplot", std::filesystem::perms::owner_all);
    setenv("PATH", (folder.string() + ':' + path).c_str(), 1);
    std::string reason;
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_TRUE(draw({{"Any", "plot x"}}, reason, std::chrono::milliseconds(300)).empty()) << script;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20)) << script;
    EXPECT_NE(reason.find("did not end in time"), std::string::npos) << script << ": " << reason;
    setenv("PATH", path.c_str(), 1);
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
