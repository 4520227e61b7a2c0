// SPDX-License-Identifier: MIT
// Forward, Jacobian and warm inverse beside KDL and the Eigen yardstick, on the same poses in one run. Every benchmark
// goes through the same 1000 poses; compare the medians of --benchmark_repetitions. Allocations are counted by an
// interposed malloc and printed as a counter.
#include <benchmark/benchmark.h>

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_nr.hpp>
#include <kdl/chainiksolvervel_wdls.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include <dlfcn.h>

#include <atomic>
#include <vector>

#include "mdhcal/inverse.hpp"
#include "mdhcal/kinematics.hpp"
#include "tests/bench/yardstick.hpp"
#include "tests/lib/arms.hpp"

namespace {
std::atomic<long> allocations{0};
}

extern "C" void* malloc(std::size_t size) {
  using Malloc = void* (*)(std::size_t);
  static const Malloc next = reinterpret_cast<Malloc>(dlsym(RTLD_NEXT, "malloc"));
  allocations.fetch_add(1, std::memory_order_relaxed);
  return next(size);
}

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

constexpr int poses = 1000;
constexpr double tolerance = 1e-10;

struct Workload {
  Geometry geometry{};
  Arm<double> arm{};
  std::vector<std::array<double, 6>> q, seed;
  std::vector<Pose<double>> target;

  Workload() {
    Random random(51);
    geometry = with_errors(ur5(), random, 1e-3, 0.1 * deg);
    if (make_arm(geometry, arm) != Status::ok) std::abort();
    while (q.size() < poses) {
      std::array<double, 6> at{};
      for (double& joint : at) joint = random.symmetric(pi);
      Pose<double> pose{};
      TickReport<double> report{};
      double same[6];
      std::copy(at.begin(), at.end(), same);
      if (forward(arm, at.data(), pose) != Status::ok) std::abort();
      if (tick(arm, default_tick_options(arm), pose, same, &report) != Status::ok) continue;
      if (report.smallest_singular_value < 0.02) continue;
      q.push_back(at);
      target.push_back(pose);
      for (double& joint : at) joint += random.symmetric(0.00314);
      seed.push_back(at);
    }
  }
};

const Workload& workload() {
  static const Workload made;
  return made;
}

// The same arm in KDL: frames of modified DH with beta, joints about z before Rot_y.
KDL::Chain kdl_chain(const Geometry& g) {
  KDL::Chain chain;
  KDL::Frame before = KDL::Frame::Identity();
  for (int i = 0; i < 6; ++i) {
    const Link& l = g.link[i];
    const KDL::Frame fixed = before * KDL::Frame(KDL::Rotation::RotX(l.alpha_rad)) * KDL::Frame(KDL::Vector(l.a_m, 0, 0));
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), fixed));
    const KDL::Frame tip = KDL::Frame(KDL::Rotation::RotZ(l.theta_rad)) * KDL::Frame(KDL::Vector(0, 0, l.d_m)) *
                           KDL::Frame(KDL::Rotation::RotY(l.beta_rad));
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), tip));
    before = KDL::Frame::Identity();
  }
  return chain;
}

KDL::Frame kdl_frame(const Pose<double>& p) {
  const double* c = p.quaternion;
  return KDL::Frame(KDL::Rotation::Quaternion(c[1], c[2], c[3], c[0]),
                    KDL::Vector(p.position_m[0], p.position_m[1], p.position_m[2]));
}

void report(benchmark::State& state, long before, std::size_t misses) {
  state.counters["allocations"] = static_cast<double>(allocations.load() - before);
  state.counters["missed"] = static_cast<double>(misses);
}

void forward_library(benchmark::State& state) {
  const Workload& w = workload();
  std::size_t n = 0;
  const long before = allocations.load();
  for (auto _ : state) {
    Pose<double> pose;
    benchmark::DoNotOptimize(forward(w.arm, w.q[n++ % poses].data(), pose));
    benchmark::DoNotOptimize(pose);
  }
  report(state, before, 0);
}

void forward_yardstick(benchmark::State& state) {
  const Workload& w = workload();
  const bench::Yardstick arm(w.geometry);
  std::size_t n = 0;
  for (auto _ : state) {
    Eigen::Matrix4d t = arm.forward(w.q[n++ % poses].data());
    benchmark::DoNotOptimize(t);
  }
}

void forward_kdl(benchmark::State& state) {
  const Workload& w = workload();
  const KDL::Chain chain = kdl_chain(w.geometry);
  KDL::ChainFkSolverPos_recursive solver(chain);
  KDL::JntArray q(6);
  std::size_t n = 0;
  for (auto _ : state) {
    for (unsigned i = 0; i < 6; ++i) q(i) = w.q[n % poses][i];
    ++n;
    KDL::Frame frame;
    solver.JntToCart(q, frame);
    benchmark::DoNotOptimize(frame);
  }
}

void jacobian_library(benchmark::State& state) {
  const Workload& w = workload();
  std::size_t n = 0;
  const long before = allocations.load();
  for (auto _ : state) {
    Pose<double> pose;
    Jacobian<double> jacobian;
    benchmark::DoNotOptimize(forward(w.arm, w.q[n++ % poses].data(), pose, jacobian));
    benchmark::DoNotOptimize(jacobian);
  }
  report(state, before, 0);
}

void jacobian_kdl(benchmark::State& state) {
  const Workload& w = workload();
  const KDL::Chain chain = kdl_chain(w.geometry);
  KDL::ChainFkSolverPos_recursive position(chain);
  KDL::ChainJntToJacSolver solver(chain);
  KDL::JntArray q(6);
  KDL::Jacobian jacobian(6);
  std::size_t n = 0;
  for (auto _ : state) {
    for (unsigned i = 0; i < 6; ++i) q(i) = w.q[n % poses][i];
    ++n;
    KDL::Frame frame;
    position.JntToCart(q, frame);
    solver.JntToJac(q, jacobian);
    benchmark::DoNotOptimize(jacobian);
  }
}

void inverse_library(benchmark::State& state) {
  const Workload& w = workload();
  TickOptions<double> options = default_tick_options(w.arm);
  std::size_t n = 0;
  std::size_t misses = 0;
  const long before = allocations.load();
  for (auto _ : state) {
    std::array<double, 6> q = w.seed[n % poses];
    if (tick(w.arm, options, w.target[n % poses], q.data()) != Status::ok) ++misses;
    benchmark::DoNotOptimize(q);
    ++n;
  }
  report(state, before, misses);
}

void inverse_yardstick(benchmark::State& state) {
  const Workload& w = workload();
  const bench::Yardstick arm(w.geometry);
  std::vector<Eigen::Matrix4d> target;
  for (const auto& q : w.q) target.push_back(arm.forward(q.data()));
  std::size_t n = 0;
  std::size_t misses = 0;
  for (auto _ : state) {
    std::array<double, 6> q = w.seed[n % poses];
    if (arm.inverse(target[n % poses], q.data(), tolerance) < 0) ++misses;
    benchmark::DoNotOptimize(q);
    ++n;
  }
  report(state, allocations.load(), misses);
}

void inverse_kdl(benchmark::State& state) {
  const Workload& w = workload();
  const KDL::Chain chain = kdl_chain(w.geometry);
  KDL::ChainFkSolverPos_recursive position(chain);
  KDL::ChainIkSolverVel_wdls velocity(chain);
  KDL::ChainIkSolverPos_NR solver(chain, position, velocity, 100, tolerance);
  KDL::JntArray seed(6);
  KDL::JntArray q(6);
  std::size_t n = 0;
  std::size_t misses = 0;
  for (auto _ : state) {
    for (unsigned i = 0; i < 6; ++i) seed(i) = w.seed[n % poses][i];
    if (solver.CartToJnt(seed, kdl_frame(w.target[n % poses]), q) < 0) ++misses;
    benchmark::DoNotOptimize(q);
    ++n;
  }
  report(state, allocations.load(), misses);
}

BENCHMARK(forward_library);
BENCHMARK(forward_yardstick);
BENCHMARK(forward_kdl);
BENCHMARK(jacobian_library);
BENCHMARK(jacobian_kdl);
BENCHMARK(inverse_library);
BENCHMARK(inverse_yardstick);
BENCHMARK(inverse_kdl);

}  // namespace

BENCHMARK_MAIN();
