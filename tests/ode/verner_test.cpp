#include "trebsweep/ode/verner.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <vector>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;

/// A rooted tree, by the subtrees of its root.
struct Tree {
  int order = 1;          ///< number of vertices
  long long density = 1;  ///< gamma: the product of the orders of all subtrees, itself included
  std::vector<std::size_t> children = {};  ///< indices in the list of trees
};

/// Appends the trees of `order` vertices whose root has the children of `tree` and any others that
/// come not before `first` in the list.
void extend(std::vector<Tree>& trees, std::size_t first, Tree tree, int order) {
  if (tree.order == order) {
    tree.density *= order;
    trees.push_back(tree);
    return;
  }
  for (std::size_t child = first; child < trees.size(); ++child) {
    const int grown = tree.order + trees[child].order;
    if (trees[child].order == order || grown > order) return;
    Tree larger = tree;
    larger.order = grown;
    larger.density *= trees[child].density;
    larger.children.push_back(child);
    extend(trees, child, larger, order);
  }
}

/// All rooted trees of up to `order` vertices, sorted by their order.
std::vector<Tree> rooted_trees(int order) {
  std::vector<Tree> trees;
  for (int n = 1; n <= order; ++n) extend(trees, 0, Tree(), n);
  return trees;
}

/// The largest residual of the order conditions of some weights: their sum over the elementary
/// weights of a tree is 1 / density (Hairer, Norsett and Wanner, II.2).
template <std::size_t stages>
Quad residual(const ButcherTableau<stages>& tableau, const std::array<Quad, stages>& weights,
              int order) {
  const auto trees = rooted_trees(order);
  std::vector<std::array<Quad, stages>> elementary;
  Quad largest = 0;
  for (const Tree& tree : trees) {
    auto& phi = elementary.emplace_back();
    Quad sum = 0;
    for (std::size_t i = 0; i < stages; ++i) {
      phi[i] = 1;
      for (const std::size_t child : tree.children) {
        Quad inner = 0;
        for (std::size_t j = 0; j < i; ++j)
          inner += tableau.a[i][j].template as<Quad>() * elementary[child][j];
        phi[i] *= inner;
      }
      sum += weights[i] * phi[i];
    }
    largest = std::max<Quad>(largest, abs(Quad(sum - Quad(1) / Quad(tree.density))));
  }
  return largest;
}

template <std::size_t stages>
void check_orders(const ButcherTableau<stages>& tableau, int order) {
  std::array<Quad, stages> weights, embedded;
  for (std::size_t i = 0; i < stages; ++i) {
    weights[i] = tableau.b[i].template as<Quad>();
    embedded[i] = weights[i] - tableau.error[i].template as<Quad>();
  }
  const Quad rounding = 1e-27;  // products of up to 8 coefficients, some of which exceed 100
  CHECK(residual(tableau, weights, order) < rounding);
  CHECK(residual(tableau, weights, order + 1) > 1e-8);
  CHECK(residual(tableau, embedded, order - 1) < rounding);
  CHECK(residual(tableau, embedded, order) > 1e-8);
}

}  // namespace

TEST_CASE("There are as many rooted trees as order conditions") {
  CHECK(rooted_trees(5).size() == 17);
  CHECK(rooted_trees(8).size() == 200);
}

TEST_CASE("Verner's pairs satisfy the conditions of their orders, and not those of the next") {
  check_orders(verner76, 7);
  check_orders(verner87, 8);
}

TEST_CASE("The nodes of Verner's pairs are the sums of their rows") {
  const auto check = [](const auto& tableau) {
    for (std::size_t i = 0; i < tableau.c.size(); ++i) {
      Quad sum = 0;
      for (std::size_t j = 0; j < i; ++j) sum += tableau.a[i][j].template as<Quad>();
      CHECK(abs(Quad(sum - tableau.c[i].template as<Quad>())) < 1e-29);
    }
  };
  check(verner76);
  check(verner87);
}

TEST_CASE("The coefficients in double precision are rounded correctly") {
  const auto check_all = [](const auto& coefficients) {
    for (const Coefficient& c : coefficients) CHECK(c.high == c.high + c.low);
  };
  const auto check = [&](const auto& tableau) {
    for (const auto& row : tableau.a) check_all(row);
    check_all(tableau.b);
    check_all(tableau.error);
  };
  check(verner76);
  check(verner87);
}
