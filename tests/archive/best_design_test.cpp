#include "trebsweep/archive/best_design.hpp"

#include <algorithm>
#include <vector>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

BestDesign design_of(double value, const Design<double>& design = {1, 1, 1}) {
  BestDesign best;
  best.value = value;
  best.design = design;
  return best;
}

}  // namespace

TEST_CASE("The better design has the larger value, and of equal ones is the first in the lattice") {
  CHECK(better(design_of(-2), design_of(-3)).value == -2);
  CHECK(better(design_of(-3), design_of(-2)).value == -2);
  const std::vector<Design<double>> in_order{{.r1 = 1, .r3 = 2, .r2 = 9},
                                             {.r1 = 1, .r3 = 3, .r2 = 7},
                                             {.r1 = 1, .r3 = 3, .r2 = 8},
                                             {.r1 = 2, .r3 = 1, .r2 = 1}};
  for (std::size_t i = 0; i < in_order.size(); ++i)
    for (std::size_t j = 0; j < in_order.size(); ++j)
      CHECK(better(design_of(5, in_order[i]), design_of(5, in_order[j])).design ==
            in_order[std::min(i, j)]);
}

TEST_CASE("A design is better than none") {
  CHECK_FALSE(BestDesign{}.exists());
  CHECK(better(design_of(-1e300), {}).value == -1e300);
  CHECK(better({}, design_of(-1e300)).value == -1e300);
  CHECK_FALSE(better({}, {}).exists());
}

TEST_CASE("The best scene is the first with the largest value, wherever its design lies") {
  const BestDesign early = design_of(7, {1, 1, 1}), late = design_of(7, {2, 2, 2});
  CHECK(best_scene(std::vector{BestDesign{}, design_of(6), late, early, BestDesign{}}) == 2u);
  CHECK_FALSE(best_scene(std::vector<BestDesign>(3)));
  CHECK_FALSE(best_scene({}));
}

TEST_CASE("The numbers of a design are its members in the order of their names") {
  BestDesign best = design_of(1, {.r1 = 3, .r3 = 4, .r2 = 5});
  best.speed = 2;
  best.release_time = 6;
  best.error = 7;
  CHECK(to_numbers(best) == BestNumbers{1, 2, 3, 4, 5, 6, 7});
  CHECK(to_numbers(to_best_design(to_numbers(best))) == to_numbers(best));
  CHECK(best_names[3] == "best_r3");
}
