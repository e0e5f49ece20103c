// SPDX-License-Identifier: GPL-3.0-or-later
// `./dev bench`: how many million evaluations (f and pdf) and samples of Ward a core does in a second, what a look at
// each pattern takes, and what a program costs a hit, as tables.
#include <fmt/format.h>

#include "bsdf/loops.h"
#include "integrate/bench_program.h"
#include "pattern/bench_patterns.h"

int main() {
  using namespace wardmis;
  using namespace wardmis::test;
  Directions d(1024);
  const auto rate = [&](double seconds) { return d.count() / seconds * 1e-6; };
  const auto row = [&](const char* name, Evaluate evaluate, Sample sample) {
    const auto [e, s] = bestSeconds(
        20000, [&] { d.evaluate(evaluate); }, [&] { d.sample(sample); });
    fmt::print("| {} | {:.0f} | {:.0f} |\n", name, rate(e), rate(s));
  };
  fmt::print("| float, batches of {} | evaluations (f and pdf), M/s | samples, M/s |\n|---|---:|---:|\n", d.count());
  for (const Loops& l : loops())
    if (l.here) row(l.name, l.evaluate, l.sample);
  const auto [e] = bestSeconds(20000, [&] { d.evaluate(wardBatch); });
  fmt::print("| the renderer's batch here ({}) | {:.0f} | |\n", clonedFor(), rate(e));
  benchPatterns();
  benchProgram();
}
